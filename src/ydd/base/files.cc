// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = std::uintmax_t{2} << 30U;

Error failure(const fs::path& file, std::string_view what) {
  const std::string reason = std::generic_category().message(errno);
  return Error{fmt::format("{}: {}: {}", file.string(), what, reason)};
}

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int number() const { return number_; }
  bool close() {
    const int number = std::exchange(number_, -1);
    return number < 0 || ::close(number) == 0;
  }

 private:
  int number_;
};

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(descriptor, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// Some file systems know no flushing; what they have is all one can get.
bool flush(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

/// /dev/stdout and its like: names of what is open already, which a rename would miss.
bool names_a_descriptor(const fs::path& file) { return file.string().starts_with("/proc/"); }

Result<void> write_directly(const fs::path& file, mode_t mode, std::string_view content) {
  if (S_ISDIR(mode) || S_ISSOCK(mode) || S_ISBLK(mode)) {
    return Error{fmt::format("{}: is {}, not a file", file.string(), kind_of(mode))};
  }
  // Without waiting: a pipe that nobody reads is an error and no hang.
  const Descriptor out(::open(file.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (out.number() < 0) return failure(file, "cannot be opened for writing");
  const int flags = ::fcntl(out.number(), F_GETFL);
  if (flags < 0 || ::fcntl(out.number(), F_SETFL, flags & ~O_NONBLOCK) != 0 ||
      !write_all(out.number(), content)) {
    return failure(file, "cannot be written");
  }
  return {};
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

std::uint64_t unpredictable() {
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

}  // namespace

fs::path follow_links(const fs::path& file) {
  fs::path target = file;
  std::error_code none;
  for (int links = 0; links < 40 && fs::is_symlink(target, none); ++links) {
    if (names_a_descriptor(target)) return target;
    const fs::path next = fs::read_symlink(target, none);
    if (none) return target;
    target = next.is_absolute() ? next : folder_of(target) / next;
  }
  return target;
}

Result<FreshFile> FreshFile::make(const fs::path& target, std::string_view ending) {
  // Never a name that somebody could have put a link at; short, as the target's may be the longest
  // that there can be.
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    const fs::path path =
        folder_of(target) / fmt::format(".ydd-{:016x}{}", unpredictable(), ending);
    const int descriptor =
        ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (descriptor >= 0) {
      FreshFile fresh(target, path, descriptor);
      if (auto r = fresh.take_over_mode(); !r) return r.error();
      return fresh;
    }
    if (errno != EEXIST) break;
  }
  return failure(target, "cannot be created");
}

FreshFile::FreshFile(fs::path target, fs::path path, int descriptor)
    : target_(std::move(target)), path_(std::move(path)), descriptor_(descriptor) {}

FreshFile::FreshFile(FreshFile&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

FreshFile& FreshFile::operator=(FreshFile&& other) noexcept {
  std::swap(target_, other.target_);
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FreshFile::~FreshFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(path_.c_str());
}

/// What was private stays private; whoever owned it still does, where that can be.
Result<void> FreshFile::take_over_mode() {
  struct stat old = {};
  if (::stat(target_.c_str(), &old) != 0) return {};
  if (!S_ISREG(old.st_mode)) {
    return Error{fmt::format("{}: is {}, not a file", target_.string(), kind_of(old.st_mode))};
  }
  if (::access(target_.c_str(), W_OK) != 0) return failure(target_, "cannot be written");
  const bool same_owner = ::fchown(descriptor_, old.st_uid, old.st_gid) == 0;
  // Another group must not gain what the old one was given.
  const mode_t mode = old.st_mode & (same_owner ? 0777U : 0707U);
  if (::fchmod(descriptor_, mode) != 0) return failure(target_, "cannot be given its mode");
  return {};
}

Result<void> FreshFile::append(std::string_view bytes) {
  return write_all(descriptor_, bytes) ? Result<void>() : failure(target_, "cannot be written");
}

Result<void> FreshFile::place() {
  if (!flush(descriptor_)) return failure(target_, "cannot be written");
  if (::rename(path_.c_str(), target_.c_str()) != 0) {
    return failure(target_, "cannot be renamed into place");
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) return failure(target_, "cannot be written");
  return {};
}

Result<void> write_file_atomically(const fs::path& file, std::string_view content) {
  const fs::path target = follow_links(file);
  struct stat there = {};
  if (::stat(file.c_str(), &there) == 0 &&
      (!S_ISREG(there.st_mode) || names_a_descriptor(target))) {
    return write_directly(file, there.st_mode, content);
  }
  Result<FreshFile> fresh = FreshFile::make(target, ".tmp");
  if (!fresh) return fresh.error();
  if (!write_all(fresh->descriptor(), content)) return failure(file, "cannot be written");
  return fresh->place();
}

Result<std::string> read_file_bounded(const fs::path& file, std::uintmax_t max_bytes) {
  const Descriptor in(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status = {};
  if (in.number() < 0 && errno == ENOENT) {
    return Error{fmt::format("{}: cannot be opened for reading", file.string())};
  }
  if (in.number() < 0 || ::fstat(in.number(), &status) != 0) {
    return failure(file, "cannot be opened for reading");
  }
  if (!S_ISREG(status.st_mode)) {
    return Error{fmt::format("{}: is {}, not a file", file.string(), kind_of(status.st_mode))};
  }
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  std::string content;
  if (size <= max_bytes) content.reserve(size + 1);
  std::size_t read = 0;
  while (size <= max_bytes) {  // not to `size`: files of /proc have none, others may grow
    constexpr std::size_t kPiece = 65536;
    content.resize(content.capacity() > read ? content.capacity() : read + kPiece);
    const ssize_t n = ::read(in.number(), content.data() + read, content.size() - read);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failure(file, "cannot be read");
    read += static_cast<std::size_t>(n);
    content.resize(read);
    if (n == 0) return content;
    if (read > max_bytes) break;
  }
  return Error{fmt::format("{}: has more than {} bytes, the most that such a file may have",
                           file.string(), max_bytes)};
}

Result<std::string> read_file(const fs::path& file) {
  return read_file_bounded(file, kLargestFile);
}

}  // namespace ydd
