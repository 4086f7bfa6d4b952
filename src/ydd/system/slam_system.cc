// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/slam_system.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "ydd/base/guard.h"
#include "ydd/base/log.h"
#include "ydd/dynamics/evidence_rules.h"
#include "ydd/dynamics/people_boxes.h"
#include "ydd/map/compatible.h"

namespace ydd {
namespace {

/// The run's camera with the lens of the map that it goes on in: new and old observations have one
/// calibration, and what check_same_camera lets pass stays an error of a few pixels.
Camera with_lens_of(const Camera& camera, const Camera& map) {
  Camera out = map;
  out.name = camera.name;
  out.depth_scale = camera.depth_scale;
  out.min_depth_m = camera.min_depth_m;
  out.max_depth_m = camera.max_depth_m;
  out.fps = camera.fps;
  return out;
}

PyramidScales scales_of(const SystemOptions& options) {
  return PyramidScales::make(options.orb.levels, options.orb.scale_step);
}

void check_same(const Atlas& map, const Camera& camera, const SystemOptions& options) {
  if (!check_same_camera(map.camera(), camera) ||
      !check_same_scales(map.scales(), scales_of(options))) {
    throw std::logic_error("SlamSystem: a map of another camera or pyramid");
  }
}

std::unique_ptr<MappingRunner> make_mapping(Atlas atlas, const SystemOptions& options) {
  Mapper mapper(std::move(atlas), options.mapping);
  return options.deterministic ? make_inline_mapping(std::move(mapper), options.loop)
                               : make_threaded_mapping(std::move(mapper), options.loop);
}

}  // namespace

SlamSystem::Beginning SlamSystem::begin_with(const Camera& camera, const SystemOptions& options,
                                             std::optional<Atlas> map) {
  const SystemOptions resolved = options.resolved();
  if (!map) {
    return {camera, false, make_mapping(Atlas(camera, scales_of(resolved)), resolved), nullptr};
  }
  check_same(*map, camera, resolved);
  return {with_lens_of(camera, map->camera()), !map->keyframes().empty(),
          make_mapping(std::move(*map), resolved), nullptr};
}

SlamSystem::Beginning SlamSystem::begin_with(const Camera& camera, const SystemOptions& options,
                                             std::unique_ptr<NearbyMap> map) {
  const auto atlas = map->atlas();
  check_same(*atlas, camera, options.resolved());
  NearbyMap* const nearby = map.get();
  return {with_lens_of(camera, atlas->camera()), true, std::move(map), nearby};
}

SlamSystem::SlamSystem(const Camera& camera, const SystemOptions& options,
                       ObjectCatalogue catalogue, std::unique_ptr<Detector> detector,
                       std::optional<Atlas> map)
    : SlamSystem(begin_with(camera, options, std::move(map)), options, std::move(catalogue),
                 std::move(detector)) {}

SlamSystem::SlamSystem(const Camera& camera, const SystemOptions& options,
                       ObjectCatalogue catalogue, std::unique_ptr<Detector> detector,
                       std::unique_ptr<NearbyMap> map)
    : SlamSystem(begin_with(camera, options, std::move(map)), options, std::move(catalogue),
                 std::move(detector)) {
  tracker_.set_localization_only(true);
}

SlamSystem::SlamSystem(Beginning beginning, const SystemOptions& options, ObjectCatalogue catalogue,
                       std::unique_ptr<Detector> detector)
    : camera_(std::move(beginning.camera)),
      options_(options.resolved()),
      extractor_(options_.orb),
      judge_(options_.dynamics, std::move(catalogue)),
      evidence_(options_.dynamics.evidence, camera_),
      tracker_(options_.tracking, beginning.in_known_map),
      followed_(camera_, judge_.catalogue(), options_.dynamics.evidence.noise, options_.tracks),
      reckoning_(options_.reckoning),
      mapping_(std::move(beginning.mapping)),
      nearby_(beginning.nearby) {
  if (!detector) return;
  if (options_.detect.asynchronous()) {
    asynchronous_ = std::make_unique<AsynchronousDetection>(std::move(detector), options_.detect,
                                                            judge_.catalogue());
  } else {
    detector_ = std::make_unique<DetectorRunner>(std::move(detector));
  }
}

Result<FrameReport> SlamSystem::process(const RgbdFrame& frame, std::optional<Detections> given) {
  if (const Result<void> failed = mapping_->failure(); !failed) return failed.error();
  FrameReport report;
  report.index = frame.index;
  report.stamp = frame.stamp;
  StageTimes total;
  StageTimer total_timer(total, "total");
  if (patient_) wait_for_mapper(report);
  if (detector_ && !given) detector_->start(frame);
  const auto features = std::make_shared<const Features>(extract(frame, report));
  look_for_motion(frame, features, report);  // while the detector still works
  report.looked = given || detector_;
  Result<Detections> detections = given ? *std::move(given) : ask_detector(frame, report);
  if (!detections) return detections.error();
  report.detections = std::move(*detections);
  judge(frame, *features, report);
  look_for_place(report);
  const std::shared_ptr<const Atlas> known = atlas();
  if (auto r = track(frame, *known, report); !r) return r.error();
  settle_evidence(report);
  follow_objects(frame, *known, report);
  settle_reckoning(report);
  if (saver_) saver_->offer(atlas());
  total_timer.stop();
  report.times.push_back(total.front());
  return report;
}

void SlamSystem::wait_for_mapper(FrameReport& report) {
  StageTimer timer(report.times, "wait_for_mapper");
  const auto lag_ns = static_cast<std::int64_t>(options_.mapping_lag_s * 1e9);
  mapping_->wait_for_frames_before({report.stamp.ns - lag_ns});
}

void SlamSystem::add(const ImuSample& sample) {
  reckoning_.add(sample);
  if (!options_.mapping.inertial.enabled) return;
  // No keyframe for long means that no link will be made of what came first.
  constexpr std::size_t kMost = 20000;
  if (imu_for_mapping_.size() >= kMost) {
    imu_for_mapping_.erase(imu_for_mapping_.begin(), imu_for_mapping_.begin() + kMost / 2);
  }
  imu_for_mapping_.push_back(sample);
}

void SlamSystem::look_for_motion(const RgbdFrame& frame,
                                 const std::shared_ptr<const Features>& features,
                                 FrameReport& report) {
  if (variant() != Variant::evidence) return;
  StageTimer timer(report.times, "evidence");
  report.odds =
      std::make_shared<const MotionOdds>(evidence_.look(features, frame.depth_m, frame.stamp));
}

void SlamSystem::judge(const RgbdFrame& frame, const Features& features, FrameReport& report) {
  StageTimer timer(report.times, "dynamics");
  report.judgement = judge_.judge(features, report.detections, frame.depth_m, report.odds.get());
  report.filtered =
      std::make_shared<const FilteredFeatures>(filter_features(features, report.judgement));
}

/// Of a map in a file, what a lost camera may be looking at.
void SlamSystem::look_for_place(FrameReport& report) {
  if (!nearby_ || tracker_.state() != TrackingState::lost) return;
  StageTimer timer(report.times, "look_for_place");
  nearby_->look_for(std::make_shared<const BagOfWords>(
      bag_of_words(builtin_vocabulary(), report.filtered->kept->descriptors)));
}

void SlamSystem::settle_evidence(FrameReport& report) {
  if (!report.odds) return;
  StageTimer timer(report.times, "settle_evidence");
  if (!report.track.doubt.empty()) return evidence_.withhold(report.track.T_camera_last);
  evidence_.settle(report.track.T_camera_last,
                   prior_of_cells(report.judgement.regions, *report.odds));
}

void SlamSystem::follow_objects(const RgbdFrame& frame, const Atlas& known, FrameReport& report) {
  StageTimer timer(report.times, "tracks");
  const TrackResult& track = report.track;
  const SightedFrame sighted{report.judgement, report.detections, frame.depth_m, report.odds.get()};
  const bool believed =
      track.state == TrackingState::tracking && track.reference.valid() && !track.reckoned;
  report.tracks =
      believed ? followed_.see(frame.stamp, sighted, known,
                               {track.reference, track.T_reference_camera, track.T_world_camera})
               : followed_.coast(frame.stamp, known);
}

/// What was seen teaches the senses of motion.
void SlamSystem::settle_reckoning(const FrameReport& report) {
  const TrackResult& track = report.track;
  const bool seen = track.reference.valid() && !track.reckoned;
  if (seen && reckoning_.has_samples()) reckoning_.see(report.stamp, track.T_camera_seen);
}

Features SlamSystem::extract(const RgbdFrame& frame, FrameReport& report) {
  report.requested = judge_.budget();
  StageTimer timer(report.times, "features");
  return with_geometry(extractor_.extract(frame.grey, report.requested), camera_, frame.depth_m);
}

Result<Detections> SlamSystem::ask_detector(const RgbdFrame& frame, FrameReport& report) {
  if (asynchronous_) {
    AsynchronousDetection::Boxes boxes = asynchronous_->next(frame);
    report.times.insert(report.times.end(), boxes.times.begin(), boxes.times.end());
    return std::move(boxes.detections);
  }
  if (!detector_) return Detections{};
  StageTimes waited;
  StageTimer timer(waited, "wait_for_detector");
  DetectorRunner::Answer answer = detector_->join();
  timer.stop();
  report.times.push_back(waited.front());
  report.times.push_back(answer.time);
  return std::move(answer.detections);
}

PictureSource SlamSystem::picture_of(const RgbdFrame& frame, const FrameReport& report) const {
  PictureSource source{frame.colour, frame.depth_m, report.judgement.regions, report.odds};
  if (options_.map.behind_people) return source;
  source.people = people_boxes(report.detections, report.judgement, judge_.catalogue());
  source.looked = report.looked;
  return source;
}

Result<void> SlamSystem::track(const RgbdFrame& frame, const Atlas& known, FrameReport& report) {
  TrackedFrame tracked;
  tracked.index = frame.index;
  tracked.stamp = frame.stamp;
  tracked.shared_features = report.filtered->kept;
  tracked.odds = report.odds;
  tracked.reckoned = reckoning_.since_seen(frame.stamp);
  const RepeatedPictures::Verdict repeated = repeated_pictures_.look(frame);
  tracked.stale = repeated.stale;
  tracked.doubt = repeated.doubt;
  if (options_.map.pictures) {
    tracked.picture = std::make_shared<const PictureSource>(picture_of(frame, report));
  }
  {
    StageTimer timer(report.times, "grid");
    tracked.grid = std::make_shared<const KeypointGrid>(*report.filtered->kept, camera_);
  }
  report.track = tracker_.track(std::move(tracked), known, mapping_->idle());
  auto& times = report.track.times;
  report.times.insert(report.times.end(), times.begin(), times.end());
  report.points = report.track.points;
  std::optional<KeyFrameCandidate> candidate = std::exchange(report.track.candidate, {});
  if (candidate) {
    StageTimer timer(report.times, "submit_keyframe");
    candidate->imu = imu_for_mapping_;
    const Result<bool> taken = mapping_->submit(std::move(*candidate));
    if (!taken) return taken.error();
    report.keyframe = *taken;
    if (*taken) imu_for_mapping_.clear();
  }
  const bool has_pose =
      report.track.state == TrackingState::tracking || report.track.reference.valid();
  if (!has_pose) return {};
  if (nearby_ && report.track.reference.valid()) nearby_->follow(report.track.reference);
  // The frame that starts a map is its first keyframe, which exists only now.
  if (!report.track.reference.valid()) report.track.reference = atlas()->newest_keyframe();
  trajectory_.push_back({frame.stamp, report.track.reference, report.track.T_reference_camera});
  return {};
}

void SlamSystem::set_variant(Variant variant) {
  if (variant == this->variant()) return;
  judge_.set_variant(variant);
  evidence_.clear();
}

void SlamSystem::set_localization_only(bool on) {
  if (!on && nearby_) {
    log::warning("only a part of the map is in memory: it is used as it is and not changed");
    return;
  }
  tracker_.set_localization_only(on);
}

void SlamSystem::reset() {
  const Variant variant = judge_.options().variant;
  (void)mapping_->finish(Ending::prompt);  // its failure goes with its map
  mapping_ = make_mapping(Atlas(camera_, scales_of(options_)), options_);
  nearby_ = nullptr;
  tracker_ = Tracker(options_.tracking);
  judge_ = DynamicsJudge(options_.dynamics, judge_.catalogue());
  judge_.set_variant(variant);
  evidence_.clear();
  followed_.clear();
  reckoning_.clear();
  imu_for_mapping_.clear();
  if (asynchronous_) asynchronous_->forget();
  repeated_pictures_ = {};
  trajectory_.clear();
}

Result<void> SlamSystem::finish(Ending ending) { return mapping_->finish(ending); }

namespace {

Error only_a_part(const std::filesystem::path& file) {
  return Error{file.string() + ": cannot be saved to: only a part of the map is in memory"};
}

}  // namespace

Result<void> SlamSystem::autosave_to(const std::filesystem::path& file, Replacing replacing) {
  if (nearby_) return only_a_part(file);
  Result<MapWriter> writer = MapWriter::open(file, replacing, map_key_);
  if (!writer) return writer.error();
  return guarded(file.native(), [&]() -> Result<void> {
    saver_ = std::make_unique<MapSaver>(std::move(*writer), options_.map.autosave_s);
    return {};
  });
}

Result<void> SlamSystem::save_map(const std::filesystem::path& file) {
  if (nearby_) return only_a_part(file);
  if (saver_ && saver_->file() == map_file_target(file)) {
    return saver_->save(atlas());
  }
  return ydd::save_map(*atlas(), file, Replacing::lesser, map_key_);
}

MapId SlamSystem::main_map() const {
  const auto map = atlas();
  std::map<MapId, int> frames;
  for (const TrajectoryEntry& entry : trajectory_) ++frames[map->map_of(entry.reference)];
  const auto most =
      std::max_element(frames.begin(), frames.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == frames.end() ? MapId{} : most->first;
}

StampedPoses SlamSystem::trajectory() const {
  const auto map = atlas();
  const MapId wanted = main_map();
  StampedPoses poses;
  poses.reserve(trajectory_.size());
  for (const TrajectoryEntry& entry : trajectory_) {
    if (map->map_of(entry.reference) != wanted) continue;
    const std::optional<SE3> T_world_reference = map->T_world_keyframe(entry.reference);
    poses.push_back({entry.stamp, T_world_reference.value() * entry.T_reference_camera});
  }
  return poses;
}

StampedPoses SlamSystem::keyframe_trajectory() const {
  const MapId wanted = main_map();
  StampedPoses poses;
  atlas()->keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    if (keyframe.map == wanted) poses.push_back({keyframe.stamp, keyframe.T_world_camera});
  });
  std::sort(poses.begin(), poses.end(),
            [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  return poses;
}

}  // namespace ydd
