// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <algorithm>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "ydd/base/result.h"

namespace ydd::fuzz {

/// A parser gave something back that it must not: the fuzzer keeps the input.
[[noreturn]] inline void broken(const std::string& what) {
  throw std::logic_error("fuzz: " + what);
}

/// A failure is one line that says something.
inline void expect_one_line(const Error& error) {
  if (error.message.empty() || error.message.find('\n') != std::string::npos) {
    broken("not one line: '" + error.message + "'");
  }
}
template <class T>
void expect_one_line(const Result<T>& result) {
  if (!result) expect_one_line(result.error());
}

/// A folder in memory, for parsers that want the name of a file. It goes with the process.
class Folder {
 public:
  Folder() {
    const bool shm = ::access("/dev/shm", W_OK) == 0;
    const std::filesystem::path parent =
        shm ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path();
    std::string pattern = parent / "ydd-fuzz-XXXXXX";
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::string_view content) const {
    std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
    return file;
  }

 private:
  std::filesystem::path path_;
};

/// `input` in a file of the process's folder.
inline std::filesystem::path file_of(std::string_view input, const std::string& name) {
  static const Folder folder;
  return folder.write(name, input);
}

/// Takes an input apart: numbers and texts for who builds something of them.
class Pieces {
 public:
  explicit Pieces(std::string_view input) : rest_(input) {}
  bool done() const { return rest_.empty(); }
  /// 0 after the end.
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto value = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return value;
  }
  std::uint32_t number() {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) value |= std::uint32_t{byte()} << (8U * i);
    return value;
  }
  /// At most as many as there are.
  std::string_view text(std::size_t size) {
    const std::string_view text = rest_.substr(0, size);
    rest_.remove_prefix(text.size());
    return text;
  }
  /// Up to the next `end`, which is dropped.
  std::string_view until(char end) {
    const std::string_view text = rest_.substr(0, rest_.find(end));
    rest_.remove_prefix(std::min(text.size() + 1, rest_.size()));
    return text;
  }

 private:
  std::string_view rest_;
};

}  // namespace ydd::fuzz
