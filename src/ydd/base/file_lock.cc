// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace ydd {

Result<FileLock> FileLock::take(const std::filesystem::path& file, bool create) {
  const int flags = create ? O_RDWR | O_CREAT | O_CLOEXEC : O_RDONLY | O_CLOEXEC;
  const int descriptor = ::open(file.c_str(), flags, 0644);
  if (descriptor < 0) {
    return Error{fmt::format("{}: cannot be opened: {}", file.string(),
                             std::generic_category().message(errno))};
  }
  FileLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{fmt::format("{}: another process is writing it; give another file, or wait",
                             file.string())};
  }
  return lock;
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool FileLock::is_named(const std::filesystem::path& file) const {
  struct stat mine = {};
  struct stat named = {};
  return ::fstat(descriptor_, &mine) == 0 && ::stat(file.c_str(), &named) == 0 &&
         mine.st_dev == named.st_dev && mine.st_ino == named.st_ino;
}

bool FileLock::flush() const { return ::fsync(descriptor_) == 0; }

bool flush_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool flushed = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return flushed;
}

}  // namespace ydd
