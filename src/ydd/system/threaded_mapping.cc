// SPDX-License-Identifier: Apache-2.0
//
// The mapper's thread owns the map; the loop closer's thread reads what it publishes and asks it to
// apply corrections. The mapper never waits for the loop closer, so they cannot wait for each
// other.
#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "ydd/base/channel.h"
#include "ydd/base/guard.h"
#include "ydd/base/published.h"
#include "ydd/system/loop_steps.h"

namespace ydd {
namespace {

/// Stamps of the candidates that wait or are being worked on. They are taken in by one thread and
/// worked off by another, in the same order.
class CandidatesAtWork {
 public:
  void add(Timestamp stamp) {
    const std::lock_guard lock(mutex_);
    stamps_.push_back(stamp);
  }
  void withdraw_newest() {
    const std::lock_guard lock(mutex_);
    stamps_.pop_back();
  }
  void oldest_is_done() {
    const std::lock_guard lock(mutex_);
    stamps_.pop_front();
    fewer_.notify_all();
  }
  bool none() const {
    const std::lock_guard lock(mutex_);
    return stamps_.empty();
  }
  void wait_for_frames_before(Timestamp stamp) {
    std::unique_lock lock(mutex_);
    fewer_.wait(lock, [&] { return abandoned_ || stamps_.empty() || stamps_.front() >= stamp; });
  }
  /// Nobody works them off any more, and nobody waits for it.
  void abandon() {
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
    fewer_.notify_all();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable fewer_;
  std::deque<Timestamp> stamps_;
  bool abandoned_ = false;
};

class ThreadedMapping final : public MappingRunner {
 public:
  ThreadedMapping(Mapper mapper, const LoopOptions& options)
      : mapper_(std::move(mapper)),
        options_(options),
        atlas_(mapper_.snapshot()),
        mapping_thread_([this](const std::stop_token& abandoned) { run_mapping(abandoned); }),
        loop_thread_([this](const std::stop_token& abandoned) { run_loop(abandoned); }) {}

  /// What is queued is dropped; the threads learn of it where they are joined.
  ~ThreadedMapping() override { solving_.request_stop(); }
  ThreadedMapping(const ThreadedMapping&) = delete;
  ThreadedMapping& operator=(const ThreadedMapping&) = delete;

  Result<bool> submit(KeyFrameCandidate candidate) override {
    const bool starts_map = !candidate.reference.valid();
    candidates_.add(candidate.frame.stamp);
    const bool taken = starts_map ? mapping_queue_.push(std::move(candidate))
                                  : mapping_queue_.try_push(std::move(candidate));
    if (!taken) candidates_.withdraw_newest();
    if (taken && starts_map) map_started_.pop();
    if (const Result<void> failed = failure_.get(); !failed) return failed.error();
    return taken;
  }
  bool idle() const override { return candidates_.none(); }
  void wait_for_frames_before(Timestamp stamp) override {
    candidates_.wait_for_frames_before(stamp);
  }
  std::shared_ptr<const Atlas> atlas() const override { return atlas_.get(); }
  Result<void> failure() const override { return failure_.get(); }

  Result<void> finish(Ending ending) override {
    end(ending);
    return failure_.get();
  }

  MappingReports reports() const override {
    MappingReports all = loop_reports_;
    all.keyframes = keyframe_reports_;
    all.loop_counts.keyframes_left_out += left_out_;
    return all;
  }

 private:
  /// Everything before it in the queue has been worked off when it is answered.
  struct Drain {};
  using MappingTask = std::variant<KeyFrameCandidate, Correction, Drain>;
  static constexpr std::size_t kMappingQueue = 3;  // more would be stale before it is mapped
  static constexpr std::size_t kLoopQueue = 8;

  void end(Ending ending) {
    if (!mapping_thread_.joinable()) return;
    if (ending == Ending::prompt) solving_.request_stop();
    // Every candidate is mapped and handed to the loop closer, ...
    if (mapping_queue_.push(Drain{})) drained_.pop();
    // ... which closes the loops that it finds, while the mapper still applies corrections.
    loop_queue_.close();
    loop_thread_.join();
    mapping_queue_.close();
    mapping_thread_.join();
  }

  // --- the mapper's thread

  /// `abandoned` when the other thread could not be started.
  void run_mapping(const std::stop_token& abandoned) noexcept {
    keep(guarded("mapping", [&]() -> Result<void> {
      while (auto task = mapping_queue_.pop(abandoned)) work_off(*task);
      return {};
    }));
    // However it ended: nobody waits for it any more.
    mapping_queue_.close();
    map_started_.close();
    applied_.close();
    drained_.close();
    candidates_.abandon();
  }

  void work_off(MappingTask& task) {
    if (auto* const candidate = std::get_if<KeyFrameCandidate>(&task)) {
      const bool starts_map = !candidate->reference.valid();
      if (!failure_) keep(guarded("mapping", [&] { return map(*candidate); }));
      candidates_.oldest_is_done();
      if (starts_map) map_started_.push(true);
    } else if (auto* const correction = std::get_if<Correction>(&task)) {
      Result<Applied> applied = Applied::refused;
      if (!failure_) applied = guarded("mapping", [&] { return correct(*correction); });
      if (!applied) failure_.set(applied.error());
      applied_.push(applied ? *applied : Applied::refused);
    } else {
      drained_.push(true);
    }
  }

  Result<void> map(const KeyFrameCandidate& candidate) {
    keyframe_reports_.push_back(mapper_.process(candidate, solving_.get_token()));
    publish();
    // A keyframe that finds the queue full is not looked at, which costs nothing but a chance that
    // the next one has as well.
    if (!loop_queue_.try_push(keyframe_reports_.back().keyframe)) ++left_out_;
    return {};
  }

  Result<Applied> correct(const Correction& correction) {
    const Applied applied = mapper_.apply(correction);
    if (applied != Applied::refused) publish();
    return applied;
  }

  void publish() { atlas_.set(mapper_.snapshot()); }

  // --- the loop closer's thread

  void run_loop(const std::stop_token& abandoned) noexcept {
    keep(guarded("loop closing", [&]() -> Result<void> {
      while (const auto step = next_step(abandoned)) {
        step->keyframe ? look_at(*step->keyframe) : refine();
      }
      return {};
    }));
    loop_queue_.close();
  }

  /// Without a keyframe: a full bundle is due.
  struct Step {
    std::optional<KeyFrameId> keyframe;
  };

  /// Keyframes first: one may close another loop, and one bundle then serves for both. But not for
  /// ever. Nothing: the end, or something has failed.
  std::optional<Step> next_step(const std::stop_token& abandoned) {
    const bool due = !bundles_due_.empty();
    if (failure_) return std::nullopt;
    if (due && looked_since_ >= kLoopQueue) return Step{};
    const auto keyframe = due ? loop_queue_.try_pop() : loop_queue_.pop(abandoned);
    if (keyframe) return Step{keyframe};
    return due ? std::optional<Step>(Step{}) : std::nullopt;
  }

  void look_at(KeyFrameId id) {
    ++looked_since_;
    if (solving_.stop_requested()) {
      ++loop_reports_.loop_counts.keyframes_left_out;
      return;
    }
    // Not the map that the keyframe was inserted into: a correction may have moved it since.
    const auto atlas = atlas_.get();
    const auto match = loop_steps::find(*atlas, id, options_, loop_reports_);
    if (!match) return;
    const auto correction =
        loop_steps::correct(*atlas, *match, options_, loop_reports_, solving_.get_token());
    if (!correction || !apply(*correction)) return;
    loop_steps::report(*atlas, *match, loop_reports_);
    if (options_.full_bundle) ask_for_bundle(match->matched);
  }

  /// The newest request stands for all of its map.
  void ask_for_bundle(KeyFrameId member) {
    const auto atlas = atlas_.get();
    const auto merged = std::erase_if(bundles_due_, [&](KeyFrameId other) {
      return atlas->map_of(other) == atlas->map_of(member);
    });
    loop_reports_.loop_counts.full_bundles_merged += static_cast<int>(merged);
    bundles_due_.push_back(member);
    looked_since_ = 0;
  }

  void refine() {
    const KeyFrameId member = bundles_due_.front();
    bundles_due_.erase(bundles_due_.begin());
    const auto atlas = atlas_.get();
    // It may have been culled since; the keyframe that it hangs on is of the same map.
    const auto correction = loop_steps::refine(*atlas, atlas->nearest_kept(member), options_,
                                               loop_reports_, solving_.get_token());
    if (!correction) return;
    if (apply(*correction)) {
      ++loop_reports_.loop_counts.full_bundles;
    } else {
      ask_for_bundle(member);  // of the map as it is now
    }
  }

  /// Waits for the mapper: the next correction is computed on a map that has this one.
  bool apply(Correction correction) {
    if (!mapping_queue_.push(std::move(correction))) return false;
    const std::optional<Applied> applied = applied_.pop();
    return applied && !failure_ && loop_steps::count(*applied, loop_reports_);
  }

  void keep(const Result<void>& result) {
    if (!result) failure_.set(result.error());
  }

  Mapper mapper_;                               // of mapping_thread_
  std::vector<MapperReport> keyframe_reports_;  // likewise
  int left_out_ = 0;                            // likewise
  MappingReports loop_reports_;                 // of loop_thread_; all are read after finish()
  std::vector<KeyFrameId> bundles_due_;         // likewise: a member of each map, oldest first
  std::size_t looked_since_ = 0;                // likewise: keyframes since the newest of these
  const LoopOptions options_;
  std::stop_source solving_;  ///< interrupts bundles and pose graphs
  FirstError failure_;
  Published<Atlas> atlas_;
  CandidatesAtWork candidates_;
  Channel<MappingTask> mapping_queue_{kMappingQueue};
  Channel<KeyFrameId> loop_queue_{kLoopQueue};
  Channel<bool> map_started_{1};
  Channel<bool> drained_{1};
  Channel<Applied> applied_{1};
  std::jthread mapping_thread_;
  std::jthread loop_thread_;
};

}  // namespace

std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper, const LoopOptions& options) {
  return std::make_unique<ThreadedMapping>(std::move(mapper), options);
}

}  // namespace ydd
