// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace ydd {
namespace {

WorldOptions small(const std::string& path) {
  WorldOptions options;
  options.width_px = 320;
  options.height_px = 240;
  options.path = parse_choice<PathKind>(path).value();
  options.frames = 120;
  return options;
}

template <class T>
bool same(const Image<T>& a, const Image<T>& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.data(), a.data() + std::size_t(a.width()) * a.height(), b.data());
}

bool same(const SimulatedFrame& a, const SimulatedFrame& b) {
  return same(a.frame.colour, b.frame.colour) && same(a.frame.grey, b.frame.grey) &&
         same(a.frame.depth_m, b.frame.depth_m) && same(a.mask, b.mask) &&
         a.objects.size() == b.objects.size() && a.frame.stamp == b.frame.stamp;
}

/// Corners as Shi and Tomasi find them.
std::vector<cv::Point2f> corners(const GreyImage& grey) {
  cv::Mat image(grey.height(), grey.width(), CV_8UC1);
  std::copy_n(grey.data(), image.total(), image.data);
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(image, found, 4000, 0.002, 3);
  return found;
}

int count(const Image<std::uint8_t>& mask, int id) {
  return static_cast<int>(
      std::count(mask.data(), mask.data() + std::size_t(mask.width()) * mask.height(), id));
}

Box bounds(const Image<std::uint8_t>& mask, int id) {
  Box box{1e9F, 1e9F, 0, 0};
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) != id) continue;
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      box = {std::min(box.x0, fx), std::min(box.y0, fy), std::max(box.x1, fx + 1),
             std::max(box.y1, fy + 1)};
    }
  }
  return box;
}

TEST(Simulator, SameSeedSameBytesInAnyOrderOnAnyNumberOfThreads) {
  WorldOptions options = small("xyz");
  options.people = 3;
  options.depth = DepthModel::kinect;
  options.exposure_noise = 0.02;
  const Simulator one(options);
  options.threads = 2;
  const Simulator other(options);
  const SimulatedFrame a0 = one.render(7);
  const SimulatedFrame a1 = one.render(90);
  const SimulatedFrame b1 = other.render(90);
  const SimulatedFrame b0 = other.render(7);
  EXPECT_TRUE(same(a0, b0));
  EXPECT_TRUE(same(a1, b1));
  EXPECT_FALSE(same(a0, a1));
  options.seed = 2;
  EXPECT_FALSE(same(Simulator(options).render(7).frame.colour, a0.frame.colour));
}

TEST(Simulator, StaticPointsReprojectBetweenFrames) {
  const Simulator simulator(small("xyz"));
  const SimulatedFrame a = simulator.render(0);
  const SimulatedFrame b = simulator.render(40);
  const Camera& camera = simulator.camera();
  const SE3 T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  EXPECT_GT(T_b_a.translation().norm(), 0.1);
  int tried = 0;
  int agree = 0;
  for (int y = 2; y < 238; y += 3) {
    for (int x = 2; x < 318; x += 3) {
      const double z = static_cast<double>(a.frame.depth_m(x, y));
      if (z <= 0) continue;
      const Eigen::Vector3d p = T_b_a * camera.unproject({x, y}, z);
      const Eigen::Vector2d px = camera.project(p);
      const int u = static_cast<int>(std::floor(px.x()));
      const int v = static_cast<int>(std::floor(px.y()));
      if (u < 1 || v < 1 || u > 317 || v > 237) continue;
      // Inverse depth is linear over the picture of a plane, so it may be interpolated exactly.
      const auto inverse = [&](int i, int j) {
        return 1.0 / static_cast<double>(b.frame.depth_m(u + i, v + j));
      };
      const double du = px.x() - u;
      const double dv = px.y() - v;
      const double expected = (1 - dv) * ((1 - du) * inverse(0, 0) + du * inverse(1, 0)) +
                              dv * ((1 - du) * inverse(0, 1) + du * inverse(1, 1));
      ++tried;
      // A displacement of 0.02 px on a surface at 45 degrees 3 m away is 0.2 mm.
      agree += std::abs(1.0 / expected - p.z()) < 2e-4 ? 1 : 0;
    }
  }
  EXPECT_GT(tried, 4000);
  EXPECT_GT(agree, 0.85 * tried);  // the rest lies at silhouettes, creases and round things
}

TEST(Simulator, RoomHasCornersEverywhere) {
  WorldOptions options = small("room_loop");
  options.width_px = 640;
  options.height_px = 480;
  options.frames = 0;
  const Simulator simulator(options);
  for (int i = 0; i < simulator.frame_count(); i += simulator.frame_count() / 5) {
    const std::vector<cv::Point2f> found = corners(simulator.render(i).frame.grey);
    EXPECT_GT(found.size(), 1500U) << "frame " << i;
    std::map<int, int> cells;
    for (const cv::Point2f& p : found) {
      ++cells[static_cast<int>(p.x / 160) + 4 * static_cast<int>(p.y / 160)];
    }
    EXPECT_GE(cells.size(), 11U) << "frame " << i;
  }
}

TEST(Simulator, MasksAndBoxesAreThoseOfThePeople) {
  WorldOptions options = small("static");
  options.people = 3;
  const Simulator simulator(options);
  int people = 0;
  int parts = 0;
  for (const int i : {0, 50, 110}) {
    const SimulatedFrame frame = simulator.render(i);
    for (const SimulatedObject& object : frame.objects) {
      if (object.class_name == "person") {
        ++people;
        EXPECT_TRUE(object.moved_in_sequence);
        EXPECT_EQ(object.pixels, count(frame.mask, object.id)) << object.name;
        EXPECT_EQ(object.box, bounds(frame.mask, object.id)) << object.name;
      }
      if (object.class_name != "head" && object.class_name != "hand") continue;
      const auto whole = std::find_if(
          frame.objects.begin(), frame.objects.end(),
          [&](const SimulatedObject& o) { return o.class_name == "person" && o.id == object.id; });
      ASSERT_NE(whole, frame.objects.end());
      EXPECT_EQ(intersection(whole->box, object.box), object.box) << object.name;
      EXPECT_LT(object.pixels, whole->pixels);
      ++parts;
    }
  }
  EXPECT_GE(people, 5);
  EXPECT_GE(parts, 5);
}

TEST(Simulator, MoversAreWhereThePictureShowsThem) {
  WorldOptions options = small("static");
  options.people = 3;
  const Simulator simulator(options);
  int seen = 0;
  for (const int i : {0, 50, 110}) {
    const SimulatedFrame frame = simulator.render(i);
    const std::vector<SimulatedMover> before = simulator.movers(i - 1), now = simulator.movers(i),
                                      after = simulator.movers(i + 1);
    for (std::size_t k = 0; k < now.size(); ++k) {
      const Eigen::Vector3d step_m = after[k].middle_m - before[k].middle_m;
      EXPECT_LT((now[k].velocity_m_s - step_m * options.fps / 2).norm(), 0.05) << now[k].name;
      EXPECT_NE(now[k].class_name, "head");
      if (now[k].class_name == "person") {
        EXPECT_GT(now[k].middle_m.z(), 0.6) << "sitting or standing on the floor";
        EXPECT_LT(now[k].middle_m.z(), 1.3);
      }
      const auto object =
          std::find_if(frame.objects.begin(), frame.objects.end(),
                       [&](const SimulatedObject& o) { return o.name == now[k].name; });
      if (object == frame.objects.end() || object->pixels < 2000) continue;
      const Box& box = object->box;
      const bool whole = box.x0 > 1 && box.y0 > 1 && box.x1 < 319 && box.y1 < 239;
      if (!whole) continue;
      const Eigen::Vector3d p = frame.T_world_camera.inverse() * now[k].middle_m;
      const Eigen::Vector2d px = simulator.camera().project(p);
      EXPECT_TRUE(object->box.contains(static_cast<float>(px.x()), static_cast<float>(px.y())))
          << object->name;
      ++seen;
    }
  }
  EXPECT_GE(seen, 3);
}

TEST(Simulator, OnlyMaskedPixelsChangeBeforeACameraThatStandsStill) {
  WorldOptions options = small("static");
  options.people = 4;
  const SE3 T = look_at(kCameraPlace_m, {2.75, 4.6, 1.1});
  const Simulator simulator(options, [T](double) { return T; });
  const SimulatedFrame a = simulator.render(10);
  const SimulatedFrame b = simulator.render(60);
  int changed = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const bool differ = a.frame.depth_m(x, y) != b.frame.depth_m(x, y);
      changed += differ ? 1 : 0;
      if (a.mask(x, y) == 0 && b.mask(x, y) == 0) {
        ASSERT_FALSE(differ) << x << " " << y;
      }
    }
  }
  EXPECT_GT(changed, 2000);
}

TEST(Simulator, ThingsMoveWhenTheyDo) {
  WorldOptions options = small("static");
  options.people = 3;
  options.frames = 300;
  const Simulator simulator(options);
  std::map<std::string, int> seen;
  std::map<std::string, int> moved;
  for (int i = 0; i < 300; i += 20) {
    for (const SimulatedObject& object : simulator.render(i).objects) {
      const std::string what = object.moved_in_sequence ? object.name : object.class_name;
      ++seen[what];
      if (object.dynamic) ++moved[what];
    }
  }
  EXPECT_GT(moved["carried_cup"], 0);
  EXPECT_GT(moved["pushed_chair"], 0);
  EXPECT_GT(moved["fan"], 5);
  EXPECT_GT(moved["person2"], 0);  // types at the desk
  EXPECT_GT(seen["monitor"], 10);
  EXPECT_GT(seen["keyboard"], 0);
  EXPECT_GT(seen["book"], 10);
  EXPECT_EQ(moved["monitor"], 0);
  EXPECT_EQ(moved["chair"], 0);
}

TEST(Simulator, BusyPeopleHoldMostOfThePicture) {
  WorldOptions options = small("xyz");
  options.busy = true;
  options.frames = 300;
  const Simulator simulator(options);
  double cover = 0;
  double held = 0;
  float nearest_m = 10;
  constexpr int kFrames = 15;
  for (int k = 0; k < kFrames; ++k) {
    const SimulatedFrame frame = simulator.render(20 * k);
    cover += 1.0 - count(frame.mask, 0) / (320.0 * 240.0);
    const std::vector<cv::Point2f> found = corners(frame.frame.grey);
    const auto on_people = std::count_if(found.begin(), found.end(), [&](const cv::Point2f& p) {
      return frame.mask(static_cast<int>(p.x), static_cast<int>(p.y)) != 0;
    });
    held += static_cast<double>(on_people) / static_cast<double>(found.size());
    for (int i = 0; i < 320 * 240; ++i) {
      if (frame.mask.data()[i] != 0) nearest_m = std::min(nearest_m, frame.frame.depth_m.data()[i]);
    }
  }
  EXPECT_GT(cover / kFrames, 0.30);
  EXPECT_LT(cover / kFrames, 0.60);
  EXPECT_GT(held / kFrames, 0.50);
  EXPECT_LT(nearest_m, 1.0F);
}

TEST(Simulator, CoveredLensSeesNothing) {
  WorldOptions options = small("static");
  options.pixel_noise = 0;
  options.covered_from = 2;
  options.covered_frames = 2;
  const Simulator simulator(options);
  for (const int i : {1, 2, 3, 4}) {
    const SimulatedFrame frame = simulator.render(i);
    const bool covered = i == 2 || i == 3;
    const std::size_t pixels = 320 * 240;
    const auto black = std::count(frame.frame.grey.data(), frame.frame.grey.data() + pixels, 0);
    const auto holes =
        std::count(frame.frame.depth_m.data(), frame.frame.depth_m.data() + pixels, 0.0F);
    EXPECT_EQ(static_cast<std::size_t>(black) == pixels, covered);
    EXPECT_EQ(static_cast<std::size_t>(holes) == pixels, covered);
    EXPECT_EQ(frame.objects.empty(), covered);
  }
}

TEST(Simulator, RefusesFramesThatDoNotExist) {
  const Simulator simulator(small("static"));
  EXPECT_EQ(simulator.frame_count(), 120);
  EXPECT_THROW(simulator.render(-1), std::logic_error);
  EXPECT_THROW(simulator.render(120), std::logic_error);
}

TEST(Simulator, RoomsThatLookAlikeDoSo) {
  WorldOptions options = small("static");
  options.rooms = 2;
  options.pixel_noise = 0;
  options.repeated_posters = true;
  options.identical_desks = true;
  // The same desk, in each room from the same side.
  const auto view = [](double time_s) {
    const double x = time_s < 0.01 ? 1.15 : 1.15 + 6.15;
    return look_at({x, 3.2, 1.5}, {x, 4.6, 0.9});
  };
  const Simulator simulator(options, view);
  const SimulatedFrame a = simulator.render(0);
  const SimulatedFrame b = simulator.render(1);
  int close = 0;
  for (int i = 0; i < 320 * 240; ++i) {
    close += std::abs(a.frame.grey.data()[i] - b.frame.grey.data()[i]) < 24 ? 1 : 0;
  }
  EXPECT_GT(close, 0.8 * 320 * 240);
}

}  // namespace
}  // namespace ydd
