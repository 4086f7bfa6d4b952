// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/file_lock.h"

#include <unistd.h>

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

class FileLockTest : public testing::Test {
 protected:
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
};

TEST_F(FileLockTest, IsTakenOnceAndGivenBack) {
  const fs::path file = folder_ / "a";
  EXPECT_FALSE(FileLock::take(file, false).ok());  // there is none
  {
    const Result<FileLock> lock = FileLock::take(file, true);
    ASSERT_TRUE(lock.ok());
    const Result<FileLock> second = FileLock::take(file, false);
    ASSERT_FALSE(second.ok());
    EXPECT_THAT(second.error().message, testing::HasSubstr("another process is writing it"));
  }
  EXPECT_TRUE(FileLock::take(file, false).ok());
}

TEST_F(FileLockTest, GoesAlongWithARename) {
  const Result<FileLock> lock = FileLock::take(folder_ / "a", true);
  ASSERT_TRUE(lock.ok());
  fs::rename(folder_ / "a", folder_ / "b");
  EXPECT_FALSE(FileLock::take(folder_ / "b", false).ok());
  EXPECT_TRUE(lock->is_named(folder_ / "b"));
  EXPECT_FALSE(lock->is_named(folder_ / "a"));
  std::ofstream(folder_ / "c") << "c";
  fs::rename(folder_ / "c", folder_ / "b");
  EXPECT_FALSE(lock->is_named(folder_ / "b"));
}

TEST_F(FileLockTest, FlushesFileAndFolder) {
  std::ofstream(folder_ / "a") << "content";
  const Result<FileLock> lock = FileLock::take(folder_ / "a", true);
  ASSERT_TRUE(lock.ok());
  EXPECT_TRUE(lock->flush());
  EXPECT_TRUE(flush_folder(folder_));
  EXPECT_FALSE(flush_folder(folder_ / "none"));
}

}  // namespace
}  // namespace ydd
