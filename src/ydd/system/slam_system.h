// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/dynamics/judge.h"
#include "ydd/system/detector_runner.h"
#include "ydd/system/mapping_runner.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// Everything that became of one frame, by value: for files, pictures and viewers.
struct FrameReport {
  std::int64_t index = 0;
  Timestamp stamp;
  TrackResult track;  ///< without its candidate
  bool keyframe = false;
  int requested = 0;  ///< features asked for
  Detections detections;
  Judgement judgement;
  std::shared_ptr<const Observations> observations;
  std::vector<MapPointId> points;  ///< per kept keypoint
  StageTimes times;                ///< of this frame, in order; "total" last
};

/// Where the camera was relative to a keyframe; resolved against the final map.
struct TrajectoryEntry {
  Timestamp stamp;
  KeyFrameId reference;
  SE3 T_reference_camera;
};

/// The whole system: features || detections -> what moves -> tracking -> mapping.
///
/// Thread: one caller. The detector and (unless deterministic) the mapper have threads inside.
class SlamSystem {
 public:
  /// `detector` may be null: then nothing is ever judged to move.
  SlamSystem(const Camera& camera, const SystemOptions& options, ObjectCatalogue catalogue,
             std::unique_ptr<Detector> detector);

  /// Fails only when the detector cannot judge the frame.
  Result<FrameReport> process(const RgbdFrame& frame);

  /// What is rejected from the next frame on.
  void set_variant(Variant variant) { judge_.set_variant(variant); }
  Variant variant() const { return judge_.options().parsed_variant(); }

  /// Forgets every map, the trajectory and what is known of persons; the next frame starts the
  /// first map again, with the variant of now. Waits until the mapper has worked off what it has.
  /// Ids given out so far mean nothing afterwards.
  void reset();

  /// Works off what the mapper still has. Afterwards nothing may be processed.
  void finish();

  /// Poses of the frames that were tracked in the main map (the one that most frames belong to),
  /// resolved against its newest state. Frames of another map that was never welded to it have no
  /// place in its world.
  StampedPoses trajectory() const;
  /// Poses of the keyframes of the main map.
  StampedPoses keyframe_trajectory() const;
  std::shared_ptr<const Atlas> atlas() const { return mapping_->atlas(); }
  MappingReports mapping_reports() const { return mapping_->reports(); }

 private:
  Features extract(const RgbdFrame& frame, FrameReport& report);
  Result<Detections> join_detections(const RgbdFrame& frame, FrameReport& report);
  void track(const RgbdFrame& frame, FrameReport& report);
  bool submit(KeyFrameCandidate candidate);
  MapId main_map() const;

  Camera camera_;
  SystemOptions options_;
  OrbExtractor extractor_;
  DynamicsJudge judge_;
  Tracker tracker_;
  std::unique_ptr<MappingRunner> mapping_;
  std::unique_ptr<DetectorRunner> detector_;             // of every frame
  std::unique_ptr<AsynchronousDetection> asynchronous_;  // or this
  std::vector<TrajectoryEntry> trajectory_;
};

}  // namespace ydd
