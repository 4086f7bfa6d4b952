// SPDX-License-Identifier: Apache-2.0
#include "ydd/evidence/ego_motion.h"

#include <random>

#include <gtest/gtest.h>

namespace ydd {
namespace {

double random_between(std::mt19937& random, double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 32>(random);
}

Descriptor random_descriptor(std::mt19937& random) {
  Descriptor out{};
  for (std::uint64_t& word : out) {
    const std::uint64_t upper = random();
    word = (upper << 32U) | random();
  }
  return out;
}

SE3 motion(double x_m, double y_m, double z_m, double turn_rad) {
  return {so3_exp({0.3 * turn_rad, turn_rad, 0}), Eigen::Vector3d(x_m, y_m, z_m)};
}

void add_feature(Features& features, const Eigen::Vector3d& p, const Eigen::Vector2d& off_px,
                 const Descriptor& descriptor) {
  const Camera camera;
  const Eigen::Vector2f px = (camera.project(p) + off_px).cast<float>();
  features.keypoints.push_back({px.x(), px.y(), 0, 1, 0});
  features.descriptors.push_back(descriptor);
  features.undistorted_px.push_back(px);
  features.depth_m.push_back(static_cast<float>(p.z()));
  features.right_px.push_back(px.x() - static_cast<float>(camera.bf() / p.z()));
}

/// Pieces with features, each moving in its own way from one frame to the next.
class PieceScene {
 public:
  PieceScene& add(const SE3& T_now_then, int features, float weight, double noise_px = 0) {
    const double z = random_between(random_, 1, 3);
    const double y = random_between(random_, -0.5, 0.5);
    const Eigen::Vector3d centre(random_between(random_, -0.6, 0.6), y, z);
    for (int k = 0; k < features; ++k) {
      const double off_z = random_between(random_, -0.02, 0.02);
      const double off_y = random_between(random_, -0.1, 0.1);
      const Eigen::Vector3d p =
          centre + Eigen::Vector3d(random_between(random_, -0.1, 0.1), off_y, off_z);
      const double off_v_px = random_between(random_, -noise_px, noise_px);
      const Eigen::Vector2d off_px(random_between(random_, -noise_px, noise_px), off_v_px);
      const Descriptor descriptor = random_descriptor(random_);
      const int i = static_cast<int>(pairs.size());
      add_feature(then, p, Eigen::Vector2d::Zero(), descriptor);
      add_feature(now, T_now_then * p, off_px, descriptor);
      pairs.push_back({i, i});
      piece_of.push_back(static_cast<int>(weight_.size()));
    }
    weight_.push_back(weight);
    return *this;
  }
  PairedPieces pieces() const { return {then, now, pairs, piece_of, Camera(), {}}; }
  const std::vector<float>& weight() const { return weight_; }

  Features then, now;
  std::vector<FeaturePair> pairs;
  std::vector<int> piece_of;

 private:
  std::mt19937 random_{7};
  std::vector<float> weight_;
};

void expect_near(const SE3& found, const SE3& wanted) {
  const SE3 off = found * wanted.inverse();
  EXPECT_LT(off.translation().norm(), 0.002);
  EXPECT_LT(off.angle_rad(), 0.001);
}

PieceScene two_sets(const SE3& a, float weight_a, const SE3& b, float weight_b,
                    double noise_px = 0) {
  PieceScene scene;
  for (int k = 0; k < 6; ++k) {
    scene.add(a, 6, weight_a, noise_px);
    scene.add(b, 20, weight_b, noise_px);
  }
  return scene;
}

const SE3 kCamera = motion(0.02, 0, 0.01, 0.01);
const SE3 kOther = motion(0.10, 0.03, 0.01, 0.01);

TEST(PairFeatures, FindsThemWhereTheRoomsMotionBringsThem) {
  const SE3 far = motion(0.3, 0, 0, 0);  // beyond the search without the motion
  PieceScene scene;
  scene.add(far, 10, 1);
  const KeypointGrid grid(scene.now, Camera());
  const std::vector<FeaturePair> pairs =
      pair_features(scene.then, scene.now, grid, far, Camera(), {});
  ASSERT_EQ(pairs.size(), 10U);
  for (const FeaturePair& pair : pairs) EXPECT_EQ(pair.then, pair.now);
  EXPECT_TRUE(pair_features(scene.then, scene.now, grid, SE3(), Camera(), {}).empty());
}

TEST(PairFeatures, LeavesOutWhatLooksOtherwiseOrHasNoDepth) {
  PieceScene scene;
  scene.add(SE3(), 10, 1);
  for (std::uint64_t& word : scene.now.descriptors[3]) word = ~word;
  scene.then.depth_m[4] = 0;
  const KeypointGrid grid(scene.now, Camera());
  const std::vector<FeaturePair> pairs =
      pair_features(scene.then, scene.now, grid, SE3(), Camera(), {});
  EXPECT_EQ(pairs.size(), 8U);
  for (const FeaturePair& pair : pairs) {
    EXPECT_NE(pair.then, 3);
    EXPECT_NE(pair.then, 4);
  }
}

TEST(PairFeatures, OfTwinsTheNearestIsTakenAndNoneTwice) {
  std::mt19937 random(3);
  const Descriptor alike = random_descriptor(random);
  Features then, now;
  add_feature(then, {0, 0, 2}, {0, 0}, alike);
  add_feature(then, {0.03, 0, 2}, {0, 0}, alike);
  add_feature(now, {0.028, 0, 2}, {0, 0}, alike);
  const std::vector<FeaturePair> pairs =
      pair_features(then, now, KeypointGrid(now, Camera()), SE3(), Camera(), {});
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].then, 1);
}

TEST(PieceMotions, AreLargeForThePieceThatMovedOnly) {
  PieceScene scene;
  for (int k = 0; k < 6; ++k) scene.add(k == 4 ? motion(0.05, 0, 0, 0) * kCamera : kCamera, 8, 1);
  const std::vector<PieceMotion> motions = scene.pieces().motions(kCamera);
  ASSERT_EQ(motions.size(), 6U);
  for (const PieceMotion& m : motions) {
    EXPECT_EQ(m.pairs, 8);
    if (m.piece == 4) {
      EXPECT_GT(m.chi2, EvidenceOptions().moved_chi2);
    } else {
      EXPECT_LT(m.chi2, 0.1);
    }
  }
}

TEST(PieceMotions, SeeMotionAlongTheViewByDepth) {
  PieceScene scene;
  scene.add(motion(0, 0, 0.15, 0), 8, 1);
  scene.now.undistorted_px = scene.then.undistorted_px;  // as if nothing moved in the image
  const double chi2 = scene.pieces().motions(SE3())[0].chi2;
  EXPECT_GT(chi2, 9.0);
  for (float& z_m : scene.now.depth_m) z_m = 0;
  EXPECT_LT(scene.pieces().motions(SE3())[0].chi2, 1.0);
}

TEST(PieceMotions, LeaveOutWhatIsOnNoPieceAndWhatHasFewPairs) {
  PieceScene scene;
  scene.add(SE3(), 2, 1).add(SE3(), 3, 1).add(SE3(), 5, 1);
  for (std::size_t i = 5; i < 10; ++i) scene.piece_of[i] = -1;
  const std::vector<PieceMotion> motions = scene.pieces().motions(SE3());
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].piece, 1);
}

TEST(PieceMotions, AreJudgedByTheSensorsExcess) {
  PieceScene scene;
  scene.add(motion(0.03, 0, 0, 0), 8, 1);
  PairedPieces pieces = scene.pieces();
  const double chi2 = pieces.motions(SE3())[0].chi2;
  pieces.set_excess(4);
  EXPECT_NEAR(pieces.motions(SE3())[0].chi2, chi2 / 4, 1e-9 * chi2);
}

TEST(Support, CountsTheWeightOfWhatAgrees) {
  const PieceScene scene = two_sets(kCamera, 1.0F, kOther, 0.25F);
  const PairedPieces::Support support = scene.pieces().support(kCamera, scene.weight());
  EXPECT_NEAR(support.total, 7.5, 1e-5);
  EXPECT_NEAR(support.agreeing, 6.0, 0.1);
  EXPECT_NEAR(scene.pieces().support(kOther, scene.weight()).agreeing, 1.5, 0.1);
}

TEST(Support, BareWallsTellByTheirDepth) {
  const Camera camera;
  CoarseDepth wall = coarse_depth({640, 480, std::vector<float>(std::size_t{640} * 480, 2.0F)}, 8);
  const std::vector<Eigen::Vector2f> rays = cell_rays(camera, wall.grid);
  const Surfaces surfaces = find_surfaces(wall, rays, {});
  PairedPieces pieces({}, {}, {}, {}, camera, {});
  const std::vector<float> weight(static_cast<std::size_t>(surfaces.count), 1.0F);
  EXPECT_EQ(pieces.support(SE3(), weight).total, 0.0);
  pieces.add_depth(wall, surfaces, rays, wall);
  const PairedPieces::Support still = pieces.support(SE3(), weight);
  EXPECT_GT(still.total, 0.5 * surfaces.count);
  EXPECT_NEAR(still.agreeing, still.total, 1e-3);
  EXPECT_NEAR(pieces.support(motion(0, 0, 0.05, 0), weight).agreeing, 0.0, 1e-3);
  EXPECT_GT(pieces.support(motion(0.05, 0, 0, 0), weight).agreeing, 0.5 * surfaces.count)
      << "along the wall depth cannot tell";
}

TEST(Consensus, IsWhatTheHeavierPiecesAgreeWith) {
  // The others have more than three times as many features.
  const PieceScene scene = two_sets(kCamera, 1.0F, kOther, 0.25F);
  expect_near(scene.pieces().consensus(SE3(), scene.weight(), 100, 1), kCamera);
}

TEST(Consensus, FollowsTheWeightEvenAgainstWhatIsExpected) {
  const PieceScene scene = two_sets(kCamera, 0.25F, kOther, 1.0F);
  expect_near(scene.pieces().consensus(kCamera, scene.weight(), 100, 1), kOther);
}

TEST(Consensus, OfTooFewPiecesIsWhatWasExpected) {
  PieceScene scene;
  scene.add(kOther, 20, 1).add(kOther, 20, 1);
  const SE3 found = scene.pieces().consensus(kCamera, scene.weight(), 100, 1);
  EXPECT_EQ(found.translation(), kCamera.translation());
  EXPECT_EQ(found.rotation().coeffs(), kCamera.rotation().coeffs());
}

TEST(Consensus, IsTheSameBitForBit) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto found = [&] {
      const PieceScene scene = two_sets(kCamera, 0.5F, kOther, 0.6F, 1.0);
      return scene.pieces().consensus(SE3(), scene.weight(), 40, seed);
    };
    const SE3 once = found();
    const SE3 again = found();
    EXPECT_EQ(once.translation(), again.translation());
    EXPECT_EQ(once.rotation().coeffs(), again.rotation().coeffs());
  }
}

}  // namespace
}  // namespace ydd
