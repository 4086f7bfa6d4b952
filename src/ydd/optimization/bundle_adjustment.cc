// SPDX-License-Identifier: Apache-2.0
#include "ydd/optimization/bundle_adjustment.h"

#include <algorithm>
#include <utility>

#include "ydd/optimization/bundle_inertial.h"
#include "ydd/optimization/bundle_linearise.h"
#include "ydd/optimization/bundle_schur.h"

namespace ydd {
namespace {

using bundle::Layout;
using bundle::Loss;
using bundle::State;

constexpr double kNoGate = 1e100;

using Flags = std::vector<std::uint8_t>;

State moved(const Layout& layout, const State& state, const bundle::Step& step) {
  State next = state;
  for (int c = 0; c < layout.columns(); ++c) {
    SE3& T = next.T_camera_world[layout.pose_of_column[c]];
    T = SE3::exp(step.poses[c]) * T;
  }
  for (int j = 0; j < layout.points(); ++j) next.points[j] += step.points[j];
  if (layout.inertial) next.inertial = bundle::moved(layout, state.inertial, step.border);
  return next;
}

/// Damping by Nielsen's rule (Madsen, Nielsen, Tingleff 2004, alg. 3.16).
struct Damping {
  double lambda = 1e-4;
  double growth = 2.0;
  void refuse() {
    lambda *= growth;
    growth *= 2.0;
  }
  void accept(double gain_ratio) {
    const double g = 2.0 * gain_ratio - 1.0;
    lambda = std::max(1e-10, lambda * std::max(1.0 / 3.0, 1.0 - g * g * g));
    growth = 2.0;
  }
};

struct Phase {
  State state;
  int iterations = 0;
};

/// Levenberg-Marquardt over the active entries until the cost settles, iterations run out, or
/// `stop`: the state given is the best one then.
class Minimiser {
 public:
  Minimiser(const Camera& camera, const Layout& layout, double relative_decrease,
            std::stop_token stop, BundleWatch watch)
      : k_(camera),
        layout_(layout),
        solver_(layout),
        relative_decrease_(relative_decrease),
        stop_(std::move(stop)),
        watch_(std::move(watch)) {}

  Phase run(State state, const Flags& active, const Loss& loss, int most_iterations) {
    constexpr double kRounding = 1e-12;
    constexpr double kMostDamping = 1e12;
    Damping damping;
    Phase phase{std::move(state), 0};
    bool linearised = false;
    while (phase.iterations < most_iterations) {
      if (watch_ && phase.iterations > 0) watch_(phase.iterations);
      if (stop_.stop_requested()) break;
      if (!linearised) {
        at_ = bundle::linearise(k_, layout_, active, phase.state, loss, std::move(at_));
        linearised = true;
      }
      ++phase.iterations;
      const auto step = solver_.solve(at_, active, damping.lambda, stop_);
      if (stop_.stop_requested()) break;
      if (step && !(step->predicted_decrease > kRounding * at_.cost)) break;
      State trial = step ? moved(layout_, phase.state, *step) : State();
      const double decrease =
          step ? at_.cost - bundle::cost_of(k_, layout_, active, trial, loss) : -1.0;
      if (!(decrease > 0.0)) {
        damping.refuse();
        if (damping.lambda > kMostDamping) break;
        continue;
      }
      damping.accept(decrease / step->predicted_decrease);
      phase.state = std::move(trial);
      linearised = false;
      if (decrease < relative_decrease_ * at_.cost) break;
    }
    return phase;
  }

 private:
  Intrinsics k_;
  const Layout& layout_;
  bundle::SchurSolver solver_;
  double relative_decrease_;
  std::stop_token stop_;
  BundleWatch watch_;
  bundle::NormalEquations at_;
};

Flags usable_entries(const Layout& layout) {
  Flags usable;
  for (const Layout::Entry& e : layout.entries) usable.push_back(e.usable ? 1 : 0);
  return usable;
}

Flags in_order_of_problem(const Layout& layout, const Flags& of_entries) {
  Flags flags(of_entries.size());
  for (std::size_t i = 0; i < flags.size(); ++i) flags[layout.entries[i].source] = of_entries[i];
  return flags;
}

}  // namespace

void BundleOptions::describe(OptionTable& t) {
  t.add("robust_iterations", robust_iterations, {0, 1000}, "",
        "iterations with Huber's kernel, before outliers are set aside");
  t.add("final_iterations", final_iterations, {0, 1000}, "", "iterations without outliers");
  t.add("chi2_mono", chi2_mono, {0.1, 1000.0}, "", "inlier gate without a depth reading");
  t.add("chi2_stereo", chi2_stereo, {0.1, 1000.0}, "", "inlier gate with a depth reading");
  t.add("relative_decrease", relative_decrease, {0.0, 0.1}, "",
        "a step that lowers the cost by a smaller share ends its phase");
}

BundleResult solve_bundle(const Camera& camera, const BundleProblem& problem,
                          const BundleOptions& options, const std::stop_token& stop,
                          const BundleWatch& watch) {
  const Intrinsics k(camera);
  const Layout layout = bundle::make_layout(problem);
  const Flags usable = usable_entries(layout);
  const Loss robust{options.chi2_mono, options.chi2_stereo, true};
  const Loss plain{options.chi2_mono, options.chi2_stereo, false};
  Minimiser minimiser(camera, layout, options.relative_decrease, stop, watch);
  State state = bundle::state_of(problem);

  BundleResult result;
  result.initial_cost = bundle::cost_of(k, layout, usable, state, robust);
  const Flags in_front = bundle::judge(k, layout, state, robust, kNoGate);
  Phase first = minimiser.run(std::move(state), in_front, robust, options.robust_iterations);
  const Flags good = bundle::judge(k, layout, first.state, robust);
  Phase last = minimiser.run(std::move(first.state), good, plain, options.final_iterations);

  result.final_cost = bundle::cost_of(k, layout, usable, last.state, robust);
  result.inlier = in_order_of_problem(layout, bundle::judge(k, layout, last.state, robust));
  result.iterations = first.iterations + last.iterations;
  result.interrupted = stop.stop_requested();
  result.T_camera_world = std::move(last.state.T_camera_world);
  result.points = std::move(last.state.points);
  if (layout.inertial) result.inertial = std::move(last.state.inertial);
  return result;
}

}  // namespace ydd
