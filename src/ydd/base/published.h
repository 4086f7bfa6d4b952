// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <utility>

namespace ydd {

/// The newest version of an immutable value: one thread publishes, any thread reads.
template <class T>
class Published {
 public:
  Published() = default;
  /// Starts with a value; null: none yet.
  explicit Published(std::shared_ptr<const T> value) : value_(std::move(value)) {}

  /// From now on others get this one; who has the old one keeps it. Any thread.
  void set(std::shared_ptr<const T> value) {
    // The old value is released outside the lock: its destructor may be long.
    const std::lock_guard lock(mutex_);
    value_.swap(value);
  }

  /// The newest value; null before the first `set`.
  std::shared_ptr<const T> get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const T> value_;
};

}  // namespace ydd
