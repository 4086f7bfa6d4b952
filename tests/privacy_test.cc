// SPDX-License-Identifier: Apache-2.0
//
// Whether people are in what is kept of a run: simulated rooms, where it is known for each pixel
// whether it shows somebody.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_world.h"
#include "ydd/base/temporary_folder_testing.h"
#include "ydd/cloud/keyframe_picture.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/recorded_detections.h"
#include "ydd/image/decode.h"
#include "ydd/map_files/map_file.h"
#include "ydd/simulation/random.h"
#include "ydd/simulation/simulator.h"
#include "ydd/system/slam_system.h"

namespace ydd::e2e {
namespace {

constexpr int kPictures = kSanitized ? 6 : 16;

/// What people do: walk about close to the camera, or (but for one who comes) stand like furniture.
enum class Crowd { walks, stands };
constexpr std::string_view name_of(Crowd crowd) {
  return crowd == Crowd::walks ? "walking" : "standing";
}

WorldOptions world_of(Crowd crowd) {
  WorldOptions options;
  options.seed = 5;
  options.width_px = 320;
  options.height_px = 240;
  options.fps = 6;  // people and camera move far between two of them: each becomes a keyframe
  options.frames = kPictures;
  options.depth = DepthModel::kinect;
  options.busy = crowd == Crowd::walks;
  options.sit_then_leave = crowd == Crowd::stands;  // after the last of these frames
  options.come_and_stay = crowd == Crowd::stands;
  return options;
}

const std::vector<SimulatedFrame>& frames_of(Crowd crowd) {
  static std::map<Crowd, std::vector<SimulatedFrame>> rendered;
  std::vector<SimulatedFrame>& all = rendered[crowd];
  if (!all.empty()) return all;
  const Simulator simulator(world_of(crowd));
  for (int i = 0; i < kPictures; ++i) all.push_back(simulator.render(i));
  return all;
}

std::set<int> people_of(const SimulatedFrame& frame) {
  std::set<int> ids;
  for (const SimulatedObject& object : frame.objects) {
    if (object.class_name == "person") ids.insert(object.id);
  }
  return ids;
}

enum class Boxes { exact, loose };

/// `loose`: each side off by up to 4 % of the box or 3 px, as those of networks are.
Detections boxes_of(const SimulatedFrame& frame, Boxes boxes, sim::Random& random) {
  Detections out;
  for (const SimulatedObject& object : frame.objects) {
    Box box = object.box;
    if (boxes == Boxes::loose) {
      for (auto* const side : {&box.x0, &box.y0, &box.x1, &box.y1}) {
        const float most_px = std::max(3.0F, 0.04F * std::max(box.width(), box.height()));
        *side += most_px * static_cast<float>(random.uniform(-1.0, 1.0));
      }
      box = intersection(box, {0, 0, static_cast<float>(frame.frame.colour.width()),
                               static_cast<float>(frame.frame.colour.height())});
    }
    out.push_back({object.class_name, 1.0F, box});
  }
  return out;
}

/// How many pixels of people there were to see in the frames of keyframes, and how many are kept.
struct Kept {
  int keyframes = 0, noted = 0, of_people = 0, depth = 0, colour = 0, all = 0;
};

/// A pixel of a small picture shows somebody if one of the four behind it does.
bool shows_somebody(const SimulatedFrame& frame, const std::set<int>& people, int x, int y) {
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
    if (people.contains(frame.mask(2 * x + dx, 2 * y + dy))) return true;
  }
  return false;
}

Kept kept_of(const Atlas& atlas, Crowd crowd) {
  Kept kept;
  atlas.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    const SimulatedFrame& frame =
        frames_of(crowd).at(static_cast<std::size_t>(keyframe.frame_index));
    const std::set<int> people = people_of(frame);
    const OpenPicture picture = open_keyframe_picture(*keyframe.picture).value();
    kept.noted += people_left_out(*keyframe.picture) ? 1 : 0;
    ++kept.keyframes;
    for (int y = 0; y < picture.depth_mm.height(); ++y) {
      for (int x = 0; x < picture.depth_mm.width(); ++x) {
        kept.all += picture.depth_mm(x, y) > 0 ? 1 : 0;
        if (!shows_somebody(frame, people, x, y)) continue;
        ++kept.of_people;
        kept.depth += picture.depth_mm(x, y) > 0 ? 1 : 0;
        // Grey, but for what JPEG makes of its surroundings.
        const Bgr c = picture.colour(x, y);
        kept.colour += std::ranges::any_of(c, [](int v) { return std::abs(v - 128) > 40; }) ? 1 : 0;
      }
    }
  });
  return kept;
}

/// What is in a map file after a run over all frames; `detector` null: with the boxes.
Kept kept_after(Crowd crowd, Variant variant, Boxes boxes, std::unique_ptr<Detector> detector,
                const std::vector<std::string>& set = {}) {
  std::vector<std::string> assignments = {"deterministic=true"};
  assignments.insert(assignments.end(), set.begin(), set.end());
  SystemOptions options = system_options(assignments).value();
  options.dynamics.variant = variant;
  const bool looks = detector != nullptr;
  SlamSystem system(simulated_camera(world_of(crowd)), options, ObjectCatalogue::defaults(),
                    std::move(detector));
  sim::Random random(3);
  for (const SimulatedFrame& frame : frames_of(crowd)) {
    std::optional<Detections> given;
    if (!looks) given = boxes_of(frame, boxes, random);
    EXPECT_TRUE(system.process(frame.frame, std::move(given)).ok());
  }
  EXPECT_TRUE(system.finish().ok());
  const TemporaryFolder folder;
  EXPECT_TRUE(system.save_map(folder.path() / "crowd.map").ok());
  return kept_of(load_map(folder.path() / "crowd.map").value(), crowd);
}

class PeopleInMaps : public testing::TestWithParam<std::tuple<Crowd, Variant, Boxes>> {};

TEST_P(PeopleInMaps, NoPixelOfAPersonIsInAMapFile) {
  const auto [crowd, variant, boxes] = GetParam();
  const Kept kept = kept_after(crowd, variant, boxes, nullptr);
  RecordProperty("keyframes", kept.keyframes);
  RecordProperty("pixels_of_people", kept.of_people);
  RecordProperty("pixels_kept", kept.all);
  EXPECT_GE(kept.keyframes, 3);
  EXPECT_GT(kept.of_people, 300 * kept.keyframes) << "the test would not notice people";
  EXPECT_GT(kept.all, 1000 * kept.keyframes) << "nothing of the room is left";
  EXPECT_EQ(kept.noted, kept.keyframes);
  EXPECT_EQ(kept.depth, 0);
  EXPECT_EQ(kept.colour, 0);
}

INSTANTIATE_TEST_SUITE_P(Crowds, PeopleInMaps,
                         testing::Values(std::tuple(Crowd::walks, Variant::full, Boxes::exact),
                                         std::tuple(Crowd::walks, Variant::evidence, Boxes::loose),
                                         std::tuple(Crowd::stands, Variant::full, Boxes::loose),
                                         std::tuple(Crowd::stands, Variant::evidence,
                                                    Boxes::exact)));

constexpr const char* kHex = "5ec2e7000000000000000000000000000000000000000000000000005ec2e7ff";

/// A file with a key, for its owner alone.
fs::path key_file(const fs::path& file, const std::string& key) {
  EXPECT_TRUE(write_file_atomically(file, key + "\n").ok());
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  return file;
}

bool encrypts() { return why_no_encryption().empty(); }

/// Whether anything of the key is in the text: its digits, in either case, or its bytes.
bool tells_the_key(std::string text) {
  const std::string bytes("\x5e\xc2\xe7\0\0\0\0\0", 8);
  if (text.find(bytes) != std::string::npos) return true;
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text.find("5ec2e7") != std::string::npos;
}

TEST(MapKeys, AreTakenByEveryCommandAndAppearNowhere) {
  if (!encrypts()) GTEST_SKIP() << why_no_encryption();
  const TemporaryFolder folder;
  const fs::path keys = folder.path() / "keys";  // all else in the folder is looked through
  fs::create_directories(keys);
  const std::string key = key_file(keys / "a", kHex), other = key_file(keys / "b", "a phrase");
  const std::string map = folder / "a.map", plain = folder / "plain.map";
  std::string said;
  const auto call = [&](std::vector<std::string> arguments, int exit_code = 0) {
    arguments.insert(arguments.end(), {"--log-level", "debug"});
    const Outcome outcome = ydd_slam(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << arguments[1] << ": " << outcome.err;
    EXPECT_EQ(outcome.error_lines().size(), exit_code == 0 ? 0U : 1U) << outcome.err;
    said += outcome.out + outcome.err;
    return outcome;
  };
  call({"run", few_frames(), "--out", folder / "out", "--save-map", map, "--map-key", key, "--set",
        "map.autosave_s=0.01"});
  EXPECT_EQ(read_file(map)->find("SQLite format 3"), std::string::npos);
  call({"run", few_frames(), "--out", folder / "out2", "--map", map, "--save-map", map, "--map-key",
        key});
  call({"map", "info", map, "--map-key", key});
  call({"map", "check", map, "--map-key", key});
  call({"map", "export", map, "--map-key", key, "--dense", folder / "d.ply"});
  call({"map", "merge", map, map, "--out", folder / "m.map", "--map-key", key, "--set",
        "loop.enabled=false"});
  call({"map", "prune", folder / "m.map", "--out", folder / "p.map", "--map-key", key});
  call({"map", "split", folder / "m.map", "--which", "0", "--out", folder / "s.map", "--map-key",
        key});
  call({"map", "decrypt", map, "--out", plain, "--map-key", key});
  call({"map", "info", plain});
  call({"map", "encrypt", plain, "--map-key", other});
  call({"map", "encrypt", plain, "--map-key", key, "--old-key", other});
  call({"map", "check", plain, "--map-key", key});
  // What goes wrong, in one line.
  EXPECT_THAT(call({"map", "info", map}, 1).err, testing::HasSubstr("--map-key FILE"));
  EXPECT_THAT(call({"map", "info", map, "--map-key", other}, 1).err,
              testing::HasSubstr("does not open with this key"));
  EXPECT_THAT(call({"map", "info", map, "--map-key", folder / "none"}, 1).err,
              testing::HasSubstr("none: "));
  fs::permissions(keys / "a", fs::perms::others_read, fs::perm_options::add);
  EXPECT_THAT(call({"map", "info", map, "--map-key", key}, 1).err, testing::HasSubstr("chmod 600"));
  EXPECT_THAT(call({"run", few_frames(), "--out", folder / "no", "--save-map", folder / "no.map",
                    "--map-key", key},
                   1)
                  .err,
              testing::HasSubstr("chmod 600"));
  EXPECT_FALSE(fs::exists(folder / "no")) << "a run that cannot save does not begin";
  EXPECT_FALSE(tells_the_key(said));
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (!entry.is_regular_file() || entry.path().parent_path() == keys) continue;
    EXPECT_FALSE(tells_the_key(*read_file(entry.path()))) << entry.path();
  }
}

TEST(MapKeys, ComeFromTheEnvironmentToo) {
  if (!encrypts()) GTEST_SKIP() << why_no_encryption();
  const TemporaryFolder folder;
  const std::string key = key_file(folder.path() / "key", kHex);
  ASSERT_EQ(::setenv("YDD_MAP_KEY_FILE", key.c_str(), 1), 0);
  const Outcome saved = ydd_slam({"run", few_frames(), "--out", folder / "out", "--save-map",
                                  folder / "a.map", "--max-frames", "2"});
  const Outcome told = ydd_slam({"map", "info", folder / "a.map"});
  ASSERT_EQ(::unsetenv("YDD_MAP_KEY_FILE"), 0);
  EXPECT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(ydd_slam({"map", "info", folder / "a.map"}).exit_code, 1);
}

/// Of the pixels in the boxes of people, the share that is as the camera gave it.
double share_of_people_shown(const fs::path& picture, const fs::path& sequence,
                             const RecordedFrame& frame) {
  const ColourImage drawn = load_colour(picture).value();
  const ColourImage taken = load_colour(sequence / frame.file).value();
  int same = 0;
  int count = 0;
  for (const RecordedDetection& recorded : frame.detections) {
    const Box& box = recorded.detection.box;
    if (recorded.detection.class_name != "person") continue;
    for (int y = static_cast<int>(box.y0); y < static_cast<int>(box.y1); ++y) {
      for (int x = static_cast<int>(box.x0); x < static_cast<int>(box.x1); ++x) {
        const Bgr a = drawn(x, y);
        const Bgr b = taken(x, y);
        same += a == b && a != Bgr{} ? 1 : 0;
        ++count;
      }
    }
  }
  return count > 0 ? static_cast<double>(same) / count : 0;
}

TEST(RedactedRuns, ShowNobody) {
  const TemporaryFolder folder;
  const std::string boxes = busy_room() / "detections.jsonl";
  const DetectionRecording recorded = DetectionRecording::read(boxes).value();
  const auto shown = [&](const std::string& name, std::vector<std::string> options) {
    options.insert(options.begin(),
                   {"run", busy_room(), "--max-frames", "2", "--deterministic", "--detections",
                    boxes, "--out", folder / name, "--frames", folder / name / "frames"});
    const Outcome outcome = ydd_slam(options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return share_of_people_shown(folder / name / "frames" / "000000.png", busy_room(),
                                 recorded.frames().at(0));
  };
  EXPECT_GT(shown("shown", {}), 0.2);
  EXPECT_LT(shown("redacted", {"--redact"}), 0.001) << "of what is drawn over it";
  const Outcome blind =
      ydd_slam({"run", busy_room(), "--redact", "--detector", "none", "--out", folder / "blind"});
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_THAT(blind.err, testing::HasSubstr("--redact"));
  EXPECT_EQ(ydd_slam({"run", busy_room(), "--redact", "--record", folder / "r.mcap"}).exit_code, 2);
}

// What a detector leaves: YDD_PRIVACY_DETECTOR=configs/detector/ydd.yaml (docs/privacy.md).
TEST(PeopleInMapsByNetwork, IsMeasured) {
  const char* const file = std::getenv("YDD_PRIVACY_DETECTOR");
  if (file == nullptr) GTEST_SKIP() << "YDD_PRIVACY_DETECTOR names no detector";
  for (const Crowd crowd : {Crowd::walks, Crowd::stands}) {
    for (const Variant variant : {Variant::full, Variant::evidence}) {
      for (const char* const behind : {"false", "true"}) {
        const std::string set = std::string("map.behind_people=") + behind;
        auto detector = make_detector(file, {}, ObjectCatalogue::defaults());
        ASSERT_TRUE(detector.ok()) << detector.error().message;
        const Kept kept = kept_after(crowd, variant, Boxes::exact, *std::move(detector), {set});
        fmt::print(
            "{} {} {}: {} keyframes, {} pixels show people, depth of {} and colour of {} "
            "kept; {} pixels in all\n",
            name_of(crowd), choices_of(variant)[static_cast<std::size_t>(variant)], set,
            kept.keyframes, kept.of_people, kept.depth, kept.colour, kept.all);
      }
    }
  }
}

}  // namespace
}  // namespace ydd::e2e
