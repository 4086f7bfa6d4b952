// SPDX-License-Identifier: Apache-2.0
//
// How often the tracking thread asks for memory. What a frame leaves (features, observations,
// results) are values of their own that others keep, so it cannot be never; but it must be a number
// that does not grow with features, map or time.
#include <algorithm>
#include <cstdlib>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "command_line.h"
#include "ydd/simulation/simulator.h"
#include "ydd/system/slam_system.h"

namespace {
thread_local long allocations = 0;

[[maybe_unused]] void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// Sanitizers have operators of their own, which know which belongs to which.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace ydd::e2e {
namespace {

/// Median over the later frames of a sequence of allocations per frame without a keyframe.
long median_allocations(Variant variant, int features) {
  WorldOptions world;
  world.path = PathKind::xyz;
  world.depth = DepthModel::kinect;
  world.width_px = 320;
  world.height_px = 240;
  world.frames = 60;
  const Simulator simulator(world);
  SystemOptions options;
  options.dynamics.variant = variant;
  options.dynamics.compensation.points = features;
  SlamSystem system(simulator.camera(), options, ObjectCatalogue::defaults(), nullptr);
  std::vector<long> counts;
  for (int i = 0; i < world.frames; ++i) {
    const SimulatedFrame frame = simulator.render(i);
    const long before = allocations;
    const Result<FrameReport> report = system.process(frame.frame);
    const long used = allocations - before;
    if (i > world.frames / 2 && !report.value().keyframe) counts.push_back(used);
  }
  EXPECT_TRUE(system.finish());
  std::nth_element(counts.begin(), counts.begin() + static_cast<long>(counts.size() / 2),
                   counts.end());
  return counts.at(counts.size() / 2);
}

TEST(Allocations, OfAFrameAreFewAndDoNotGrowWithItsFeatures) {
  if (kSanitized) GTEST_SKIP() << "allocations are not counted under sanitizers";
  struct Case {
    Variant variant;
    long most;
  };
  for (const Case& c : {Case{Variant::full, 110}, Case{Variant::evidence, 240}}) {
    const std::string name(to_string(c.variant));
    const long few = median_allocations(c.variant, 300);
    const long many = median_allocations(c.variant, 1200);
    RecordProperty(name + "_300", static_cast<int>(few));
    RecordProperty(name + "_1200", static_cast<int>(many));
    EXPECT_LT(many, c.most) << name;
    EXPECT_LT(many, few + 25) << name;
  }
}

}  // namespace
}  // namespace ydd::e2e
