// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/files.h"

#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;

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
  EXPECT_NE(written.error().message.find("cannot be renamed"), std::string::npos);
  EXPECT_EQ(entries(), 1) << "the temporary file must be gone";
}

}  // namespace
}  // namespace ydd
