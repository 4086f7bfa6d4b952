// SPDX-License-Identifier: Apache-2.0
//
// The mapper's thread owns the map; the loop closer's thread reads what it publishes and asks it to
// apply corrections; a third solves full bundles, so that loops are looked for meanwhile. The
// mapper never waits for the loop closer, nor that for a bundle, so they cannot wait for each
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
        loop_thread_([this](const std::stop_token& abandoned) { run_loop(abandoned); }),
        bundle_thread_([this](const std::stop_token& abandoned) { run_bundles(abandoned); }) {}

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
    all.loop_times.insert(all.loop_times.end(), bundle_reports_.loop_times.begin(),
                          bundle_reports_.loop_times.end());
    return all;
  }

 private:
  /// Everything before it in the queue has been worked off when it is answered.
  struct Drain {};
  using MappingTask = std::variant<KeyFrameCandidate, Correction, Drain>;
  /// A full bundle, and what became of it.
  struct Bundle {
    std::shared_ptr<const Atlas> atlas;
    KeyFrameId member;
    std::stop_source stop;
    bool cut_short = false;
    std::optional<Correction> correction;
  };
  using LoopTask = std::variant<KeyFrameId, Bundle, Drain>;
  /// The bundle that is being solved.
  struct Running {
    KeyFrameId member;
    std::stop_source stop;
    bool outdated = false;  ///< a newer loop has been found
  };
  static constexpr std::size_t kMappingQueue = 3;  // more would be stale before it is mapped
  static constexpr std::size_t kLoopQueue = 8;
  static constexpr int kMostPulls = 3;  // in a row: loop upon loop must not keep a map unrefined

  void end(Ending ending) {
    if (!mapping_thread_.joinable()) return;
    if (ending == Ending::prompt) solving_.request_stop();
    // Every candidate is mapped and handed to the loop closer, ...
    if (mapping_queue_.push(Drain{})) drained_.pop();
    // ... which closes the loops that it finds, while the mapper still applies corrections.
    loop_queue_.push(Drain{});
    loop_thread_.join();
    bundle_thread_.join();
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
    if (!loop_queue_.try_push(LoopTask{keyframe_reports_.back().keyframe})) ++left_out_;
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
      while (!failure_ && !(draining_ && !running_ && bundles_due_.empty())) {
        auto task = loop_queue_.pop(abandoned);
        if (!task || failure_) break;
        if (const auto* const keyframe = std::get_if<KeyFrameId>(&*task)) {
          look_at(*keyframe);
        } else if (auto* const bundle = std::get_if<Bundle>(&*task)) {
          take_over(std::move(*bundle));
        } else {
          draining_ = true;
        }
        begin_bundle();
      }
      return {};
    }));
    if (running_) running_->stop.request_stop();
    loop_queue_.close();
    bundle_queue_.close();
  }

  void look_at(KeyFrameId id) {
    if (solving_.stop_requested()) {
      ++loop_reports_.loop_counts.keyframes_left_out;
      return;
    }
    // Not the map that the keyframe was inserted into: a correction may have moved it since.
    const auto atlas = atlas_.get();
    const auto match = loop_steps::find(*atlas, id, options_, loop_reports_);
    if (!match) return;
    if (is_refining(*atlas, *match)) {
      if (pulls_ == kMostPulls) {
        postponed_.push_back(id);
        return;
      }
      pull();
    }
    auto correction =
        loop_steps::correct(*atlas, *match, options_, loop_reports_, solving_.get_token());
    if (!correction) return;
    loop_steps::prepare(atlas, *correction, loop_reports_);
    if (!apply(*std::move(correction))) return;
    loop_steps::report(*atlas, *match, loop_reports_);
    if (options_.full_bundle) ask_for_bundle(match->matched);
  }

  /// Whether the bundle that is being solved moves what the loop is going to move.
  bool is_refining(const Atlas& atlas, const LoopMatch& match) const {
    if (!running_ || running_->outdated) return false;
    const MapId map = atlas.map_of(running_->member);
    return map == atlas.map_of(match.current) || map == atlas.map_of(match.matched);
  }

  /// The loop would make its result worthless: it ends after its iteration, and is due again.
  void pull() {
    running_->stop.request_stop();
    running_->outdated = true;
    bundles_due_.insert(bundles_due_.begin(), running_->member);
    ++pulls_;
    ++loop_reports_.loop_counts.full_bundles_begun_anew;
  }

  /// The newest request stands for all of its map.
  void ask_for_bundle(KeyFrameId member) {
    const auto atlas = atlas_.get();
    const auto merged = std::erase_if(bundles_due_, [&](KeyFrameId other) {
      return atlas->map_of(other) == atlas->map_of(member);
    });
    loop_reports_.loop_counts.full_bundles_merged += static_cast<int>(merged);
    bundles_due_.push_back(member);
  }

  /// Begins the bundle that has been due for longest, if none is being solved.
  void begin_bundle() {
    if (running_ || bundles_due_.empty()) return;
    if (solving_.stop_requested()) {
      loop_reports_.loop_counts.interrupted += static_cast<int>(bundles_due_.size());
      bundles_due_.clear();
      return;
    }
    Bundle bundle{atlas_.get(), bundles_due_.front(), {}, false, {}};
    running_ = Running{bundle.member, bundle.stop, false};
    bundles_due_.erase(bundles_due_.begin());
    bundle_queue_.push(std::move(bundle));
  }

  void take_over(Bundle bundle) {
    const bool outdated = running_->outdated;
    running_.reset();
    if (outdated) return;
    pulls_ = 0;
    const bool applied = bundle.correction && apply(*std::move(bundle.correction));
    if (bundle.cut_short) {
      ++loop_reports_.loop_counts.interrupted;
    } else if (applied) {
      ++loop_reports_.loop_counts.full_bundles;
    } else if (bundle.correction) {
      ask_for_bundle(bundle.member);  // of the map as it is now
    }
    for (const KeyFrameId id : std::exchange(postponed_, {})) look_at(id);
  }

  /// Waits for the mapper: the next correction is computed on a map that has this one.
  bool apply(Correction correction) {
    if (!mapping_queue_.push(std::move(correction))) return false;
    const std::optional<Applied> applied = applied_.pop();
    return applied && !failure_ && loop_steps::count(*applied, loop_reports_);
  }

  // --- the thread of bundles

  void run_bundles(const std::stop_token& abandoned) noexcept {
    keep(guarded("loop closing", [&]() -> Result<void> {
      while (auto bundle = bundle_queue_.pop(abandoned)) {
        solve(*bundle);
        if (!loop_queue_.push(*std::move(bundle), abandoned)) break;
      }
      return {};
    }));
    // Whoever waits for a bundle must not wait for ever; closing needs no memory.
    if (failure_) loop_queue_.close();
  }

  void solve(Bundle& bundle) {
    const std::stop_callback end_of_all(solving_.get_token(), [&] { bundle.stop.request_stop(); });
    // It may have been culled since; the keyframe that it hangs on is of the same map.
    bundle.correction = loop_steps::refine(*bundle.atlas, bundle.atlas->nearest_kept(bundle.member),
                                           options_, bundle_reports_, bundle.stop.get_token());
    bundle.cut_short = bundle.stop.stop_requested();
    bundle.atlas.reset();
  }

  void keep(const Result<void>& result) {
    if (!result) failure_.set(result.error());
  }

  Mapper mapper_;                               // of mapping_thread_
  std::vector<MapperReport> keyframe_reports_;  // likewise
  int left_out_ = 0;                            // likewise
  MappingReports loop_reports_;                 // of loop_thread_; all are read after finish()
  std::vector<KeyFrameId> bundles_due_;         // likewise: a member of each map, oldest first
  std::optional<Running> running_;              // likewise
  std::vector<KeyFrameId> postponed_;           // likewise: loops that wait for it
  int pulls_ = 0;                               // likewise: since a bundle was last let be
  bool draining_ = false;                       // likewise: no more keyframes come
  MappingReports bundle_reports_;               // of bundle_thread_; times only
  const LoopOptions options_;
  std::stop_source solving_;  ///< interrupts bundles and pose graphs
  FirstError failure_;
  Published<Atlas> atlas_;
  CandidatesAtWork candidates_;
  Channel<MappingTask> mapping_queue_{kMappingQueue};
  Channel<LoopTask> loop_queue_{kLoopQueue};
  Channel<Bundle> bundle_queue_{1};
  Channel<bool> map_started_{1};
  Channel<bool> drained_{1};
  Channel<Applied> applied_{1};
  std::jthread mapping_thread_;
  std::jthread loop_thread_;
  std::jthread bundle_thread_;
};

}  // namespace

std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper, const LoopOptions& options) {
  return std::make_unique<ThreadedMapping>(std::move(mapper), options);
}

}  // namespace ydd
