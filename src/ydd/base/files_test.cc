// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/files.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Files : public testing::Test {
 protected:
  Files() : folder_(fs::path(testing::TempDir()) / fmt::format("ydd_files_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }

  std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
};

TEST_F(Files, ReadsBackWhatWasWritten) {
  const std::string content("line\n\0binary\xff\r\n", 15);
  ASSERT_TRUE(write_file_atomically(folder_ / "a", content));
  const auto read = read_file(folder_ / "a");
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, content);
}

TEST_F(Files, ReplacesAndLeavesNothingBehind) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a", std::string(100000, 'x')));
  ASSERT_TRUE(write_file_atomically(folder_ / "a", "short"));
  EXPECT_EQ(*read_file(folder_ / "a"), "short");
  ASSERT_TRUE(write_file_atomically(folder_ / "empty", ""));
  EXPECT_EQ(*read_file(folder_ / "empty"), "");
  EXPECT_EQ(entries(), 2);
}

TEST_F(Files, AFolderThatIsNotThereIsAnErrorThatNamesTheFile) {
  const auto written = write_file_atomically(folder_ / "no" / "file", "x");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("no/file: cannot be created"), std::string::npos);
  const auto read = read_file(folder_ / "missing");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("missing: cannot be opened"), std::string::npos);
}

TEST_F(Files, AFolderIsNoFile) {
  fs::create_directory(folder_ / "sub");
  EXPECT_FALSE(read_file(folder_ / "sub"));
  const auto written = write_file_atomically(folder_ / "sub", "x");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("sub: is a folder, not a file"));
  EXPECT_EQ(entries(), 1) << "the temporary file must be gone";
}

TEST_F(Files, APrivateFileStaysPrivate) {
  const fs::path file = folder_ / "a";
  ASSERT_TRUE(write_file_atomically(file, "x"));
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(write_file_atomically(file, "y"));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Files, ALinkStaysAndWhatItLeadsToIsReplaced) {
  fs::create_directory(folder_ / "sub");
  fs::create_symlink("sub/b", folder_ / "a");
  for (const char* const content : {"made", "replaced"}) {  // it leads to nothing at first
    ASSERT_TRUE(write_file_atomically(folder_ / "a", content));
    EXPECT_TRUE(fs::is_symlink(folder_ / "a"));
    EXPECT_EQ(*read_file(folder_ / "sub/b"), content);
  }
  fs::create_symlink("round", folder_ / "round");
  EXPECT_FALSE(write_file_atomically(folder_ / "round/x", "x"));
}

TEST_F(Files, ALinkAtATemporaryNameIsNotFollowed) {
  // The names of old: anybody could have known them.
  const fs::path victim = folder_ / "victim";
  ASSERT_TRUE(write_file_atomically(victim, "precious"));
  fs::create_symlink(victim, folder_ / fmt::format("a.{}.tmp", ::getpid()));
  ASSERT_TRUE(write_file_atomically(folder_ / "a", "x"));
  EXPECT_EQ(*read_file(victim), "precious");
  const FreshFile one = FreshFile::make(folder_ / "a", ".tmp").value();
  const FreshFile two = FreshFile::make(folder_ / "a", ".tmp").value();
  EXPECT_NE(one.path(), two.path());
  EXPECT_EQ(one.path().parent_path(), folder_);
}

TEST_F(Files, APipeIsWrittenToAndNeverReplaced) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto unread = write_file_atomically(pipe, "x");  // and does not wait for a reader
  ASSERT_FALSE(unread);
  EXPECT_THAT(unread.error().message, HasSubstr("pipe: cannot be opened for writing"));
  std::string got;
  std::jthread reader([&] {
    std::ifstream stream(pipe);
    got.assign(std::istreambuf_iterator<char>(stream), {});
  });
  while (!write_file_atomically(pipe, "through the pipe")) std::this_thread::yield();
  reader.join();
  EXPECT_EQ(got, "through the pipe");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(Files, DevicesAreWrittenToAndSayWhenTheyAreFull) {
  fs::create_symlink("/dev/null", folder_ / "null");
  EXPECT_TRUE(write_file_atomically(folder_ / "null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const auto full = write_file_atomically("/dev/full", "x");
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, HasSubstr("/dev/full: cannot be written: No space left"));
}

TEST_F(Files, NothingIsLeftWhenTheFileMayNotGrow) {
  const fs::path file = folder_ / "a";
  ASSERT_TRUE(write_file_atomically(file, "as it was"));
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, 4096};
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0) ::_exit(2);
    const auto written = write_file_atomically(file, std::string(100'000, 'x'));
    const bool told = !written && written.error().message.find("a: cannot be written: File too") !=
                                      std::string::npos;
    ::_exit(told ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(*read_file(file), "as it was");
  EXPECT_EQ(entries(), 1);
}

TEST_F(Files, AVeryLongNameCanBeWritten) {
  EXPECT_TRUE(write_file_atomically(folder_ / std::string(255, 'n'), "x"));
}

TEST_F(Files, OnlyRegularFilesAreRead) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const auto pipe = read_file(folder_ / "pipe");  // would wait for a writer
  ASSERT_FALSE(pipe);
  EXPECT_THAT(pipe.error().message, HasSubstr("pipe: is a pipe, not a file"));
  const auto endless = read_file("/dev/zero");
  ASSERT_FALSE(endless);
  EXPECT_THAT(endless.error().message, HasSubstr("/dev/zero: is a device, not a file"));
  EXPECT_TRUE(read_file("/proc/self/status")) << "a file whose size is reported as 0";
}

TEST_F(Files, ABoundIsKept) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a", std::string(100'000, 'x')));
  EXPECT_EQ(read_file_bounded(folder_ / "a", 100'000)->size(), 100'000U);
  const auto over = read_file_bounded(folder_ / "a", 99'999);
  ASSERT_FALSE(over);
  EXPECT_THAT(over.error().message, HasSubstr("a: has more than 99999 bytes"));
  EXPECT_FALSE(read_file_bounded("/proc/self/status", 10)) << "its size is reported as 0";
}

}  // namespace
}  // namespace ydd
