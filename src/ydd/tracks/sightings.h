// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ydd/dynamics/judge.h"
#include "ydd/geometry/camera.h"
#include "ydd/tracks/track_options.h"

namespace ydd {

/// The class of what moves and was not detected.
inline constexpr const char* kThing = "thing";

/// A person or a moving thing as one frame shows it, in the camera frame.
struct Sighting {
  std::string class_name;         ///< of the detection; kThing: nothing was detected there
  std::int64_t image_track = -1;  ///< the judge's number for the person; -1: not followed
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();  ///< its middle, metres
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();  ///< width, height as seen; depth by class
  bool cut = false;                                    ///< the picture's border cuts it
  bool moves = false;                                  ///< as judged
  bool sure = true;                                    ///< the detector is, or it is seen to move
  std::optional<float> log_odds;  ///< that it moves; none: nothing is known (variant `evidence`)
};

/// What a frame shows, for sightings. `odds` may be null.
struct SightedFrame {
  const Judgement& judgement;
  const Detections& detections;
  const DepthImage& depth_m;
  const MotionOdds* odds = nullptr;
};

/// All persons, and what else was judged to move: automatic and moved objects, and (with odds)
/// moving surfaces of nothing that was detected. Nearer objects are measured first, and their
/// readings are not those of what is behind them. What has no reading is not sighted.
std::vector<Sighting> find_sightings(const SightedFrame& frame, const Camera& camera,
                                     const ObjectCatalogue& catalogue, const SensorNoise& noise,
                                     const WorldTrackOptions& options);

}  // namespace ydd
