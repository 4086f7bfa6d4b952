// SPDX-License-Identifier: Apache-2.0
//
// Recordings with something wrong in their middle. In every one the frames outside of the fault
// must be where they would have been, and the run must say what it could not use.
#include <cmath>

#include "faults.h"
#include "ydd/evaluation/ate.h"
#include "ydd/image/decode.h"

namespace ydd::faults {
namespace {

constexpr int kFrom = kFrames / 2, kTo = kFrom + kFrames / 6;  // half of a second at most

/// A copy of the room whose lists can be changed.
class Recording {
 public:
  Recording() : path_(copy_of(room(), folder_ / "room")) {
    colour_ = lines_of("rgb.txt");
    depth_ = lines_of("depth.txt");
  }

  struct Line {
    std::string stamp, file;
  };
  std::vector<Line>& colour() { return colour_; }
  std::vector<Line>& depth() { return depth_; }

  fs::path picture(const Line& line) const { return path_ / line.file; }

  Outcome run(const std::string& options = "") const {
    write("rgb.txt", colour_);
    write("depth.txt", depth_);
    return shell("ydd run room --deterministic --out o " + options, folder_.path());
  }
  fs::path out() const { return folder_ / "o"; }

  /// Distance of the tracked frames outside of the fault from where they were, after an alignment
  /// to those; NaN (and a failure) when there are too few.
  double error_outside_m() const {
    const StampedPoses truth = read_tum_trajectory(path_ / "groundtruth.txt").value();
    const auto estimate = read_tum_trajectory(out() / "trajectory.tum");
    if (!estimate) {
      ADD_FAILURE() << estimate.error().message;
      return std::nan("");
    }
    StampedPoses outside;
    for (const StampedPose& pose : *estimate) {
      const bool inside = pose.stamp >= truth.at(kFrom).stamp && pose.stamp < truth.at(kTo).stamp;
      if (!inside) outside.push_back(pose);
    }
    EXPECT_GE(outside.size(), static_cast<std::size_t>(kFrames - (kTo - kFrom) - 2));
    const auto ate = absolute_trajectory_error(truth, outside);
    if (!ate) ADD_FAILURE() << ate.error().message;
    return ate ? ate->statistics_m.max : std::nan("");
  }

 private:
  std::vector<Line> lines_of(const std::string& name) const {
    std::ifstream in(path_ / name);
    std::vector<Line> lines;
    for (std::string text; std::getline(in, text);) {
      if (text.empty() || text.front() == '#') continue;
      const std::size_t blank = text.find(' ');
      lines.push_back({text.substr(0, blank), text.substr(blank + 1)});
    }
    return lines;
  }
  void write(const std::string& name, const std::vector<Line>& lines) const {
    std::ofstream out(path_ / name);
    for (const Line& line : lines) out << line.stamp << " " << line.file << "\n";
  }

  TemporaryFolder folder_;
  fs::path path_;
  std::vector<Line> colour_, depth_;
};

void blacken(const fs::path& picture) {
  const ColourImage image = load_colour(picture).value();
  const std::size_t pixels = static_cast<std::size_t>(image.width()) * image.height();
  ASSERT_TRUE(write_png(picture, ColourImage(image.width(), image.height(),
                                             std::vector<Bgr>(pixels, Bgr{0, 0, 0})))
                  .ok());
}

void remove_readings(const fs::path& picture) {
  const RawDepthImage image = load_raw_depth(picture).value();
  const std::size_t pixels = static_cast<std::size_t>(image.width()) * image.height();
  ASSERT_TRUE(write_png(picture, RawDepthImage(image.width(), image.height(),
                                               std::vector<std::uint16_t>(pixels, 0)))
                  .ok());
}

struct Fault {
  const char* name;
  const char* what;
  void (*make)(Recording&);
};

class ShortFault : public testing::TestWithParam<Fault> {};

TEST_P(ShortFault, LeavesTheRestInItsPlace) {
  SCOPED_TRACE(GetParam().what);
  Recording recording;
  GetParam().make(recording);
  const Outcome outcome = recording.run("--quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_whole_files(recording.out());
  if (kSanitized) return;  // too few frames to judge accuracy
  const double error_m = recording.error_outside_m();
  RecordProperty("error_mm", static_cast<int>(1e3 * error_m));
  EXPECT_LT(error_m, 0.03);
}

const Fault kFaults[] = {
    {"Black", "the lens is covered for a moment",
     [](Recording& r) {
       for (int i = kFrom; i < kTo; ++i) blacken(r.picture(r.colour().at(i)));
     }},
    {"DepthGone", "the depth camera gives nothing for a moment",
     [](Recording& r) {
       for (int i = kFrom; i < kTo; ++i) remove_readings(r.picture(r.depth().at(i)));
     }},
    {"Frozen", "both cameras give the last picture again and again",
     [](Recording& r) {
       for (int i = kFrom; i < kTo; ++i) {
         r.colour().at(i).file = r.colour().at(kFrom).file;
         r.depth().at(i).file = r.depth().at(kFrom).file;
       }
     }},
    {"DepthFrozen", "only depth stands still",
     [](Recording& r) {
       for (int i = kFrom; i < kTo; ++i) r.depth().at(i).file = r.depth().at(kFrom).file;
     }},
    {"Exchanged", "neighbouring pictures have changed places",
     [](Recording& r) {
       for (int i = kFrom; i + 1 < kTo; i += 2) {
         std::swap(r.colour().at(i).file, r.colour().at(i + 1).file);
         std::swap(r.depth().at(i).file, r.depth().at(i + 1).file);
       }
     }},
    {"Missing", "pictures that the lists name are not there",
     [](Recording& r) {
       for (int i = kFrom; i < kTo; ++i) fs::remove(r.picture(r.colour().at(i)));
     }},
    {"Left_out", "pictures are not in the lists at all",
     [](Recording& r) { r.colour().erase(r.colour().begin() + kFrom, r.colour().begin() + kTo); }},
};

INSTANTIATE_TEST_SUITE_P(Frames, ShortFault, testing::ValuesIn(kFaults),
                         [](const auto& tried) { return tried.param.name; });

TEST(Lists, ThatAreOutOfOrderOrRepeatStampsAreSortedOrRefusedByLine) {
  SCOPED_TRACE("a list that is not in the order of time is read right, or refused with its line");
  for (const bool repeated : {false, true}) {
    Recording r;
    if (repeated) {
      r.colour().at(kFrom).stamp = r.colour().at(kFrom - 1).stamp;
    } else {
      std::swap(r.colour().at(kFrom), r.colour().at(kFrom - 1));
    }
    const Outcome outcome = r.run("--quiet");
    if (outcome.exit_code == 0) {
      EXPECT_LT(kSanitized ? 0.0 : r.error_outside_m(), 0.03);
    } else {
      expect_told(outcome);
      EXPECT_THAT(outcome.err, HasSubstr("rgb.txt:"));
    }
  }
}

TEST(Clocks, ThatJumpForwardsAreNotSleptThrough) {
  SCOPED_TRACE("--realtime meets a gap of a day: it is named, and the run goes on");
  Recording r;
  for (auto* const list : {&r.colour(), &r.depth()}) {
    for (std::size_t i = kFrom; i < list->size(); ++i) {
      list->at(i).stamp = fmt::format("{:.6f}", std::stod(list->at(i).stamp) + 86'400.0);
    }
  }
  const Outcome outcome = r.run("--realtime");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out + outcome.err, HasSubstr("864"));
  EXPECT_GT(poses_in(r.out()), static_cast<std::size_t>(kFrom));
}

TEST(Clocks, OfDepthThatAreLateLeaveWhatHasAPartner) {
  SCOPED_TRACE(
      "depth stamps 50 ms late: pairs that are close enough are tracked, the files are whole, and "
      "a "
      "line says what is left out and which offset would fit");
  Recording r;
  for (auto& line : r.depth()) line.stamp = fmt::format("{:.6f}", std::stod(line.stamp) + 0.05);
  const Outcome outcome = r.run("--quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GE(poses_in(r.out()), static_cast<std::size_t>(kFrames / 2));
  expect_whole_files(r.out());
  EXPECT_THAT(outcome.err, HasSubstr("--depth-offset=-0.05"));
}

TEST(Clocks, ThatShareNoTimeAreToldInOneLine) {
  SCOPED_TRACE("depth stamps of another day: no pair, one line that says so, nothing written");
  Recording r;
  for (auto& line : r.depth()) line.stamp = fmt::format("{:.6f}", std::stod(line.stamp) + 86'400);
  const Outcome outcome = r.run("--quiet");
  expect_told(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("depth"));
  EXPECT_FALSE(fs::exists(r.out() / "trajectory.tum"));
}

TEST(Depth, ThatIsNeverThereIsAFailureWithItsReason) {
  SCOPED_TRACE("no frame can be tracked: exit 1 with the reason, and no map is left");
  Recording r;
  for (const auto& line : r.depth()) remove_readings(r.picture(line));
  const Outcome outcome = r.run("--quiet --save-map o.map");
  expect_told(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("depth"));
  EXPECT_FALSE(fs::exists(r.out().parent_path() / "o.map"));
}

}  // namespace
}  // namespace ydd::faults
