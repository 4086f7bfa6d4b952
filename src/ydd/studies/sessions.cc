// SPDX-License-Identifier: Apache-2.0
#include "ydd/studies/sessions.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "ydd/base/interruption.h"
#include "ydd/base/timing.h"
#include "ydd/evaluation/ate.h"
#include "ydd/map_files/map_file.h"
#include "ydd/system/slam_system.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSessionFrames = 10'000'000;  // frame numbers of a session
constexpr double kMisplaced_m = 1.0;
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

/// Where the camera really was at frames of all sessions.
class Truth {
 public:
  explicit Truth(SessionPlan plan) : plan_(std::move(plan)) {}
  SE3 T_world_camera(std::int64_t frame) {
    const auto number = static_cast<int>(frame / kSessionFrames);
    const auto known = sessions_.find(number);
    const Session& session = known != sessions_.end()
                                 ? known->second
                                 : sessions_.emplace(number, plan_(number)).first->second;
    const auto index = static_cast<double>(frame % kSessionFrames);
    return session.path(1e-6 * std::round(1e6 * index / session.world.fps));
  }

 private:
  SessionPlan plan_;
  std::map<int, Session> sessions_;
};

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

Detections boxes_seen(const SimulatedFrame& frame) {
  Detections boxes;
  for (const SimulatedObject& object : frame.objects) {
    boxes.push_back({object.class_name, 1.0F, object.box});
  }
  return boxes;
}

/// Counts what the tracker said frame by frame.
struct FrameCounts {
  bool found = false, lost = false;
  std::vector<double> cpu_ms;

  void add(const FrameReport& report, SessionFigures& figures) {
    ++figures.frames;
    const double ms = report.times.empty() ? 0.0 : report.times.back().cpu_ms;
    cpu_ms.push_back(ms);
    const bool tracked = report.track.state == TrackingState::tracking ||
                         report.track.state == TrackingState::coasting;
    if (!found && tracked) {
      found = true;
      figures.frames_until_found = figures.frames - 1;
      figures.found_cpu_ms = ms;
    }
    if (!found) return;
    if (!tracked) ++figures.lost_frames;
    if (!tracked && !lost) ++figures.losses;
    if (tracked && lost) ++figures.recoveries;
    lost = !tracked;
  }
  void close(SessionFigures& figures) const {
    if (!found) figures.frames_until_found = figures.frames;
    const SeriesStatistics cpu = statistics_of(cpu_ms);
    figures.frame_cpu_ms_median = cpu.median;
    figures.frame_cpu_ms_p95 = cpu.p95;
  }
};

/// The map that most keyframes belong to.
MapId largest_map(const Atlas& atlas) {
  std::map<MapId, std::size_t> sizes;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { ++sizes[k.map]; });
  const auto largest = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return largest == sizes.end() ? MapId{} : largest->first;
}

void count_map(const Atlas& atlas, SessionFigures& figures) {
  std::set<MapId> maps;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) { maps.insert(k.map); });
  atlas.points().for_each(
      [&](MapPointId, const MapPoint& p) { figures.observations += p.observations.size(); });
  figures.keyframes = atlas.keyframes().size();
  figures.points = atlas.points().size();
  figures.maps = maps.size();
}

/// Root mean square distance between truth and map as their keyframes align them, and of the
/// session's poses in that alignment.
void compare_with_truth(const Atlas& atlas, Truth& truth, const StampedPoses& poses,
                        const StampedPoses& true_poses, SessionFigures& figures) {
  const MapId map = largest_map(atlas);
  std::vector<Eigen::Vector3d> estimated, real;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& k) {
    if (k.map != map) return;
    estimated.push_back(k.T_world_camera.translation());
    real.push_back(truth.T_world_camera(k.frame_index).translation());
  });
  const std::optional<Alignment> alignment = align_points(estimated, real);
  const Result<AteResult> ate = absolute_trajectory_error(true_poses, poses);
  if (ate) figures.ate_m = ate->statistics_m.rmse;
  if (!alignment || !alignment->unique) return;
  figures.map_m = alignment->rmse_m;
  if (!ate) return;
  const auto off_m = [&](const IndexPair& pair) {
    return (*alignment * poses[pair.b].T_world_camera.translation() -
            true_poses[pair.a].T_world_camera.translation())
        .norm();
  };
  double sum = 0;
  for (const IndexPair& pair : ate->pairs) {
    sum += off_m(pair) * off_m(pair);
    if (off_m(pair) > kMisplaced_m) ++figures.misplaced_frames;
  }
  figures.found_m = off_m(ate->pairs.front());
  figures.place_m = std::sqrt(sum / static_cast<double>(ate->pairs.size()));
}

void count_loops(const MappingReports& reports, Truth& truth, SessionFigures& figures) {
  for (const MapperReport& report : reports.keyframes) {
    ++figures.keyframes_made;
    figures.keyframes_culled += report.keyframes_culled;
  }
  for (const LoopReport& loop : reports.loops) {
    const SE3 T_matched_current = truth.T_world_camera(loop.matched_frame).inverse() *
                                  truth.T_world_camera(loop.current_frame);
    const SE3 error = T_matched_current.inverse() * loop.T_matched_current;
    ++(loop.merged ? figures.merges : figures.loops);
    // As far off as this it would harm the map.
    if (error.translation().norm() > 0.2 || error.angle_rad() > 0.1) ++figures.false_loops;
  }
}

Result<std::optional<Atlas>> map_so_far(const fs::path& file, int number, double& load_ms) {
  if (number == 0) return std::optional<Atlas>();
  StageTimes times;
  StageTimer timer(times, "load");
  Result<Atlas> atlas = load_map(file);
  timer.stop();
  if (!atlas) return atlas.error();
  load_ms = times.back().cpu_ms;
  return std::optional<Atlas>(std::move(*atlas));
}

Result<void> play(const Simulator& simulator, int number, SlamSystem& system,
                  StampedPoses& true_poses, SessionFigures& figures,
                  const SessionProgress& progress) {
  FrameCounts counts;
  for (int i = 0; i < simulator.frame_count(); ++i) {
    interruption::throw_if_asked();
    SimulatedFrame frame = simulator.render(i);
    frame.frame.index += number * kSessionFrames;
    frame.frame.stamp.ns += number * kDay_ns;
    const Result<FrameReport> report = system.process(frame.frame, boxes_seen(frame));
    if (!report) return report.error();
    counts.add(*report, figures);
    true_poses.push_back({frame.frame.stamp, frame.T_world_camera});
    if (progress) progress(i + 1, system.atlas()->keyframes().size());
  }
  counts.close(figures);
  return system.finish();
}

}  // namespace

Result<SessionFigures> run_session(const SessionPlan& plan, int number,
                                   const SystemOptions& options, const fs::path& map_file,
                                   const SessionProgress& progress) {
  const Session session = plan(number);
  SessionFigures figures;
  figures.number = number;
  figures.light = to_string(session.world.light);
  Result<std::optional<Atlas>> map = map_so_far(map_file, number, figures.load_ms);
  if (!map) return map.error();
  const Simulator simulator(session.world, session.path);
  SlamSystem system(simulator.camera(), options, ObjectCatalogue::defaults(), nullptr,
                    std::move(*map));
  StampedPoses true_poses;
  if (auto r = play(simulator, number, system, true_poses, figures, progress); !r) {
    return r.error();
  }
  figures.memory_mb = resident_mb();
  const auto atlas = system.atlas();
  Truth truth(plan);
  count_map(*atlas, figures);
  count_loops(system.mapping_reports(), truth, figures);
  compare_with_truth(*atlas, truth, system.trajectory(), true_poses, figures);
  StageTimes times;
  StageTimer timer(times, "save");
  if (auto r = system.save_map(map_file); !r) return r.error();
  timer.stop();
  figures.save_ms = times.back().cpu_ms;
  figures.file_bytes = fs::file_size(map_file);
  return figures;
}

}  // namespace ydd
