// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_adjustment_ceres.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <ceres/ceres.h>

#include "ydd/optimization/bundle_linearise.h"
#include "ydd/optimization/ceres_support.h"

namespace ydd {
namespace {

using bundle::Layout;
using bundle::Loss;
using bundle::State;
using Flags = std::vector<std::uint8_t>;

/// Two rows without a depth reading, three with one, in units of the standard deviation.
template <int kRows>
class ReprojectionCost : public ceres::SizedCostFunction<kRows, PoseBlock::kSize, 3> {
 public:
  ReprojectionCost(const Intrinsics& k, const Layout::Entry& e)
      : k_(k), uvr_px_(e.uvr_px), inv_sigma_(std::sqrt(e.inv_sigma2)) {}

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Matrix<double, kRows, 1>> r(residuals);
    const SE3 T = PoseBlock::to_se3(parameters[0]);
    const Eigen::Vector3d p = T * Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(parameters[1]));
    Eigen::Matrix<double, 3, 6> by_twist = Eigen::Matrix<double, 3, 6>::Zero();
    if (p.z() <= kNearestDepthM) {
      r.setConstant(std::sqrt(kChi2Behind / kRows));
    } else {
      const Reprojection<double> seen(k_, p.x(), p.y(), p.z());
      const Eigen::Vector3d all = Eigen::Vector3d(seen.u, seen.v, seen.r) - uvr_px_;
      r = inv_sigma_ * all.head<kRows>();
      by_twist = inv_sigma_ * twist_jacobian(seen);
    }
    if (jacobians && jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, kRows, 7, Eigen::RowMajor>> j(jacobians[0]);
      j.template leftCols<6>() = by_twist.topRows<kRows>();
      j.col(6).setZero();
    }
    if (jacobians && jacobians[1]) {
      Eigen::Map<Eigen::Matrix<double, kRows, 3, Eigen::RowMajor>> j(jacobians[1]);
      j = by_twist.topRows<kRows>().template leftCols<3>() * T.rotation_matrix();
    }
    return true;
  }

 private:
  Intrinsics k_;
  Eigen::Vector3d uvr_px_;
  double inv_sigma_;
};

/// Parameters, problem and ordering of one phase. Ceres keeps pointers into `poses` and `points`.
class CeresPhase {
 public:
  CeresPhase(const Intrinsics& k, const Layout& layout, const State& state, const Flags& active,
             const Loss& loss)
      : layout_(layout),
        points_(state.points),
        mono_(std::sqrt(loss.chi2_mono)),
        stereo_(std::sqrt(loss.chi2_stereo)),
        problem_(problem_options()) {
    for (const SE3& T : state.T_camera_world) poses_.emplace_back(T);
    for (int j = 0; j < layout.points(); ++j) {
      for (int i = layout.first[j]; i < layout.first[j + 1]; ++i) {
        if (active[i]) add(k, layout.entries[i], j, loss.huber);
      }
    }
    finish_parameters();
  }

  int solve(int most_iterations, double relative_decrease, const std::stop_token& stop) {
    if (problem_.NumResidualBlocks() == 0 || most_iterations == 0 || stop.stop_requested())
      return 0;
    ceres::Solver::Options options;
    options.linear_solver_type = layout_.columns() > 80 ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
    options.linear_solver_ordering = ordering_;
    options.num_threads = 1;
    options.max_num_iterations = most_iterations;
    options.max_trust_region_radius = 1e10;  // the least damping of our own solver
    options.function_tolerance = relative_decrease;
    options.gradient_tolerance = 0.0;
    options.parameter_tolerance = 0.0;
    options.logging_type = ceres::SILENT;
    StopCallback callback(stop);
    options.callbacks.push_back(&callback);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return static_cast<int>(summary.iterations.size()) - 1;
  }

  State state() const {
    State state;
    for (const PoseBlock& pose : poses_) state.T_camera_world.push_back(pose.to_se3());
    state.points = points_;
    return state;
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void add(const Intrinsics& k, const Layout::Entry& e, int point, bool huber) {
    ceres::CostFunction* cost = nullptr;
    if (e.stereo) {
      cost = new ReprojectionCost<3>(k, e);
    } else {
      cost = new ReprojectionCost<2>(k, e);
    }
    ceres::LossFunction* loss = nullptr;
    if (huber) loss = e.stereo ? &stereo_ : &mono_;
    problem_.AddResidualBlock(cost, loss, poses_[e.pose].values, points_[point].data());
  }

  void finish_parameters() {
    ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector3d& p : points_) {
      if (problem_.HasParameterBlock(p.data())) ordering_->AddElementToGroup(p.data(), 0);
    }
    std::vector<bool> is_free(poses_.size(), false);
    for (const int pose : layout_.pose_of_column) is_free[pose] = true;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      double* values = poses_[i].values;
      if (!problem_.HasParameterBlock(values)) continue;
      problem_.SetManifold(values, &manifold_);
      ordering_->AddElementToGroup(values, 1);
      if (!is_free[i]) problem_.SetParameterBlockConstant(values);
    }
  }

  const Layout& layout_;
  std::vector<PoseBlock> poses_;
  std::vector<Eigen::Vector3d> points_;
  TwistManifold<TwistSide::left> manifold_;
  ceres::HuberLoss mono_;
  ceres::HuberLoss stereo_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
  ceres::Problem problem_;
};

}  // namespace

BundleResult solve_bundle_ceres(const Camera& camera, const BundleProblem& problem,
                                const BundleOptions& options, const std::stop_token& stop) {
  constexpr double kAnyDistance = 1e100;
  const Intrinsics k(camera);
  const Layout layout = bundle::make_layout(problem);
  if (layout.inertial) throw std::logic_error("bundle adjustment by Ceres: no inertial links");
  const Loss robust{options.chi2_mono, options.chi2_stereo, true};
  const Loss plain{options.chi2_mono, options.chi2_stereo, false};
  Flags usable;
  for (const Layout::Entry& e : layout.entries) usable.push_back(e.usable ? 1 : 0);

  BundleResult result;
  State state = bundle::state_of(problem);
  result.initial_cost = bundle::cost_of(k, layout, usable, state, robust);
  CeresPhase first(k, layout, state, bundle::judge(k, layout, state, robust, kAnyDistance), robust);
  result.iterations += first.solve(options.robust_iterations, options.relative_decrease, stop);
  state = first.state();
  CeresPhase last(k, layout, state, bundle::judge(k, layout, state, robust), plain);
  result.iterations += last.solve(options.final_iterations, options.relative_decrease, stop);
  state = last.state();

  result.final_cost = bundle::cost_of(k, layout, usable, state, robust);
  const Flags inlier = bundle::judge(k, layout, state, robust);
  result.inlier.resize(inlier.size());
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    result.inlier[layout.entries[i].source] = inlier[i];
  }
  result.interrupted = stop.stop_requested();
  result.T_camera_world = std::move(state.T_camera_world);
  result.points = std::move(state.points);
  return result;
}

}  // namespace ydd
