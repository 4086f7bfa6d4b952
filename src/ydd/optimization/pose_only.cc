// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/pose_only.h"

#include <array>
#include <cmath>
#include <experimental/simd>
#include <limits>

#include <Eigen/Cholesky>

#include "ydd/optimization/reprojection.h"

namespace ydd {
namespace {

namespace stdx = std::experimental;

/// Four points at a time: this runs several times a frame, and one pass over 300 points must cost
/// microseconds.
constexpr std::size_t kLanes = 4;
using Lanes = stdx::simd<double, stdx::simd_abi::deduce_t<double, kLanes>>;
using LaneArray = std::array<double, kLanes>;

Lanes load(const LaneArray& a) { return {a.data(), stdx::element_aligned}; }

/// Four observations, field by field. Padding and unusable ones have no information.
struct alignas(32) Block {
  LaneArray x, y, z;     ///< world, metres
  LaneArray u, v, r;     ///< observed, px
  LaneArray inv_sigma2;  ///< 0: can never be an inlier
  LaneArray stereo;      ///< 1 with a depth reading, else 0
  LaneArray active;      ///< 1: takes part in this round
};

bool is_usable(const PoseObservation& o) {
  return o.p_world.allFinite() && o.uvr_px.allFinite() && std::isfinite(o.inv_sigma2) &&
         o.inv_sigma2 > 0.0;
}

std::vector<Block> pack(std::span<const PoseObservation> observations) {
  std::vector<Block> blocks((observations.size() + kLanes - 1) / kLanes, Block{});
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const PoseObservation& o = observations[i];
    if (!is_usable(o)) continue;
    Block& b = blocks[i / kLanes];
    const std::size_t lane = i % kLanes;
    b.x[lane] = o.p_world.x();
    b.y[lane] = o.p_world.y();
    b.z[lane] = o.p_world.z();
    b.u[lane] = o.uvr_px.x();
    b.v[lane] = o.uvr_px.y();
    b.r[lane] = o.uvr_px.z();
    b.inv_sigma2[lane] = o.inv_sigma2;
    b.stereo[lane] = o.uvr_px.z() >= 0.0 ? 1.0 : 0.0;
    b.active[lane] = 1.0;
  }
  return blocks;
}

struct LanePoint {
  Lanes x, y, z;  ///< camera frame, metres
};

/// A pose as the rows of its 3x4 matrix.
struct PoseRows {
  std::array<double, 12> m;
  explicit PoseRows(const SE3& T) : m() {
    const Eigen::Matrix3d r = T.rotation_matrix();
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) m[4 * row + col] = r(row, col);
      m[4 * row + 3] = T.translation()[row];
    }
  }
  LanePoint operator*(const Block& b) const {
    const Lanes x = load(b.x);
    const Lanes y = load(b.y);
    const Lanes z = load(b.z);
    return {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
            m[8] * x + m[9] * y + m[10] * z + m[11]};
  }
};

/// Normal equations of one pose: cost = 0.5 sum rho, gradient, upper triangle of the Hessian.
struct NormalEquations {
  double cost = 0.0;
  Vector6d gradient;
  Matrix6d hessian;
};

/// Sums over lanes; kept apart from the final matrices so that the loop stays in registers and L1.
struct Sums {
  std::array<Lanes, 21> h{};  ///< upper triangle, row by row
  std::array<Lanes, 6> g{};
  Lanes cost = 0.0;

  /// Adds a u or r row (nothing in column 1) of residual `e` and weight `w`.
  void add_row_without_1(const Lanes& w, const Lanes& e, const Lanes& a0, const Lanes& a2,
                         const Lanes& a3, const Lanes& a4, const Lanes& a5) {
    const Lanes w0 = w * a0;
    h[0] += w0 * a0;
    h[2] += w0 * a2;
    h[3] += w0 * a3;
    h[4] += w0 * a4;
    h[5] += w0 * a5;
    g[0] += w0 * e;
    add_tail(w, e, a2, a3, a4, a5);
  }
  /// Adds a v row (nothing in column 0).
  void add_row_without_0(const Lanes& w, const Lanes& e, const Lanes& a1, const Lanes& a2,
                         const Lanes& a3, const Lanes& a4, const Lanes& a5) {
    const Lanes w1 = w * a1;
    h[6] += w1 * a1;
    h[7] += w1 * a2;
    h[8] += w1 * a3;
    h[9] += w1 * a4;
    h[10] += w1 * a5;
    g[1] += w1 * e;
    add_tail(w, e, a2, a3, a4, a5);
  }
  void add_tail(const Lanes& w, const Lanes& e, const Lanes& a2, const Lanes& a3, const Lanes& a4,
                const Lanes& a5) {
    const Lanes w2 = w * a2;
    const Lanes w3 = w * a3;
    const Lanes w4 = w * a4;
    const Lanes w5 = w * a5;
    h[11] += w2 * a2;
    h[12] += w2 * a3;
    h[13] += w2 * a4;
    h[14] += w2 * a5;
    h[15] += w3 * a3;
    h[16] += w3 * a4;
    h[17] += w3 * a5;
    h[18] += w4 * a4;
    h[19] += w4 * a5;
    h[20] += w5 * a5;
    g[2] += w2 * e;
    g[3] += w3 * e;
    g[4] += w4 * e;
    g[5] += w5 * e;
  }

  NormalEquations total() const {
    NormalEquations n;
    n.cost = 0.5 * stdx::reduce(cost);
    std::size_t k = 0;
    for (int row = 0; row < 6; ++row) {
      n.gradient[row] = stdx::reduce(g[row]);
      for (int col = row; col < 6; ++col) {
        n.hessian(row, col) = stdx::reduce(h[k++]);
        n.hessian(col, row) = n.hessian(row, col);
      }
    }
    return n;
  }
};

struct Verdict {
  int inliers = 0;
  bool changed = false;  ///< any observation joined or left
};

/// One evaluation of all blocks at a pose.
class Evaluator {
 public:
  Evaluator(const Camera& camera, const PoseOnlyOptions& options)
      : k_(camera), chi2_mono_(options.chi2_mono), chi2_stereo_(options.chi2_stereo) {}

  /// Over active observations, with Huber's kernel (width: square root of the gate) or without.
  template <bool kHuber>
  NormalEquations linearise(const std::vector<Block>& blocks, const SE3& T_camera_world) const {
    const PoseRows pose(T_camera_world);
    Sums sums;
    for (const Block& b : blocks) accumulate<kHuber>(b, pose * b, sums);
    return sums.total();
  }

  /// Sets `active` to whether the point is in front and chi-square passes `gates` times the gate.
  Verdict judge(std::vector<Block>& blocks, const SE3& T_camera_world, double gates = 1.0) const {
    const PoseRows pose(T_camera_world);
    Lanes count = 0.0;
    Lanes changes = 0.0;
    for (Block& b : blocks) {
      const LanePoint p = pose * b;
      const Reprojection<Lanes> seen(k_, p.x, p.y, stdx::max(p.z, Lanes(kNearestDepthM)));
      const Lanes inv_sigma2 = load(b.inv_sigma2);
      const Lanes chi2 = chi2_of(b, seen, inv_sigma2);
      Lanes active = 0.0;
      where(chi2 <= gates * gate(b) && p.z > kNearestDepthM && inv_sigma2 > 0.0, active) = 1.0;
      changes += stdx::abs(active - load(b.active));
      active.copy_to(b.active.data(), stdx::element_aligned);
      count += active;
    }
    return {static_cast<int>(stdx::reduce(count)), stdx::reduce(changes) > 0.0};
  }

 private:
  Lanes gate(const Block& b) const {
    return chi2_mono_ + load(b.stereo) * (chi2_stereo_ - chi2_mono_);
  }

  Lanes chi2_of(const Block& b, const Reprojection<Lanes>& seen, const Lanes& inv_sigma2) const {
    const Lanes eu = seen.u - load(b.u);
    const Lanes ev = seen.v - load(b.v);
    const Lanes er = (seen.r - load(b.r)) * load(b.stereo);
    return inv_sigma2 * (eu * eu + ev * ev + er * er);
  }

  template <bool kHuber>
  void accumulate(const Block& b, const LanePoint& p, Sums& sums) const {
    const Reprojection<Lanes> seen(k_, p.x, p.y, stdx::max(p.z, Lanes(kNearestDepthM)));
    const Lanes stereo = load(b.stereo);
    const Lanes eu = seen.u - load(b.u);
    const Lanes ev = seen.v - load(b.v);
    const Lanes er = seen.r - load(b.r);
    Lanes w = load(b.inv_sigma2) * load(b.active);
    Lanes chi2 = w * (eu * eu + ev * ev + stereo * er * er);
    where(p.z <= kNearestDepthM && w > 0.0, chi2) = kChi2Behind;
    where(p.z <= kNearestDepthM, w) = 0.0;
    if constexpr (kHuber) {
      const Lanes width2 = gate(b);
      const Lanes huber = stdx::min(Lanes(1.0), stdx::sqrt(width2 / stdx::max(chi2, Lanes(1e-30))));
      // rho = chi2 inside, 2 width sqrt(chi2) - width^2 outside, in one expression.
      sums.cost += 2.0 * huber * chi2 - stdx::min(chi2, width2);
      w *= huber;
    } else {
      sums.cost += chi2;
    }
    sums.add_row_without_1(w, eu, seen.du0, seen.du2, seen.du3, seen.du4, seen.du5);
    sums.add_row_without_0(w, ev, seen.dv1, seen.dv2, seen.dv3, seen.dv4, seen.dv5);
    sums.add_row_without_1(w * stereo, er, seen.du0, seen.dr2, seen.dr3, seen.dr4, seen.du5);
  }

  Intrinsics k_;
  double chi2_mono_;
  double chi2_stereo_;
};

struct Minimum {
  SE3 T_camera_world;
  bool settled = false;  ///< false: the iterations were used up
};

/// Decrease that the damped quadratic model promises for `step`.
double predicted_decrease(const NormalEquations& at, const Vector6d& step, double lambda) {
  const Vector6d damping = lambda * at.hessian.diagonal().cwiseProduct(step);
  return 0.5 * step.dot(damping - at.gradient);
}

Vector6d damped_step(const NormalEquations& at, double lambda) {
  Matrix6d damped = at.hessian;
  damped.diagonal() += lambda * at.hessian.diagonal();
  damped.diagonal().array() += 1e-9;  // directions that nothing observes stay as they are
  return -damped.llt().solve(at.gradient);
}

/// Levenberg-Marquardt with Marquardt's scaling and Nielsen's damping (Madsen, Nielsen, Tingleff,
/// Methods for non-linear least squares problems, 2004, alg. 3.16). Almost every step is accepted,
/// so a trial is linearised at once instead of first being tried by its cost alone.
template <bool kHuber>
Minimum minimise(const Evaluator& evaluator, const std::vector<Block>& blocks, const SE3& start,
                 int iterations) {
  constexpr double kRelativeDecrease = 1e-6;
  constexpr double kRounding = 1e-12;
  SE3 T = start;
  double lambda = 1e-5;
  double growth = 2.0;
  NormalEquations at = evaluator.linearise<kHuber>(blocks, T);
  for (int i = 0; i < iterations; ++i) {
    const Vector6d step = damped_step(at, lambda);
    const double predicted = predicted_decrease(at, step, lambda);
    if (!(predicted > kRounding * at.cost)) return {T, true};
    const SE3 trial = SE3::exp(step) * T;
    const NormalEquations next = evaluator.linearise<kHuber>(blocks, trial);
    const double decrease = at.cost - next.cost;
    if (!(decrease > 0.0)) {
      lambda *= growth;
      growth *= 2.0;
      continue;
    }
    const bool settled = decrease < kRelativeDecrease * at.cost;
    const double gain = 2.0 * decrease / predicted - 1.0;
    lambda = std::max(1e-9, lambda * std::max(1.0 / 3.0, 1.0 - gain * gain * gain));
    growth = 2.0;
    T = trial;
    at = next;
    if (settled) return {T, true};
  }
  return {T, false};
}

std::vector<std::uint8_t> flags_of(const std::vector<Block>& blocks, std::size_t count) {
  std::vector<std::uint8_t> flags(count);
  for (std::size_t i = 0; i < count; ++i) {
    flags[i] = blocks[i / kLanes].active[i % kLanes] > 0.0 ? 1 : 0;
  }
  return flags;
}

}  // namespace

void PoseOnlyOptions::describe(OptionTable& t) {
  t.add("rounds", rounds, {1, 20}, "", "rounds of optimising and judging observations anew");
  t.add("iterations_per_round", iterations_per_round, {1, 100}, "", "most steps in one round");
  t.add("chi2_mono", chi2_mono, {0.1, 1000.0}, "", "inlier gate without a depth reading");
  t.add("chi2_stereo", chi2_stereo, {0.1, 1000.0}, "", "inlier gate with a depth reading");
}

PoseOnlyResult optimize_pose(const Camera& camera, const SE3& T_camera_world,
                             std::span<const PoseObservation> observations,
                             const PoseOnlyOptions& options) {
  constexpr int kFewest = 3;
  constexpr double kAnyDistance = 1e100;
  const auto none = [&] {
    return PoseOnlyResult{T_camera_world, std::vector<std::uint8_t>(observations.size()), 0};
  };
  const Evaluator evaluator(camera, options);
  std::vector<Block> blocks = pack(observations);
  if (evaluator.judge(blocks, T_camera_world, kAnyDistance).inliers < kFewest) return none();

  SE3 T = T_camera_world;
  int inliers = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const bool robust = round < std::max(1, options.rounds / 2);
    const Minimum minimum =
        robust ? minimise<true>(evaluator, blocks, T, options.iterations_per_round)
               : minimise<false>(evaluator, blocks, T, options.iterations_per_round);
    T = minimum.T_camera_world;
    const Verdict verdict = evaluator.judge(blocks, T);
    inliers = verdict.inliers;
    if (inliers < kFewest) return none();
    if (!robust && minimum.settled && !verdict.changed) break;  // the next round would not move
  }
  PoseOnlyResult result;
  result.T_camera_world = T;
  result.inlier = flags_of(blocks, observations.size());
  result.inliers = inliers;
  return result;
}

Matrix6d pose_information(const Camera& camera, const SE3& T_camera_world,
                          std::span<const PoseObservation> observations,
                          std::span<const std::uint8_t> inlier) {
  std::vector<PoseObservation> used;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (inlier[i] != 0) used.push_back(observations[i]);
  }
  constexpr double kAnyDistance = 1e100;
  const Evaluator evaluator(camera, PoseOnlyOptions());
  std::vector<Block> blocks = pack(used);
  evaluator.judge(blocks, T_camera_world, kAnyDistance);
  return evaluator.linearise<false>(blocks, T_camera_world).hessian;
}

}  // namespace ydd
