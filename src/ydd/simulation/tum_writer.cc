// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/tum_writer.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "ydd/base/files.h"
#include "ydd/base/fresh_folder.h"
#include "ydd/base/interruption.h"
#include "ydd/dataset/motion_files.h"
#include "ydd/dataset/trajectory.h"
#include "ydd/image/decode.h"
#include "ydd/image/encode.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kUsPerS = 1'000'000;

/// Seconds with six decimals, as in the benchmark; simulated stamps are whole microseconds.
std::string short_stamp(Timestamp stamp) {
  const std::int64_t us = stamp.ns / kNsPerUs;
  return fmt::format("{}.{:06}", us / kUsPerS, us % kUsPerS);
}

Result<void> make_folders(const fs::path& folder) {
  for (const char* part : {"rgb", "depth", "mask"}) {
    std::error_code failure;
    fs::create_directories(folder / part, failure);
    if (failure) {
      return Error{
          fmt::format("{}: cannot be created: {}", (folder / part).string(), failure.message())};
    }
  }
  return {};
}

std::string colour_name(Timestamp stamp, const TumWriterOptions& options) {
  return fmt::format("rgb/{}.{}", short_stamp(stamp),
                     options.colour_format == ColourFormat::jpeg ? "jpg" : "png");
}

Result<void> write_images(const SimulatedFrame& frame, const Camera& camera, const fs::path& folder,
                          const TumWriterOptions& options) {
  const std::string name = short_stamp(frame.frame.stamp) + ".png";
  const fs::path colour = folder / colour_name(frame.frame.stamp, options);
  Result<void> written = options.colour_format == ColourFormat::jpeg
                             ? write_jpeg(colour, frame.frame.colour, options.jpeg_quality)
                             : write_png(colour, frame.frame.colour);
  if (!written) return written;
  const RawDepthImage depth = to_raw_depth(frame.frame.depth_m, camera.depth_scale);
  if (auto r = write_png(folder / "depth" / name, depth); !r) return r;
  return write_png(folder / "mask" / name, frame.mask);
}

std::string lists_header(const char* what) {
  return fmt::format("# {} of a simulated sequence\n# timestamp filename\n", what);
}

/// For `--config`: where the sensors of motion are.
std::string mounting_yaml() {
  const ReckoningOptions mounting = simulated_mounting();
  return fmt::format(
      "# for ydd-slam run --config\nreckoning:\n  T_camera_imu: \"{}\"\n"
      "  T_camera_base: \"{}\"\n",
      mounting.T_camera_imu, mounting.T_camera_base);
}

Result<void> write_lists(const Simulator& simulator, const fs::path& folder,
                         const TumWriterOptions& options) {
  std::string rgb = lists_header("colour images");
  std::string depth = lists_header("depth images");
  std::string pairs;
  StampedPoses truth;
  for (int i = 0; i < simulator.frame_count(); ++i) {
    const Timestamp stamp = simulator.stamp(i);
    const std::string time = short_stamp(stamp);
    const std::string colour_line = time + " " + colour_name(stamp, options);
    const std::string depth_line = fmt::format("{0} depth/{0}.png", time);
    rgb += fmt::format("{}\n", colour_line);
    depth += fmt::format("{}\n", depth_line);
    pairs += fmt::format("{} {}\n", colour_line, depth_line);
    truth.push_back({stamp, simulator.pose(i)});
  }
  const MotionSamples motion = simulator.motion_samples();
  Camera camera = simulator.camera();
  OptionTable table;
  camera.describe(table);
  const std::pair<const char*, std::string> files[] = {
      {"rgb.txt", rgb},
      {"depth.txt", depth},
      {"associations.txt", pairs},
      {"groundtruth.txt",
       "# timestamp tx ty tz qx qy qz qw\n" + format_trajectory(truth, TrajectoryFormat::tum)},
      {"camera.yaml", table.to_yaml()},
      {"imu.csv", motion.imu.empty() ? "" : format_imu(motion.imu)},
      {"odometry.txt", motion.odometry.empty() ? "" : format_odometry(motion.odometry)},
      {"sensors.yaml", motion.empty() ? "" : mounting_yaml()},
      {"simulation.yaml", options.about}};
  for (const auto& [name, text] : files) {
    if (text.empty()) continue;
    if (auto r = write_file_atomically(folder / name, text); !r) return r;
  }
  return {};
}

/// Frames [first, last) at the same time, each by one worker; the first failure counts.
Result<void> write_batch(const Simulator& simulator, const fs::path& folder,
                         const TumWriterOptions& options, int first,
                         std::vector<RecordedFrame>& batch) {
  std::vector<std::optional<Error>> failures(batch.size());
  const auto job = [&](std::size_t k) {
    interruption::throw_if_asked();
    const SimulatedFrame frame = simulator.render(first + static_cast<int>(k));
    batch[k] = to_recorded_frame(frame, colour_name(frame.frame.stamp, options));
    if (auto r = write_images(frame, simulator.camera(), folder, options); !r) {
      failures[k] = r.error();
    }
  };
  tbb::task_arena arena(options.jobs == 0 ? tbb::task_arena::automatic : options.jobs);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, batch.size(), job); });
  for (const auto& failure : failures) {
    if (failure) return *failure;
  }
  return {};
}

Result<void> write_all(const Simulator& simulator, const fs::path& folder,
                       const TumWriterOptions& options) {
  constexpr int kBatch = 16;
  if (auto r = make_folders(folder); !r) return r;
  std::vector<RecordedFrame> detections;
  for (int first = 0; first < simulator.frame_count(); first += kBatch) {
    const int count = std::min(kBatch, simulator.frame_count() - first);
    std::vector<RecordedFrame> batch(static_cast<std::size_t>(count));
    if (auto r = write_batch(simulator, folder, options, first, batch); !r) return r;
    std::move(batch.begin(), batch.end(), std::back_inserter(detections));
    if (options.progress) options.progress(first + count);
  }
  if (auto r = write_recorded_detections(folder / "detections.jsonl", detections); !r) return r;
  return write_lists(simulator, folder, options);
}

}  // namespace

RecordedFrame to_recorded_frame(const SimulatedFrame& frame, const std::string& colour_file) {
  RecordedFrame recorded;
  recorded.stamp = frame.frame.stamp;
  recorded.index = frame.frame.index;
  recorded.file = colour_file;
  for (const SimulatedObject& object : frame.objects) {
    RecordedDetection d;
    d.detection = {object.class_name, 1.0F, object.box};
    d.name = object.name;
    d.id = object.id;
    d.dynamic = object.dynamic;
    d.moved_in_sequence = object.moved_in_sequence;
    d.pixels = object.pixels;
    recorded.detections.push_back(std::move(d));
  }
  return recorded;
}

Result<void> write_tum_sequence(const Simulator& simulator, const fs::path& folder,
                                const TumWriterOptions& options) {
  if (fs::exists(folder)) {
    return Error{
        fmt::format("{}: exists already; remove it or name another folder", folder.string())};
  }
  const FreshFolder fresh(folder);
  if (auto r = write_all(simulator, fresh.path(), options); !r) return r;
  return fresh.place();
}

}  // namespace ydd
