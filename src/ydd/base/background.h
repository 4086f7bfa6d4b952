// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include "ydd/base/channel.h"
#include "ydd/base/guard.h"
#include "ydd/base/result.h"

namespace ydd {

/// Gives values to `work`, in order, on a thread of its own. After the first failure (what `work`
/// throws is one) the rest is dropped, and every call tells that failure.
///
/// Thread: one gives; `work` runs on the other. Whatever `work` refers to must outlive this. The
/// destructor finishes what is queued.
template <class T>
class Background {
 public:
  using Work = std::function<Result<void>(T)>;

  /// At most `capacity` values wait.
  Background(std::size_t capacity, Work work)
      : values_(capacity), thread_([this, work = std::move(work)] { run(work); }) {}
  ~Background() { values_.close(); }  // then the thread joins
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Waits for room.
  Result<void> push(T value) {
    values_.push(std::move(value));
    return failure();
  }
  /// False, at once, when there is no room.
  Result<bool> try_push(T value) {
    const bool taken = values_.try_push(std::move(value));
    if (auto r = failure(); !r) return r.error();
    return taken;
  }
  /// Finishes what is queued. Afterwards nothing may be given.
  Result<void> finish() {
    values_.close();
    if (thread_.joinable()) thread_.join();
    return failure();
  }

 private:
  void run(const Work& work) noexcept {
    while (std::optional<T> value = values_.pop()) {
      if (failure_) continue;
      const Result<void> done = guarded("", [&] { return work(std::move(*value)); });
      if (!done) failure_.set(done.error());
    }
  }
  Result<void> failure() const { return failure_.get(); }

  Channel<T> values_;
  FirstError failure_;
  std::jthread thread_;  ///< last: joined before the others go
};

}  // namespace ydd
