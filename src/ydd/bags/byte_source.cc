// SPDX-License-Identifier: Apache-2.0
#include "ydd/bags/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace ydd::bags {

Result<BagFile> BagFile::open(const std::filesystem::path& file) {
  const auto failure = [&](const std::string& reason) {
    return Error{fmt::format("{}: {}", file.string(), reason)};
  };
  const int number = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (number < 0) {
    return failure("cannot be opened: " + std::generic_category().message(errno));
  }
  BagFile out;
  out.descriptor_ = std::shared_ptr<const int>(new int(number), [](const int* descriptor) {
    ::close(*descriptor);
    delete descriptor;
  });
  struct stat status {};
  if (::fstat(number, &status) != 0 || !S_ISREG(status.st_mode)) return failure("is not a file");
  out.path_ = file;
  out.size_ = static_cast<std::uint64_t>(status.st_size);
  return out;
}

std::optional<std::string> BagFile::read(std::uint64_t offset, std::uint64_t size) const {
  if (size > kLargestPiece || offset > size_ || size > size_ - offset) return std::nullopt;
  std::string out(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n =
        ::pread(*descriptor_, out.data() + done, size - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return std::nullopt;
    done += static_cast<std::size_t>(n);
  }
  return out;
}

std::optional<std::string_view> ByteSource::at(std::uint64_t offset, std::uint64_t size) {
  if (offset > this->size() || size > this->size() - offset) return std::nullopt;
  if (!file_) return text_.substr(offset, size);
  if (offset < window_begin_ || offset + size > window_begin_ + window_.size()) {
    constexpr std::uint64_t kWindow = 1U << 14U;
    const std::uint64_t wanted = std::min(std::max(size, kWindow), file_->size() - offset);
    std::optional<std::string> read = file_->read(offset, wanted);
    if (!read) return std::nullopt;
    window_ = *std::move(read);
    window_begin_ = offset;
  }
  return std::string_view(window_).substr(offset - window_begin_, size);
}

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

}  // namespace ydd::bags
