// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/evidence_options.h"

#include <algorithm>
#include <cmath>

namespace ydd {

void SensorNoise::describe(OptionTable& t) {
  t.add("floor_m", floor_m, {0.0, 1.0}, "m", "standard deviation of near depth readings");
  t.add("growth_per_m", growth_per_m, {0.0, 1.0}, "1/m",
        "what the deviation grows by with (depth - 0.4 m)^2");
}

void EvidenceOptions::describe(OptionTable& t) {
  t.add("cell_px", cell_px, {4, 32}, "px",
        "side of the cells that odds are kept for, at 640 px width");
  t.add("slack_m", slack_m, {0.0, 1.0}, "m", "depth difference that is no evidence");
  t.add("sigmas", sigmas, {0.0, 10.0}, "", "standard deviations of depth that are noise");
  t.add("patch_radius_m", patch_radius_m, {0.01, 10.0}, "m", "reach of a surface judged as one");
  t.add("step_share", step_share, {0.001, 1.0}, "", "of the depth: largest step within a surface");
  t.add("features_of_place", features_of_place, {1, 1000}, "",
        "of each 4 x 4 cells, that later frames look for");
  t.add("search_px", search_px, {1.0, 200.0}, "px",
        "how far from its place a feature is looked for, at 640 px width");
  t.add("descriptor_bits", descriptor_bits, {0, 256}, "bit", "largest distance to its match");
  t.add("moved_chi2", moved_chi2, {0.0, 1e6}, "", "squared residual above which a feature moved");
  t.add("still_chi2", still_chi2, {0.0, 1e6}, "", "squared residual below which it did not");
  t.add("intrusion_gain", intrusion_gain, {0.0, 100.0}, "", "log-odds of being where nothing was");
  t.add("presence_gain", presence_gain, {0.0, 100.0}, "", "log-odds of having been there long");
  t.add("feature_gain", feature_gain, {0.0, 100.0}, "", "log-odds of one feature");
  t.add("decay", decay, {0.0, 1.0}, "", "of the log-odds from frame to frame");
  t.add("most_log_odds", most_log_odds, {0.1, 100.0}, "", "bound of the log-odds");
  t.add("moves_above", moves_above, {-100.0, 100.0}, "", "log-odds that begin the verdict");
  t.add("still_below", still_below, {-100.0, 100.0}, "", "log-odds that end it");
  t.add("trust", trust, {0.0, 1.0}, "",
        "support of the tracked motion by the room, of that of the best one, that it needs");
  t.add("trust_grown", trust_grown, {0.0, 1.0}, "", "the same once a map of the room has grown");
  t.group("noise", noise);
}

EvidenceOptions EvidenceOptions::at_width(int width_px) const {
  constexpr double kWidth_px = 640.0;
  constexpr int kLeastCell_px = 4;
  const double scale = width_px / kWidth_px;
  EvidenceOptions out = *this;
  out.cell_px = std::max(kLeastCell_px, static_cast<int>(std::lround(scale * cell_px)));
  out.search_px = scale * search_px;
  return out;
}

}  // namespace ydd
