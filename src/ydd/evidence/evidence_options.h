// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ydd/base/options.h"

namespace ydd {

/// What is believed of a depth reading.
struct SensorNoise {
  double floor_m = 0.0012;       ///< standard deviation of near readings
  double growth_per_m = 0.0019;  ///< and what it grows by with (z - 0.4 m)^2
  void describe(OptionTable& table);
  /// Standard deviation of a reading (Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise",
  /// 3DIMPVT 2012, equation 3).
  float sigma_m(float z_m) const {
    const float beyond_m = z_m - 0.4F;
    return static_cast<float>(floor_m) + static_cast<float>(growth_per_m) * beyond_m * beyond_m;
  }
};

/// How the odds that something moves follow from what the last frames show. Pixels are those of a
/// picture of 640 px width.
struct EvidenceOptions {
  int cell_px = 8;               ///< side of the square cells that odds are kept for
  double slack_m = 0.02;         ///< of depth, besides the sensor's noise
  double sigmas = 3.0;           ///< standard deviations that are noise
  double patch_radius_m = 0.25;  ///< of a surface that is judged as one
  double step_share = 0.04;      ///< of the depth: largest step between cells of one surface
  int features_of_place = 6;     ///< that later frames look for, of each 4 x 4 cells
  double search_px = 24.0;       ///< how far from its expected place a feature is looked for
  int descriptor_bits = 60;      ///< largest distance of a feature to its match
  double moved_chi2 = 25.0;      ///< of a feature's 3-D residual: it has moved
  double still_chi2 = 9.0;       ///< it has not
  double intrusion_gain = 4.0;   ///< log-odds a frame of a surface that is where there was nothing
  double presence_gain = 1.0;    ///< the same of one that was there long ago
  double feature_gain = 0.4;     ///< log-odds of one feature
  double decay = 0.9;            ///< of the log-odds from frame to frame
  double most_log_odds = 6.0;
  double moves_above = 1.0;   ///< log-odds that begin a verdict "moves", ...
  double still_below = -1.0;  ///< ... and that end it
  double trust = 0.7;         ///< tracking is believed if the room says so much for its motion ...
                              ///< of what it says for the best one
  double trust_grown = 0.5;   ///< the same once a map of the room has grown: the older map wins
  SensorNoise noise;
  void describe(OptionTable& table);
  /// The same for pictures of another width than 640 px: what is in pixels is scaled with it.
  EvidenceOptions at_width(int width_px) const;
};

}  // namespace ydd
