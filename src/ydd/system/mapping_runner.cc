// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/mapping_runner.h"

#include <atomic>
#include <thread>
#include <utility>
#include <variant>

#include "ydd/base/channel.h"
#include "ydd/base/log.h"
#include "ydd/base/published.h"

namespace ydd {
namespace {

LoopReport describe(const Atlas& atlas, const LoopMatch& match) {
  const KeyFrame& current = atlas.at(match.current);
  const KeyFrame& matched = atlas.at(match.matched);
  const SE3 drift = current.T_world_camera.inverse() * match.T_world_current;
  return {match.current,
          match.matched,
          current.frame_index,
          matched.frame_index,
          static_cast<int>(match.seen.size()),
          drift.translation().norm(),
          current.map != matched.map,
          matched.T_world_camera.inverse() * match.T_world_current};
}

std::optional<LoopMatch> timed_find_loop(const Atlas& atlas, KeyFrameId id,
                                         const LoopOptions& options, MappingReports& reports) {
  StageTimer timer(reports.loop_times, "find_loop");
  return find_loop(atlas, id, options);
}

Correction timed_correct_loop(const Atlas& atlas, const LoopMatch& match,
                              const LoopOptions& options, MappingReports& reports) {
  reports.loops.push_back(describe(atlas, match));
  const LoopReport& loop = reports.loops.back();
  log::info("frame {}: {} with frame {} ({} points, {:.3f} m)", loop.current_frame,
            loop.welded ? "map welded" : "loop closed", loop.matched_frame, loop.inliers,
            loop.shift_m);
  StageTimer timer(reports.loop_times, "correct_loop");
  return correct_loop(atlas, match, options);
}

std::optional<Correction> timed_full_bundle(const Atlas& atlas, KeyFrameId id,
                                            const LoopOptions& options, MappingReports& reports,
                                            std::stop_token stop) {
  if (!options.full_bundle) return std::nullopt;
  StageTimer timer(reports.loop_times, "full_bundle");
  return full_bundle(atlas, id, options, std::move(stop));
}

class InlineMapping final : public MappingRunner {
 public:
  InlineMapping(Mapper mapper, const LoopOptions& options)
      : mapper_(std::move(mapper)), options_(options), atlas_(mapper_.snapshot()) {}

  bool submit(KeyFrameCandidate candidate) override {
    if (finished_) return false;
    reports_.keyframes.push_back(mapper_.process(candidate));
    atlas_ = mapper_.snapshot();
    close_loop(reports_.keyframes.back().keyframe);
    return true;
  }
  bool idle() const override { return true; }
  std::shared_ptr<const Atlas> atlas() const override { return atlas_; }
  void finish() override { finished_ = true; }
  MappingReports reports() const override { return reports_; }

 private:
  void apply(const Correction& correction) {
    mapper_.apply(correction);
    atlas_ = mapper_.snapshot();
  }

  void close_loop(KeyFrameId id) {
    const auto match = timed_find_loop(*atlas_, id, options_, reports_);
    if (!match) return;
    apply(timed_correct_loop(*atlas_, *match, options_, reports_));
    const auto refined = timed_full_bundle(*atlas_, match->matched, options_, reports_, {});
    if (refined) apply(*refined);
  }

  Mapper mapper_;
  LoopOptions options_;
  std::shared_ptr<const Atlas> atlas_;
  MappingReports reports_;
  bool finished_ = false;
};

/// Counts work under way; `wait` returns when there is none.
class WorkCount {
 public:
  void begin() { count_.fetch_add(1); }
  void end() {
    count_.fetch_sub(1);
    count_.notify_all();
  }
  bool none() const { return count_.load() == 0; }
  void wait() const {
    for (int count = count_.load(); count != 0; count = count_.load()) count_.wait(count);
  }

 private:
  std::atomic<int> count_{0};
};

class ThreadedMapping final : public MappingRunner {
 public:
  ThreadedMapping(Mapper mapper, const LoopOptions& options)
      : mapper_(std::move(mapper)),
        options_(options),
        atlas_(mapper_.snapshot()),
        mapping_thread_([this] { run_mapping(); }),
        loop_thread_([this](const std::stop_token& stop) { run_loop(stop); }) {}

  ~ThreadedMapping() override { finish(); }

  bool submit(KeyFrameCandidate candidate) override {
    const bool starts_map = !candidate.reference.valid();
    candidates_.begin();
    const bool taken = starts_map ? mapping_queue_.push(std::move(candidate))
                                  : mapping_queue_.try_push(std::move(candidate));
    if (!taken) {
      candidates_.end();
      return false;
    }
    if (starts_map) map_started_.pop();
    return true;
  }
  bool idle() const override { return candidates_.none(); }
  std::shared_ptr<const Atlas> atlas() const override { return atlas_.get(); }

  void finish() override {
    if (!mapping_thread_.joinable()) return;
    candidates_.wait();      // every candidate is mapped and its loop task handed over,
    loop_tasks_.wait();      // every loop found and bundle done,
    mapping_queue_.close();  // so nothing but corrections can be left in the queue
    loop_queue_.close();
    mapping_thread_.join();
    loop_thread_.join();
  }

  MappingReports reports() const override {
    MappingReports all = loop_reports_;
    all.keyframes = keyframe_reports_;
    return all;
  }

 private:
  using MappingTask = std::variant<KeyFrameCandidate, Correction>;
  struct LoopTask {
    KeyFrameId keyframe;
    std::shared_ptr<const Atlas> atlas;
    bool full_bundle = false;
  };
  static constexpr std::size_t kMappingQueue = 3;  // more would be stale before it is mapped
  static constexpr std::size_t kLoopQueue = 8;

  void run_mapping() {
    while (auto task = mapping_queue_.pop()) {
      if (auto* candidate = std::get_if<KeyFrameCandidate>(&*task)) {
        map(*candidate);
      } else {
        correct(std::get<Correction>(*task));
      }
    }
  }

  void map(const KeyFrameCandidate& candidate) {
    keyframe_reports_.push_back(mapper_.process(candidate));
    publish();
    hand_to_loop({keyframe_reports_.back().keyframe, atlas_.get(), false});
    candidates_.end();
    if (!candidate.reference.valid()) map_started_.push(true);
  }

  void correct(const Correction& correction) {
    mapper_.apply(correction);
    publish();
    if (correction.seam) hand_to_loop({correction.seam->matched, atlas_.get(), true});
    loop_tasks_.end();  // the task whose correction this was
  }

  void publish() { atlas_.set(mapper_.snapshot()); }

  /// Never waits: a keyframe that finds the queue full is not looked at, which costs nothing but a
  /// chance that the next one has as well.
  void hand_to_loop(LoopTask task) {
    loop_tasks_.begin();
    if (!loop_queue_.try_push(std::move(task))) loop_tasks_.end();
  }

  void run_loop(const std::stop_token& stop) {
    while (const auto task = loop_queue_.pop()) {
      std::optional<Correction> correction = solve(*task, stop);
      // The mapper ends the task when it has applied the correction.
      const bool handed_on = correction && mapping_queue_.push(std::move(*correction));
      if (!handed_on) loop_tasks_.end();
    }
  }

  std::optional<Correction> solve(const LoopTask& task, const std::stop_token& stop) {
    if (task.full_bundle) {
      return timed_full_bundle(*task.atlas, task.keyframe, options_, loop_reports_, stop);
    }
    const auto match = timed_find_loop(*task.atlas, task.keyframe, options_, loop_reports_);
    if (!match) return std::nullopt;
    return timed_correct_loop(*task.atlas, *match, options_, loop_reports_);
  }

  Mapper mapper_;                               // of mapping_thread_
  std::vector<MapperReport> keyframe_reports_;  // likewise
  MappingReports loop_reports_;                 // of loop_thread_; all are read after finish()
  const LoopOptions options_;
  Published<Atlas> atlas_;
  Channel<MappingTask> mapping_queue_{kMappingQueue};
  Channel<LoopTask> loop_queue_{kLoopQueue};
  Channel<bool> map_started_{1};
  WorkCount candidates_;
  WorkCount loop_tasks_;
  std::jthread mapping_thread_;
  std::jthread loop_thread_;
};

}  // namespace

std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper, const LoopOptions& options) {
  return std::make_unique<InlineMapping>(std::move(mapper), options);
}

std::unique_ptr<MappingRunner> make_threaded_mapping(Mapper mapper, const LoopOptions& options) {
  return std::make_unique<ThreadedMapping>(std::move(mapper), options);
}

}  // namespace ydd
