// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace ydd::app {

/// Progress of long work on standard error: a line that rewrites itself when a terminal watches, a
/// log line every few seconds otherwise.
class Progress {
 public:
  /// `total` 0: nobody knows when it ends. `quiet`: nothing at all.
  Progress(std::string what, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` are finished; `state` is a short text about now.
  void update(std::size_t done, const std::string& state);

 private:
  void show(std::size_t done, const std::string& state, std::int64_t now_ns);

  std::string what_;
  std::size_t total_;
  bool quiet_;
  bool terminal_;
  bool line_open_ = false;
  std::int64_t start_ns_;
  std::int64_t shown_ns_;
};

}  // namespace ydd::app
