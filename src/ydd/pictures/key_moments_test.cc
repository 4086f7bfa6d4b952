// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/key_moments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/pictures/loop_picture.h"

namespace ydd {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

ColourImage plain(Bgr colour) { return {64, 48, std::vector<Bgr>(64U * 48U, colour)}; }

/// Feeds frames of which so many of ten points are rejected.
class Player {
 public:
  void add(std::int64_t index, double time_s, TrackingState state, int rejected,
           int local_points = 100) {
    RgbdFrame frame;
    frame.colour = plain({0, 0, 0});
    FrameReport report;
    report.index = index;
    report.stamp.ns = static_cast<std::int64_t>(time_s * kSecond_ns);
    report.track.state = state;
    report.track.local_points = local_points;
    Features kept;
    FilteredFeatures filtered;
    for (int i = 0; i < 10; ++i) {
      if (i < rejected) {
        filtered.rejected.push_back({{5, 5, 0, 10, 0}, 1, Rule::edge});
        continue;
      }
      kept.keypoints.push_back({9, 9, 0, 10, 0});
      kept.descriptors.push_back({});
      kept.undistorted_px.emplace_back(9, 9);
      kept.depth_m.push_back(1);
      kept.right_px.push_back(1);
    }
    filtered.kept = std::make_shared<const Features>(std::move(kept));
    report.filtered = std::make_shared<const FilteredFeatures>(std::move(filtered));
    moments_.add(frame, report);
  }

  std::vector<FrameMoment> draw(const std::vector<LoopReport>& loops = {}) const {
    const Atlas atlas(Camera{}, PyramidScales::make(8, 1.2));
    return moments_.draw(ObjectCatalogue::defaults(), loops, atlas,
                         [](std::int64_t frame) -> Result<ColourImage> {
                           if (frame == 99) return Error{"gone"};
                           return plain({0, 0, 200});
                         });
  }

  std::vector<std::pair<std::int64_t, std::string>> told() const {
    std::vector<std::pair<std::int64_t, std::string>> out;
    for (const FrameMoment& m : draw()) out.emplace_back(m.frame, m.kind);
    return out;
  }

 private:
  KeyMoments moments_;
};

using Told = std::vector<std::pair<std::int64_t, std::string>>;
constexpr auto kTracking = TrackingState::tracking;
constexpr auto kLost = TrackingState::lost;

TEST(KeyMoments, NothingHappenedNothingIsShown) {
  Player player;
  for (int i = 0; i < 5; ++i) player.add(i, i, kTracking, 0);
  EXPECT_TRUE(player.draw().empty());
}

TEST(KeyMoments, PeaksAreThreeAndApart) {
  Player player;
  const int rejected[] = {1, 5, 2, 0, 0, 7, 8, 1, 0, 0, 2, 0, 0, 0, 0, 4};
  for (int i = 0; i < 16; ++i) player.add(i, 0.5 * i, kTracking, rejected[i]);
  EXPECT_EQ(player.told(),
            (Told{{1, "most_rejected"}, {6, "most_rejected"}, {15, "most_rejected"}}));
}

TEST(KeyMoments, LostAndFoundAreTheFirstFramesOfEither) {
  Player player;
  player.add(0, 0, TrackingState::initializing, 0);
  player.add(1, 1, kTracking, 0);
  player.add(2, 2, kLost, 0);
  player.add(3, 3, kLost, 0);
  player.add(4, 4, kTracking, 0);
  player.add(5, 5, kLost, 0);
  player.add(6, 6, kTracking, 0, /*local_points=*/0);
  EXPECT_EQ(player.told(), (Told{{2, "lost"}, {4, "found"}, {5, "lost"}, {6, "found"}}));
  EXPECT_EQ(player.draw().at(1).moment.caption, "Frame 4: found again after 2 frames");
  EXPECT_EQ(player.draw().at(3).moment.caption, "Frame 6: a new map begins after 1 frame");
}

TEST(KeyMoments, AreNeverMoreThanTwelve) {
  Player player;
  for (int i = 0; i < 200; ++i) player.add(i, i, i % 2 ? kLost : kTracking, i % 10);
  std::vector<LoopReport> loops(20);
  for (std::size_t i = 0; i < loops.size(); ++i) loops[i].current_frame = static_cast<int>(i);
  EXPECT_EQ(player.draw(loops).size(), 12U);
}

TEST(KeyMoments, LoopsAreThoseThatMatteredMost) {
  Player player;
  player.add(0, 0, kTracking, 0);
  std::vector<LoopReport> loops(5);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    loops[i].current_frame = 10 * static_cast<int>(i);
    loops[i].shift_m = i == 2 ? 0.0 : 0.1 * static_cast<double>(i);
  }
  loops[3].current_frame = 99;  // can not be read
  const auto moments = player.draw(loops);
  ASSERT_EQ(moments.size(), 2U);
  EXPECT_EQ(moments.at(0).frame, 10);
  EXPECT_EQ(moments.at(1).frame, 40);
  EXPECT_TRUE(moments.at(1).moment.wide);
  EXPECT_THAT(moments.at(1).moment.caption, testing::HasSubstr("40.0 cm"));
  EXPECT_THAT(moments.at(1).moment.jpeg, testing::StartsWith("\xff\xd8"));
}

TEST(LoopPicture, ShowsThenAndNow) {
  const Atlas atlas(Camera{}, PyramidScales::make(8, 1.2));
  const ColourImage picture =
      loop_picture(LoopReport{}, atlas, plain({10, 0, 0}), plain({0, 0, 20}));
  ASSERT_EQ(picture.width(), 128);
  EXPECT_EQ(picture(63, 40), (Bgr{10, 0, 0}));
  EXPECT_EQ(picture(64, 40), (Bgr{0, 0, 20}));
  EXPECT_TRUE(loop_picture(LoopReport{}, atlas, plain({0, 0, 0}), ColourImage()).empty());
}

}  // namespace
}  // namespace ydd
