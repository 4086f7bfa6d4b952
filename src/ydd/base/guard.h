// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "ydd/base/result.h"

namespace ydd {

/// What is being thrown, as one line that begins with `where` (empty: nothing). For catch blocks;
/// does not throw, also when memory is short.
Error current_exception_error(std::string_view where) noexcept;

/// What `step` gives; what it throws becomes an error. Where a thread begins nobody else would
/// catch it, and the process would end with everything that it has done.
template <class Step>
std::invoke_result_t<Step> guarded(std::string_view where, Step&& step) {
  try {
    return std::forward<Step>(step)();
  } catch (...) {
    return current_exception_error(where);
  }
}

/// The first thing that went wrong in one of several threads. Thread: any.
class FirstError {
 public:
  void set(const Error& error) noexcept {
    const std::lock_guard lock(mutex_);
    if (error_) return;
    try {
      error_ = error;
    } catch (...) {
      error_ = Error{"out of memory"};  // short enough to be stored without any
    }
  }
  Result<void> get() const {
    const std::lock_guard lock(mutex_);
    return error_ ? Result<void>(*error_) : Result<void>();
  }
  explicit operator bool() const {
    const std::lock_guard lock(mutex_);
    return error_.has_value();
  }

 private:
  mutable std::mutex mutex_;
  std::optional<Error> error_;
};

}  // namespace ydd
