// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace ydd {

/// A bounded queue between two threads; with Published<T> the only way values cross threads.
///
/// `close()` ends it: pushes are refused, pops drain what is left and then give nothing. A blocked
/// call also returns when its stop token is triggered. Blocking pushes go downstream only.
template <class T>
class Channel {
 public:
  explicit Channel(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room. False when closed or stopped; the value is then dropped.
  bool push(T value, std::stop_token stop = {}) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [&] { return closed_ || queue_.size() < capacity_; })) {
      return false;
    }
    if (closed_) return false;
    queue_.push_back(std::move(value));
    changed_.notify_all();
    return true;
  }

  /// False at once when full or closed.
  bool try_push(T value) {
    const std::lock_guard lock(mutex_);
    if (closed_ || queue_.size() >= capacity_) return false;
    queue_.push_back(std::move(value));
    changed_.notify_all();
    return true;
  }

  /// Never waits: when full, the oldest value gives way to this one. False when closed.
  bool push_over(T value) {
    const std::lock_guard lock(mutex_);
    if (closed_ || capacity_ == 0) return false;
    if (queue_.size() >= capacity_) {
      queue_.pop_front();
      ++displaced_;
    }
    queue_.push_back(std::move(value));
    changed_.notify_all();
    return true;
  }

  /// How many values gave way to newer ones.
  std::int64_t displaced() const {
    const std::lock_guard lock(mutex_);
    return displaced_;
  }

  /// Waits for a value. Nothing when closed and drained, or stopped.
  std::optional<T> pop(std::stop_token stop = {}) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [&] { return closed_ || !queue_.empty(); });
    if (queue_.empty() || stop.stop_requested()) return std::nullopt;
    return take();
  }

  /// Waits at most so long for a value. Nothing when none came, or when closed and drained.
  template <class Rep, class Period>
  std::optional<T> pop_within(std::chrono::duration<Rep, Period> wait) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [&] { return closed_ || !queue_.empty(); });
    if (queue_.empty()) return std::nullopt;
    return take();
  }

  /// Nothing at once when empty.
  std::optional<T> try_pop() {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return std::nullopt;
    return take();
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return queue_.size();
  }

 private:
  std::optional<T> take() {
    std::optional<T> value(std::move(queue_.front()));
    queue_.pop_front();
    changed_.notify_all();
    return value;
  }

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<T> queue_;
  const std::size_t capacity_;
  std::int64_t displaced_ = 0;
  bool closed_ = false;
};

}  // namespace ydd
