// SPDX-License-Identifier: Apache-2.0
#include "ydd/tracking/arrival.h"

namespace ydd {

void ArrivalOptions::describe(OptionTable& t) {
  t.add("duration_s", duration_s, {0.0, 60.0}, "s",
        "nothing enters the map where a place was recognised until its points have been followed "
        "for so long, ...");
  t.add("min_agreement", min_agreement, {0.0, 1.0}, "",
        "... and in the mean so large a share of those found agree; else it is another place");
}

void Arrival::begin(Timestamp now) {
  settled_ = false;
  since_ = now;
  sum_ = 0.0;
  looks_ = 0;
}

bool Arrival::look(Timestamp now, double agreement, const ArrivalOptions& options) {
  if (settled_) return true;
  if (!since_) begin(now);
  sum_ += agreement;
  ++looks_;
  if (sum_ < options.min_agreement * looks_) {
    since_.reset();
    return false;
  }
  settled_ = seconds_between(*since_, now) >= options.duration_s;
  return true;
}

}  // namespace ydd
