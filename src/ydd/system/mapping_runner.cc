// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/mapping_runner.h"

#include <utility>

#include "ydd/base/guard.h"
#include "ydd/system/loop_steps.h"

namespace ydd {
namespace {

class InlineMapping final : public MappingRunner {
 public:
  InlineMapping(Mapper mapper, const LoopOptions& options)
      : mapper_(std::move(mapper)), options_(options), atlas_(mapper_.snapshot()) {}

  Result<bool> submit(KeyFrameCandidate candidate) override {
    if (!failure_) return failure_.error();
    if (finished_) return false;
    failure_ = guarded("mapping", [&]() -> Result<void> {
      reports_.keyframes.push_back(mapper_.process(candidate));
      atlas_ = mapper_.snapshot();
      close_loop(reports_.keyframes.back().keyframe);
      return {};
    });
    if (!failure_) return failure_.error();
    return true;
  }
  bool idle() const override { return true; }
  void wait_for_frames_before(Timestamp) override {}
  std::shared_ptr<const Atlas> atlas() const override { return atlas_; }
  Result<void> failure() const override { return failure_; }
  Result<void> finish(Ending) override {
    finished_ = true;
    return failure_;
  }
  MappingReports reports() const override { return reports_; }

 private:
  bool apply(const Correction& correction) {
    const bool applied = loop_steps::count(mapper_.apply(correction), reports_);
    if (applied) atlas_ = mapper_.snapshot();
    return applied;
  }

  void close_loop(KeyFrameId id) {
    const auto before = atlas_;
    const auto match = loop_steps::find(*before, id, options_, reports_);
    if (!match) return;
    const auto correction = loop_steps::correct(*before, *match, options_, reports_, {});
    if (!correction || !apply(*correction)) return;
    loop_steps::report(*before, *match, reports_);
    if (!options_.full_bundle) return;
    const auto refined = loop_steps::refine(*atlas_, match->matched, options_, reports_, {});
    if (refined && apply(*refined)) ++reports_.loop_counts.full_bundles;
  }

  Mapper mapper_;
  LoopOptions options_;
  std::shared_ptr<const Atlas> atlas_;
  MappingReports reports_;
  Result<void> failure_;
  bool finished_ = false;
};

}  // namespace

std::unique_ptr<MappingRunner> make_inline_mapping(Mapper mapper, const LoopOptions& options) {
  return std::make_unique<InlineMapping>(std::move(mapper), options);
}

}  // namespace ydd
