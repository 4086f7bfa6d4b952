// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/mapping_runner.h"

#include <atomic>
#include <thread>
#include <utility>

#include "ydd/base/channel.h"
#include "ydd/base/published.h"

namespace ydd {
namespace {

class InlineMapping final : public MappingRunner {
 public:
  explicit InlineMapping(Mapper mapper) : mapper_(std::move(mapper)), atlas_(mapper_.snapshot()) {}

  bool submit(KeyFrameCandidate candidate) override {
    if (finished_) return false;
    reports_.push_back(mapper_.process(candidate));
    atlas_ = mapper_.snapshot();
    return true;
  }
  bool idle() const override { return true; }
  std::shared_ptr<const Atlas> atlas() const override { return atlas_; }
  void finish() override { finished_ = true; }
  std::vector<MapperReport> reports() const override { return reports_; }

 private:
  Mapper mapper_;
  std::shared_ptr<const Atlas> atlas_;
  std::vector<MapperReport> reports_;
  bool finished_ = false;
};

class ThreadedMapping final : public MappingRunner {
 public:
  explicit ThreadedMapping(Mapper mapper)
      : mapper_(std::move(mapper)), atlas_(mapper_.snapshot()), thread_([this] { run(); }) {}

  ~ThreadedMapping() override { finish(); }

  bool submit(KeyFrameCandidate candidate) override {
    const bool starts_map = !candidate.reference.valid();
    pending_.fetch_add(1);
    const bool taken =
        starts_map ? queue_.push(std::move(candidate)) : queue_.try_push(std::move(candidate));
    if (!taken) {
      pending_.fetch_sub(1);
      return false;
    }
    if (starts_map) map_started_.pop();
    return true;
  }
  bool idle() const override { return pending_.load() == 0; }
  std::shared_ptr<const Atlas> atlas() const override { return atlas_.get(); }
  void finish() override {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }
  std::vector<MapperReport> reports() const override { return reports_; }

 private:
  static constexpr std::size_t kQueue = 3;  // more would be stale before it is mapped

  void run() {
    while (auto candidate = queue_.pop()) {
      reports_.push_back(mapper_.process(*candidate));
      atlas_.set(mapper_.snapshot());
      pending_.fetch_sub(1);
      if (!candidate->reference.valid()) map_started_.push(true);
    }
  }

  Mapper mapper_;                      // owned by thread_ from here on
  std::vector<MapperReport> reports_;  // likewise, read after finish()
  Published<Atlas> atlas_;
  Channel<KeyFrameCandidate> queue_{kQueue};
  Channel<bool> map_started_{1};
  std::atomic<int> pending_{0};
  std::jthread thread_;
};

}  // namespace

std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper) {
  return std::make_unique<InlineMapping>(std::move(mapper));
}

std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper) {
  return std::make_unique<ThreadedMapping>(std::move(mapper));
}

}  // namespace ydd
