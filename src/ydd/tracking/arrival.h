// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ydd/base/options.h"
#include "ydd/base/timestamp.h"

namespace ydd {

/// When a place that was recognised is believed; describe() has the sentences.
struct ArrivalOptions {
  double duration_s = 1.0;
  double min_agreement = 0.3;
  void describe(OptionTable& table);
};

/// A camera that was found by the look of a place may be in another one that looks alike: the same
/// shelves on the same floor, five doors farther. Keyframes of its own would bear the wrong place
/// out, so none are made until old points alone have done so for a while; and what looks alike is
/// found where it should be far less often than what is the same.
class Arrival {
 public:
  /// `settled`: nothing is to be borne out.
  explicit Arrival(bool settled) : settled_(settled) {}

  /// Whether the place is believed.
  bool settled() const { return settled_; }
  /// It is: a new map, or other senses know.
  void settle() { settled_ = true; }
  /// The camera was found in a place that it was not in before.
  void begin(Timestamp now);
  /// It was looked at there once more. `agreement`: of the map's points that seem to be seen, the
  /// share that agrees with the pose, 0 to 1. False: it is another place.
  bool look(Timestamp now, double agreement, const ArrivalOptions& options);

 private:
  bool settled_;
  std::optional<Timestamp> since_;
  double sum_ = 0.0;  ///< of the agreements since then
  int looks_ = 0;
};

}  // namespace ydd
