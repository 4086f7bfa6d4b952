// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ydd/base/options.h"
#include "ydd/base/timestamp.h"
#include "ydd/geometry/se3.h"

namespace ydd {

/// When a frame is not believed; describe() has the sentences.
struct DoubtOptions {
  bool enabled = true;
  double depth_factor = 3.0;
  double depth_floor_per_m = 0.008;
  double longest_s = 5.0;
  double max_speed_m_s = 15.0;  ///< a camera that is thrown, not carried
  double max_turn_rad_s = 12.0;
  void describe(OptionTable& table);
};

/// Whether the sensor is doubted, why and since when. Doubt ends after half a second in which
/// nothing raised it, since one good frame may be chance, and is given up when it lasts too long:
/// what lasts is how this sensor is.
class Doubt {
 public:
  /// Believes all to begin with.
  explicit Doubt(const DoubtOptions& options) : longest_s_(options.longest_s) {}

  /// Something speaks against the sensor. True when nothing did before.
  bool raise(const std::string& reason, Timestamp now);
  /// A frame at `now` was believed. True when doubt is over, or there was none.
  bool settle(Timestamp now);

  bool pending() const { return since_.has_value(); }  ///< Whether the sensor is doubted now.
  /// Whether doubt should be given up at `now`: the option says after how long.
  bool lasts_too_long(Timestamp now) const;
  const std::string& reason() const { return reason_; }  ///< the newest; empty: none

 private:
  double longest_s_;
  std::string reason_;
  std::optional<Timestamp> since_;
  std::optional<Timestamp> believed_since_;
};

/// Whether a camera that is carried can have made this motion in `interval_s`.
bool is_motion_of_a_body(const SE3& motion, double interval_s, const DoubtOptions& limits);

}  // namespace ydd
