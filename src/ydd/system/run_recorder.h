// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ydd/dataset/depth_shift.h"
#include "ydd/dataset/live_stream.h"
#include "ydd/dataset/pairing.h"
#include "ydd/system/slam_system.h"

namespace ydd {

/// What a run was asked to do, for its summary.
struct RunDescription {
  std::string sequence;
  std::string variant;   ///< off | box | person | full | evidence
  std::string detector;  ///< file of the detector or recording; empty: none
  bool deterministic = false;
  bool realtime = false;
  int seed = 0;
  std::string groundtruth = {};  ///< file; empty: the sequence has none
  std::string incomplete = {};   ///< why the run ended before its sequence did; empty: it did not
  std::optional<Pairing> pairing = {};  ///< of colour and depth by time
  std::string device = {};      ///< where the detector's networks are computed; empty: none are
  DepthShift depth_shift = {};  ///< by which depth was moved back
  std::map<std::string, std::string> versions = {};  ///< of what the program is made of, by name
};

/// How large the map was when a frame had been tracked.
struct MapSize {
  std::size_t keyframes = 0;
  std::size_t points = 0;
};

/// Collects what a run did, frame by frame, and tells it as JSON.
class RunRecorder {
 public:
  void add(const FrameReport& report, const MapSize& map = {});
  void add_skipped(std::int64_t frame, const std::string& reason);
  void add_dropped(int frames) { dropped_ += frames; }
  /// What came from the camera that the run looked through, in the end.
  void add_camera(const LiveCounts& counts);
  /// What somebody asked for while it ran (docs/live-view.md); `after_frame` -1: before the first.
  void add_command(std::int64_t after_frame, const std::string& command);

  /// Frames read, tracked, lost, skipped; map size; points rejected per rule; medians of stages.
  std::string summary_json(const RunDescription& run, const SlamSystem& system,
                           double wall_seconds) const;
  /// Per stage statistics in milliseconds (wall and processor time of the stage's thread), of the
  /// tracker per frame and of the mapper per keyframe, and the series behind them.
  std::string timings_json(const SlamSystem& system) const;
  /// One list per property, one entry per processed frame: index, stamp_s, state, keyframe,
  /// requested, kept, inliers, objects_moving and objects_still (detected objects whose odds to
  /// move are known, by what they are judged to do: variant `evidence`), keyframes, points,
  /// total_wall_ms; and lists by name in rejected (rule) and stages_cpu_ms (null where a stage did
  /// not run).
  std::string frames_json() const;

  int frames_in() const { return processed_ + dropped_ + static_cast<int>(skipped_.size()); }
  int processed() const { return processed_; }
  int tracked() const { return tracked_; }

 private:
  struct Span {
    std::int64_t first = 0, last = 0;
  };
  struct Series {
    std::vector<double> wall_ms, cpu_ms;
  };
  /// Detected objects whose odds to move are known.
  struct Objects {
    int moving = 0, still = 0;
  };
  /// What is recorded of a single frame.
  struct Frame {
    std::int64_t index = 0;
    Timestamp stamp;
    TrackingState state = TrackingState::initializing;
    bool keyframe = false;
    int requested = 0, inliers = 0;
    double agreement = 0;
    std::size_t kept = 0;
    std::array<int, kRuleCount> rules{};
    Objects objects;
    MapSize map;
    StageTimes times;
  };
  static Objects count_objects(const Judgement& judgement);
  static std::map<std::string, Series> mapper_series(const SlamSystem& system);

  int processed_ = 0;
  int tracked_ = 0;
  int keyframes_ = 0;
  int dropped_ = 0;
  std::optional<LiveCounts> camera_;
  std::vector<std::pair<std::int64_t, std::string>> skipped_;
  std::vector<std::pair<std::int64_t, std::string>> commands_;
  std::map<std::string, int> doubts_;  ///< frames by why they coast
  std::vector<Span> lost_;
  std::vector<double> requested_, kept_;
  std::array<std::int64_t, kRuleCount> rules_{};
  std::map<std::string, Series> stages_;
  std::vector<Frame> frames_;
};

/// Largest resident size of this process so far, megabytes.
double peak_resident_mb();

}  // namespace ydd
