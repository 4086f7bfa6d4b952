// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timing.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/dynamics/judge.h"
#include "ydd/evidence/motion_evidence.h"
#include "ydd/system/detector_runner.h"
#include "ydd/system/followed_objects.h"
#include "ydd/system/map_saver.h"
#include "ydd/system/mapping_runner.h"
#include "ydd/system/nearby_map.h"
#include "ydd/system/repeated_pictures.h"
#include "ydd/system/system_options.h"

namespace ydd {

/// Everything that became of one frame, by value: for files, pictures and viewers.
struct FrameReport {
  std::int64_t index = 0;                  ///< position in the sequence
  Timestamp stamp;                         ///< of the colour image
  TrackResult track;                       ///< without its candidate
  bool keyframe = false;                   ///< whether the map keeps it
  int requested = 0;                       ///< features asked for
  Detections detections;                   ///< boxes by which it was judged
  bool looked = false;                     ///< for objects, in this very frame
  std::shared_ptr<const MotionOdds> odds;  ///< that surfaces move; null unless asked for
  Judgement judgement;                     ///< what moves in it
  /// Its points: kept ones and rejected ones; never null.
  std::shared_ptr<const FilteredFeatures> filtered;
  std::vector<MapPointId> points;  ///< per kept keypoint
  std::vector<WorldTrack> tracks;  ///< people and moving things, in the world of T_world_camera
  StageTimes times;                ///< of this frame, in order; "total" last
};

/// Where the camera was relative to a keyframe; resolved against the final map.
struct TrajectoryEntry {
  Timestamp stamp;         ///< of the frame
  KeyFrameId reference;    ///< the keyframe that it was tracked by; perhaps culled since
  SE3 T_reference_camera;  ///< where the camera was in the frame of that keyframe
};

/// The whole system: features || detections -> what moves -> tracking -> mapping.
///
/// Thread: one caller. The detector and (unless deterministic) the mapper have threads inside.
class SlamSystem {
 public:
  /// `detector` may be null: then nothing is ever judged to move.
  /// With `map` it starts lost in that map and goes on with it once it has found its place, or
  /// starts a further map when that takes too long.
  /// @throws std::logic_error unless camera and pyramid are those of the map (check_same_camera,
  /// check_same_scales).
  SlamSystem(const Camera& camera, const SystemOptions& options, ObjectCatalogue catalogue,
             std::unique_ptr<Detector> detector, std::optional<Atlas> map = std::nullopt);

  /// Starts lost in a map of which only what is near the camera is in memory. It is used and not
  /// changed: localization only, and that cannot be switched off; `atlas()` is the part that is
  /// there. @throws std::logic_error as above.
  SlamSystem(const Camera& camera, const SystemOptions& options, ObjectCatalogue catalogue,
             std::unique_ptr<Detector> detector, std::unique_ptr<NearbyMap> map);

  /// Fails when the detector cannot judge the frame, or when one of the threads inside has failed;
  /// what was tracked before stays as it is. With `given` the detector is not asked: these are the
  /// boxes of the frame, as a detector gives them (given_detections).
  Result<FrameReport> process(const RgbdFrame& frame, std::optional<Detections> given = {});

  /// What motion sensors say, in the order of time and up to a frame before that frame; mountings
  /// are options (`reckoning`).
  void add(const ImuSample& sample);
  void add(const OdometryPose& pose) { reckoning_.add(pose); }  ///< As the other.

  /// For recordings that are played faster than a camera would: a frame waits for a mapper that is
  /// further behind than `mapping_lag_s` in the recording's time. A camera does not wait.
  void set_patient(bool on) { patient_ = on; }

  /// What is rejected from the next frame on.
  void set_variant(Variant variant);
  Variant variant() const { return judge_.options().variant; }  ///< What is rejected now.

  /// Forgets every map, the trajectory and what is known of persons; the next frame starts the
  /// first map again, with the variant of now. What the mapper still has is dropped.
  /// Ids given out so far mean nothing afterwards. Mapping goes on also if it was switched off, and
  /// an autosave file will hold the new map.
  void reset();

  /// Whether the map is used without being changed: no keyframe is inserted and no map started. May
  /// be switched between any two frames; what the mapper already has is still worked off.
  void set_localization_only(bool on);
  /// Whether the map is used without being changed.
  bool localization_only() const { return tracker_.localization_only(); }

  /// What encrypts the files of the two functions below from their next call on; empty (as it
  /// begins): nothing does.
  void set_map_key(MapKey key) { map_key_ = std::move(key); }
  /// From now on saves the map to `file` every `map.autosave_s` seconds, from a snapshot and in a
  /// thread of its own. Failure: as MapWriter::open. Later failures are logged.
  Result<void> autosave_to(const std::filesystem::path& file,
                           Replacing replacing = Replacing::lesser);
  /// Saves the map as it is now, whole when it returns; also after `finish`.
  Result<void> save_map(const std::filesystem::path& file);

  /// Finishes what the mapper still has, or, with a prompt ending, interrupts it and keeps what
  /// there is. Afterwards nothing may be processed. Tells what went wrong in a thread inside; map
  /// and trajectory are there all the same.
  Result<void> finish(Ending ending = Ending::complete);

  /// Poses of the frames that were tracked in the main map (the one that most frames belong to),
  /// resolved against its newest state. Frames of another map that was never merged into it have no
  /// place in its world.
  StampedPoses trajectory() const;
  /// Poses of the keyframes of the main map.
  StampedPoses keyframe_trajectory() const;
  /// All maps as they are now, immutable.
  std::shared_ptr<const Atlas> atlas() const { return mapping_->atlas(); }
  /// What mapping and loop closing did until now.
  MappingReports mapping_reports() const { return mapping_->reports(); }
  /// How long each save to the autosave file took; complete after `finish`.
  StageTimes save_times() const { return saver_ ? saver_->times() : StageTimes(); }

 private:
  /// What a system begins with.
  struct Beginning {
    Camera camera;
    bool in_known_map = false;
    std::unique_ptr<MappingRunner> mapping;
    NearbyMap* nearby = nullptr;
  };
  SlamSystem(Beginning beginning, const SystemOptions& options, ObjectCatalogue catalogue,
             std::unique_ptr<Detector> detector);
  static Beginning begin_with(const Camera& camera, const SystemOptions& options,
                              std::optional<Atlas> map);
  static Beginning begin_with(const Camera& camera, const SystemOptions& options,
                              std::unique_ptr<NearbyMap> map);
  void wait_for_mapper(FrameReport& report);
  Features extract(const RgbdFrame& frame, FrameReport& report);
  Result<Detections> ask_detector(const RgbdFrame& frame, FrameReport& report);
  void look_for_motion(const RgbdFrame& frame, const std::shared_ptr<const Features>& features,
                       FrameReport& report);
  void judge(const RgbdFrame& frame, const Features& features, FrameReport& report);
  void look_for_place(FrameReport& report);
  PictureSource picture_of(const RgbdFrame& frame, const FrameReport& report) const;
  Result<void> track(const RgbdFrame& frame, const Atlas& known, FrameReport& report);
  void settle_evidence(FrameReport& report);
  void follow_objects(const RgbdFrame& frame, const Atlas& known, FrameReport& report);
  void settle_reckoning(const FrameReport& report);
  MapId main_map() const;

  Camera camera_;
  SystemOptions options_;
  OrbExtractor extractor_;
  DynamicsJudge judge_;
  MotionEvidence evidence_;
  Tracker tracker_;
  FollowedObjects followed_;
  DeadReckoning reckoning_;
  std::vector<ImuSample> imu_for_mapping_;  ///< that no keyframe has taken along
  std::unique_ptr<MappingRunner> mapping_;
  NearbyMap* nearby_ = nullptr;                          // mapping_, if it is one
  std::unique_ptr<DetectorRunner> detector_;             // of every frame
  std::unique_ptr<AsynchronousDetection> asynchronous_;  // or this
  std::unique_ptr<MapSaver> saver_;
  MapKey map_key_;
  std::vector<TrajectoryEntry> trajectory_;
  RepeatedPictures repeated_pictures_;
  bool patient_ = false;
};

}  // namespace ydd
