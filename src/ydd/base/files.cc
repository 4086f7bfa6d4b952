// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

namespace ydd {
namespace {

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t n = ::write(descriptor, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  const std::string temporary = fmt::format("{}.{}.tmp", file.string(), ::getpid());
  const auto failure = [&](const char* what) {
    const std::string reason = std::generic_category().message(errno);
    ::unlink(temporary.c_str());
    return Error{fmt::format("{}: {}: {}", file.string(), what, reason)};
  };
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return failure("cannot be created");
  const bool written = write_all(descriptor, content) && ::fsync(descriptor) == 0;
  if (::close(descriptor) != 0 || !written) return failure("cannot be written");
  if (::rename(temporary.c_str(), file.c_str()) != 0)
    return failure("cannot be renamed into place");
  return {};
}

Result<std::string> read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) {
    return Error{fmt::format("{}: cannot be opened for reading", file.string())};
  }
  std::ostringstream content;
  content << stream.rdbuf();
  return std::move(content).str();
}

}  // namespace ydd
