// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "ydd/base/channel.h"

namespace ydd {

/// Computes items 0, 1, ... `count` - 1 ahead of their consumer and hands them out in that order.
///
/// Worker w of W computes items w, w + W, ... into a channel of its own, and `next` visits the
/// channels in turn: order costs nothing, and no worker waits for another. At most about `depth`
/// finished items wait, plus the one that each worker holds. With no workers `next` computes the
/// item itself.
///
/// Thread: `next` is for one thread; `make` is called from all workers at once.
/// Lifetime: whatever `make` refers to must outlive the prefetcher. Its destructor may come at any
/// time: it waits for the items being computed and drops the rest.
template <class T>
class Prefetcher {
 public:
  using Make = std::function<T(std::size_t)>;

  /// @throws std::logic_error if `make` is empty.
  Prefetcher(std::size_t count, std::size_t depth, std::size_t workers, Make make)
      : count_(count), make_(std::move(make)) {
    if (!make_) throw std::logic_error("Prefetcher: nothing to call");
    workers = std::min(workers, count);
    const std::size_t capacity = workers == 0 ? 0 : std::max<std::size_t>(1, depth / workers);
    for (std::size_t w = 0; w < workers; ++w) {
      channels_.push_back(std::make_unique<Channel<Item>>(capacity));
    }
    // Only now: a worker must not see the list of channels grow.
    for (std::size_t w = 0; w < workers; ++w) {
      threads_.emplace_back([this, w](std::stop_token stop) { work(w, stop); });
    }
  }

  ~Prefetcher() {
    for (auto& thread : threads_) thread.request_stop();
    for (auto& channel : channels_) channel->close();
  }

  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;

  std::size_t count() const { return count_; }

  /// Items before `i` are not wanted any more: those that are not computed yet never will be.
  void skip_to(std::size_t i) {
    first_wanted_.store(i);
    while (next_ < std::min(i, count_)) {
      if (!channels_.empty() && !channels_[next_ % channels_.size()]->pop()) return;
      ++next_;
    }
  }

  /// The next item, waiting for it if need be; nothing after the last. What `make` threw for an
  /// item is thrown here in its place; the one after is then next.
  std::optional<T> next() {
    if (next_ == count_) return std::nullopt;
    const std::size_t i = next_++;
    if (channels_.empty()) return make_(i);
    std::optional<Item> item = channels_[i % channels_.size()]->pop();
    if (!item) throw std::bad_alloc();  // the one reason for which a worker ends early
    if (auto* const failure = std::get_if<std::exception_ptr>(&*item)) {
      std::rethrow_exception(*failure);
    }
    return std::get<T>(std::move(*item));
  }

 private:
  struct Skipped {};
  using Item = std::variant<T, std::exception_ptr, Skipped>;

  Item compute(std::size_t i) const {
    if (i < first_wanted_.load()) return Item(std::in_place_index<2>);
    try {
      return Item(std::in_place_index<0>, make_(i));
    } catch (...) {
      return Item(std::in_place_index<1>, std::current_exception());
    }
  }

  void work(std::size_t worker, const std::stop_token& stop) noexcept {
    try {
      for (std::size_t i = worker; i < count_ && !stop.stop_requested(); i += channels_.size()) {
        if (!channels_[worker]->push(compute(i), stop)) return;
      }
    } catch (...) {  // no memory for the queue: `next` tells it
      channels_[worker]->close();
    }
  }

  const std::size_t count_;
  const Make make_;
  std::size_t next_ = 0;
  std::atomic<std::size_t> first_wanted_{0};
  std::vector<std::unique_ptr<Channel<Item>>> channels_;
  std::vector<std::jthread> threads_;  ///< last: joined before the channels go
};

}  // namespace ydd
