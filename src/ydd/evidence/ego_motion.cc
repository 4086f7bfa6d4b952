// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/ego_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace ydd {
namespace {

constexpr double kPixelSigma_px = 1.0;  // of a corner on level 0
constexpr double kLevelStep = 1.2;
constexpr int kAlikeBits = 10;  // candidates that look alike
constexpr double kNearest_m = 0.05;
constexpr std::size_t kLeastPairs = 3;   // of a piece with a say
constexpr double kFloor_px = 0.6;        // what many features of a piece cannot average out, ...
constexpr double kFloor_m = 0.004;       // ... at 1 m, growing with the square of the depth
constexpr double kMissed = 0.001;        // of the times
constexpr int kDrawn = 4;                // pieces that propose a motion together
constexpr int kLeastCells = 4;           // of a piece whose depth has a say
constexpr double kDepthFloor_m = 0.002;  // what many readings cannot average out, ...
constexpr double kDepthFloor_per_m = 0.0007;  // ... growing with the square of the depth
constexpr double kMedianFactor = 1.57;        // variance of a median, by that of a mean

double level_scale(int octave) { return std::pow(kLevelStep, octave); }

Eigen::Vector3d point_of(const Features& features, int i, const Camera& camera) {
  const auto k = static_cast<std::size_t>(i);
  return camera.unproject(features.undistorted_px[k].cast<double>(), features.depth_m[k]);
}

/// Of the candidates that look most alike the one nearest to the expected place; -1: none.
int choose(const Descriptor& wanted, const Features& now, std::span<const int> candidates,
           const Eigen::Vector2f& expected_px, int most_bits, std::vector<int>& bits) {
  bits.clear();
  int least = most_bits + 1;
  for (const int c : candidates) {
    bits.push_back(hamming_distance(wanted, now.descriptors[static_cast<std::size_t>(c)]));
    least = std::min(least, bits.back());
  }
  if (least > most_bits) return -1;
  int best = -1;
  float nearest_px2 = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (bits[k] > std::min(least + kAlikeBits, most_bits)) continue;
    const auto candidate = static_cast<std::size_t>(candidates[k]);
    const float px2 = (now.undistorted_px[candidate] - expected_px).squaredNorm();
    if (px2 >= nearest_px2) continue;
    nearest_px2 = px2;
    best = candidates[k];
  }
  return best;
}

/// What a camera that is carried may change of its motion from one frame to the next.
double likelihood_of_step(const SE3& T_now_then, const SE3& expected) {
  constexpr double kStep_m = 0.006, kTurn_rad = 0.007, kSay = 0.1;
  const SE3 off = T_now_then * expected.inverse();
  const double t = off.translation().norm() / kStep_m, r = off.angle_rad() / kTurn_rad;
  return 1 - kSay + kSay / (1 + 0.5 * (t * t + r * r));
}

/// How many draws find, nearly always, a motion that this share of the weight agrees with (Fischler
/// and Bolles, "Random sample consensus", 1981).
int enough_draws(double share) {
  const double all_agree = std::pow(std::clamp(share, 0.01, 0.99), kDrawn);
  return static_cast<int>(std::ceil(std::log(kMissed) / std::log(1 - all_agree)));
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<FeaturePair> pair_features(const Features& then, const Features& now,
                                       const KeypointGrid& grid_now, const SE3& T_now_then,
                                       const Camera& camera, const EvidenceOptions& options) {
  std::vector<int> owner(now.size(), -1);
  std::vector<float> owner_px2(now.size(), 0);
  std::vector<int> candidates, bits;
  candidates.reserve(now.size());
  bits.reserve(now.size());
  for (std::size_t i = 0; i < then.size(); ++i) {
    if (!then.has_depth(i)) continue;
    const Eigen::Vector3d p = T_now_then * point_of(then, static_cast<int>(i), camera);
    if (p.z() <= kNearest_m) continue;
    const Eigen::Vector2f px = camera.project(p).cast<float>();
    const int octave = then.keypoints[i].octave;
    grid_now.query(px.x(), px.y(), static_cast<float>(options.search_px), octave - 1, octave + 1,
                   candidates);
    const int k = choose(then.descriptors[i], now, candidates, px, options.descriptor_bits, bits);
    if (k < 0) continue;
    const auto found = static_cast<std::size_t>(k);
    const float px2 = (now.undistorted_px[found] - px).squaredNorm();
    if (owner[found] >= 0 && owner_px2[found] <= px2) continue;
    owner[found] = static_cast<int>(i);
    owner_px2[found] = px2;
  }
  std::vector<FeaturePair> pairs;
  pairs.reserve(std::min(then.size(), now.size()));
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (owner[i] >= 0) pairs.push_back({owner[i], static_cast<int>(i)});
  }
  return pairs;
}

PairedPieces::PairedPieces(const Features& then, const Features& now,
                           std::span<const FeaturePair> pairs, std::span<const int> piece_of,
                           const Camera& camera, const EvidenceOptions& options)
    : camera_(camera), options_(options) {
  std::vector<std::size_t> order;
  order.reserve(pairs.size());
  groups_.reserve(pairs.size());
  pairs_.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (piece_of[i] >= 0) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return piece_of[a] < piece_of[b]; });
  for (const std::size_t i : order) {
    if (groups_.empty() || groups_.back().piece != piece_of[i]) {
      groups_.push_back({piece_of[i], pairs_.size(), 0});
    }
    ++groups_.back().count;
    const auto t = static_cast<std::size_t>(pairs[i].then);
    const auto k = static_cast<std::size_t>(pairs[i].now);
    Pair pair;
    pair.p_then = point_of(then, pairs[i].then, camera);
    pair.p_now = point_of(now, pairs[i].now, camera);
    pair.px_now = now.undistorted_px[k].cast<double>();
    pair.right_px = now.right_px[k];
    pair.sigma_px = kPixelSigma_px * level_scale(now.keypoints[k].octave);
    const double s0_m = options.noise.sigma_m(then.depth_m[t]);
    const double s1_m = options.noise.sigma_m(now.depth_m[k]);
    pair.variance_m2 = s0_m * s0_m + s1_m * s1_m;
    pairs_.push_back(pair);
  }
  std::erase_if(groups_, [](const Group& g) { return g.count < kLeastPairs; });
  for (std::vector<double>* residuals : {&scratch_.du_px, &scratch_.dv_px, &scratch_.dz_m}) {
    residuals->reserve(pairs_.size());
  }
  scratch_.observations.reserve(pairs_.size());
  scratch_.groups.reserve(groups_.size());
}

double PairedPieces::chi2_of(const Group& group, const SE3& T_now_then) const {
  Scratch& off = scratch_;
  for (std::vector<double>* residuals : {&off.du_px, &off.dv_px, &off.dz_m}) residuals->clear();
  double precision = 0, variance_m2 = 0, z_m = 0;
  for (std::size_t i = group.first; i < group.first + group.count; ++i) {
    const Pair& pair = pairs_[i];
    const Eigen::Vector3d p = T_now_then * pair.p_then;
    if (p.z() <= kNearest_m) continue;
    const Eigen::Vector2d px = camera_.project(p);
    off.du_px.push_back(pair.px_now.x() - px.x());
    off.dv_px.push_back(pair.px_now.y() - px.y());
    precision += 1.0 / (pair.sigma_px * pair.sigma_px);
    z_m = p.z();
    if (pair.p_now.z() <= 0) continue;
    off.dz_m.push_back(pair.p_now.z() - p.z());
    variance_m2 += pair.variance_m2;
  }
  if (off.du_px.size() < kLeastPairs) return std::numeric_limits<double>::infinity();
  const double variance_px2 = kMedianFactor / precision + kFloor_px * kFloor_px;
  const double u_px = median_of(off.du_px), v_px = median_of(off.dv_px);
  double chi2 = (u_px * u_px + v_px * v_px) / variance_px2;
  if (off.dz_m.size() >= kLeastPairs) {
    const auto n = static_cast<double>(off.dz_m.size());
    const double floor_m = kFloor_m * z_m * z_m;
    const double dz_m = median_of(off.dz_m);
    chi2 += dz_m * dz_m / (kMedianFactor * variance_m2 / (n * n) + floor_m * floor_m);
  }
  return chi2 / excess_;
}

void PairedPieces::add_depth(const CoarseDepth& now, const Surfaces& surfaces,
                             std::span<const Eigen::Vector2f> rays, const CoarseDepth& then) {
  then_depth_ = &then;
  piece_count_ = surfaces.count;
  cell_points_.reserve(now.z_m.size() / 4 + 1);
  cell_piece_.reserve(now.z_m.size() / 4 + 1);
  for (int row = 0; row < now.grid.rows; row += 2) {
    for (int column = (row / 2) % 2; column < now.grid.columns; column += 2) {
      const auto i = static_cast<std::size_t>(now.grid.index(column, row));
      if (surfaces.piece[i] < 0) continue;
      cell_points_.push_back(point_on(rays[i], now.z_m[i]));
      cell_piece_.push_back(surfaces.piece[i]);
    }
  }
}

void PairedPieces::sum_depth(const SE3& T_now_then) const {
  std::vector<DepthSum>& sums = scratch_.depth;
  sums.assign(static_cast<std::size_t>(piece_count_), {});
  if (!then_depth_) return;
  const SeenFrom::Places& places = scratch_.places;
  SeenFrom(T_now_then.inverse(), camera_).see_all(cell_points_, scratch_.places);
  const auto step_share = static_cast<float>(options_.step_share);
  for (std::size_t i = 0; i < cell_points_.size(); ++i) {
    if (places.z_m[i] <= 0) continue;
    const float z_m = surface_depth(*then_depth_, places.x_px[i], places.y_px[i], step_share);
    if (z_m <= 0) continue;
    const float sigma_m = options_.noise.sigma_m(places.z_m[i]);
    DepthSum& sum = sums[static_cast<std::size_t>(cell_piece_[i])];
    // Behind something, or before it: clipped, so that a few do not decide.
    const float most_m = 0.05F + 3 * sigma_m;
    sum.off_m += std::clamp(places.z_m[i] - z_m, -most_m, most_m);
    sum.variance_m2 += 2 * sigma_m * sigma_m;
    sum.z_m += z_m;
    ++sum.count;
  }
}

double PairedPieces::depth_chi2(const DepthSum& sum) const {
  if (sum.count < kLeastCells) return -1;
  const auto n = static_cast<double>(sum.count);
  const double z_m = sum.z_m / n, off_m = sum.off_m / n;
  const double floor_m = kDepthFloor_m + kDepthFloor_per_m * z_m * z_m;
  return off_m * off_m / (sum.variance_m2 / (n * n) + floor_m * floor_m) / excess_;
}

std::vector<PieceMotion> PairedPieces::motions(const SE3& T_now_then) const {
  std::vector<PieceMotion> out;
  out.reserve(groups_.size());
  for (const Group& g : groups_) {
    out.push_back({g.piece, static_cast<int>(g.count), chi2_of(g, T_now_then)});
  }
  return out;
}

SE3 PairedPieces::fitted(const SE3& start, std::span<const int> groups,
                         std::span<const float> weight) const {
  const auto weight_of_pair = [&](const Group& group) {
    return weight[static_cast<std::size_t>(group.piece)] / static_cast<double>(group.count);
  };
  double mean = 0;
  for (const int g : groups) {
    mean +=
        weight_of_pair(groups_[static_cast<std::size_t>(g)]) / static_cast<double>(groups.size());
  }
  std::vector<PoseObservation>& observations = scratch_.observations;
  observations.clear();
  for (const int g : groups) {
    const Group& group = groups_[static_cast<std::size_t>(g)];
    const double say = std::clamp(weight_of_pair(group) / mean, 0.05, 1.0);
    for (std::size_t i = group.first; i < group.first + group.count; ++i) {
      const Pair& pair = pairs_[i];
      observations.push_back({pair.p_then,
                              {pair.px_now.x(), pair.px_now.y(), pair.right_px},
                              say / (pair.sigma_px * pair.sigma_px)});
    }
  }
  PoseOnlyOptions options;
  options.rounds = 2;
  options.iterations_per_round = 4;
  const PoseOnlyResult solved = optimize_pose(camera_, start, observations, options);
  return solved.inliers >= 6 ? solved.T_camera_world : start;
}

PairedPieces::Support PairedPieces::support(const SE3& T_now_then, std::span<const float> weight,
                                            double at_least) const {
  std::vector<double>& chi2 = scratch_.chi2;
  chi2.assign(weight.size(), -1.0);
  const auto say = [&](std::size_t p, double c) {
    return weight[p] * std::max(0.0, 1.0 - c / options_.still_chi2);
  };
  double most = std::accumulate(weight.begin(), weight.end(), 0.0);  // if depth has no objection
  for (const Group& g : groups_) {
    const auto p = static_cast<std::size_t>(g.piece);
    chi2[p] = chi2_of(g, T_now_then);
    most -= weight[p] - say(p, chi2[p]);
  }
  Support out;
  if (most < at_least) return out;
  sum_depth(T_now_then);
  for (std::size_t p = 0; p < chi2.size(); ++p) {
    const double by_depth = p < scratch_.depth.size() ? depth_chi2(scratch_.depth[p]) : -1;
    if (chi2[p] < 0 && by_depth < 0) continue;
    const double agreeing = say(p, std::max(0.0, chi2[p]) + std::max(0.0, by_depth));
    out.total += weight[p];
    out.agreeing += agreeing;
    if (agreeing > 0) out.standing += weight[p];
  }
  return out;
}

std::span<const int> PairedPieces::agreeing(const SE3& T_now_then, std::span<const float> weight,
                                            double chi2_limit) const {
  std::vector<int>& groups = scratch_.groups;
  groups.clear();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (weight[static_cast<std::size_t>(groups_[g].piece)] <= 0) continue;
    if (chi2_of(groups_[g], T_now_then) < chi2_limit) groups.push_back(static_cast<int>(g));
  }
  return groups;
}

SE3 PairedPieces::polished(SE3 T_now_then, std::span<const float> weight) const {
  constexpr double kNoWorse = 0.95;
  double agreed = support(T_now_then, weight).agreeing;
  for (const double limit : {options_.moved_chi2, options_.still_chi2, options_.still_chi2}) {
    const SE3 fit = fitted(T_now_then, agreeing(T_now_then, weight, limit), weight);
    const double agreeing = support(fit, weight).agreeing;
    if (agreeing < kNoWorse * agreed) break;
    agreed = agreeing;
    T_now_then = fit;
  }
  return T_now_then;
}

std::optional<SE3> PairedPieces::proposal(const SE3& expected, std::span<const float> weight,
                                          std::span<const double> reach,
                                          std::mt19937& random) const {
  std::array<int, kDrawn> drawn{};
  for (int& g : drawn) {
    const double at = std::generate_canonical<double, 32>(random) * reach.back();
    g = static_cast<int>(std::upper_bound(reach.begin(), reach.end() - 1, at) - reach.begin());
  }
  std::sort(drawn.begin(), drawn.end());
  if (std::adjacent_find(drawn.begin(), drawn.end()) != drawn.end()) return {};
  return fitted(expected, drawn, weight);
}

SE3 PairedPieces::consensus(const SE3& expected, std::span<const float> weight, int proposals,
                            unsigned seed) const {
  std::vector<double> reach;
  reach.reserve(groups_.size());
  for (const Group& g : groups_) {
    const double w = weight[static_cast<std::size_t>(g.piece)];
    reach.push_back((reach.empty() ? 0.0 : reach.back()) + w);
  }
  if (groups_.size() < 3 || reach.back() <= 0) return expected;
  SE3 best = polished(expected, weight);
  const Support at_once = support(best, weight);
  double most = at_once.agreeing * likelihood_of_step(best, expected);
  double share = at_once.share();
  std::mt19937 random(seed);
  bool found = false;
  for (int k = 0; k < std::min(proposals, enough_draws(share)); ++k) {
    const std::optional<SE3> next = proposal(expected, weight, reach, random);
    if (!next) continue;
    const double likelihood = likelihood_of_step(*next, expected);
    const Support said = support(*next, weight, most / likelihood);
    if (said.agreeing * likelihood <= most) continue;
    most = said.agreeing * likelihood;
    share = said.share();
    best = *next;
    found = true;
  }
  return found ? polished(best, weight) : best;
}

}  // namespace ydd
