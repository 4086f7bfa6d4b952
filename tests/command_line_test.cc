// SPDX-License-Identifier: Apache-2.0
//
// What the binary says to input that it cannot use: one line, exit code 1, nothing half done; and
// to a command line that it cannot understand: exit code 2.
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_world.h"

namespace ydd::e2e {
namespace {

using testing::HasSubstr;
using Arguments = std::vector<std::string>;

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

/// A call that must fail: its arguments (the test's folder is given), and what the line must name.
struct Bad {
  std::string name;
  std::function<Arguments(const TemporaryFolder&)> arguments;
  std::vector<std::string> told;
};

/// `run` over good frames with options that are not.
Bad bad_run(std::string name, const Arguments& options, std::vector<std::string> told) {
  return {std::move(name),
          [options](const TemporaryFolder& folder) {
            Arguments all = {"run", few_frames(), "--out", folder / "out"};
            all.insert(all.end(), options.begin(), options.end());
            return all;
          },
          std::move(told)};
}

/// `run` over good frames with a file of this content behind `option`.
Bad bad_file(std::string name, const std::string& option, const std::string& file,
             const std::string& content, std::vector<std::string> told) {
  told.push_back(file);
  return {std::move(name),
          [=](const TemporaryFolder& folder) {
            write(folder / file, content);
            return Arguments{"run", few_frames(), "--out", folder / "out", option, folder / file};
          },
          std::move(told)};
}

/// `run` over a folder that `prepare` makes.
Bad bad_sequence(std::string name, const std::function<void(const fs::path&)>& prepare,
                 std::vector<std::string> told, const Arguments& options = {}) {
  return {std::move(name),
          [=](const TemporaryFolder& folder) {
            prepare(folder / "sequence");
            Arguments all = {"run", folder / "sequence", "--out", folder / "out"};
            all.insert(all.end(), options.begin(), options.end());
            return all;
          },
          std::move(told)};
}

const std::string kFirstBox =
    R"({"timestamp": "1700000000", "detections": [{"cls": "person", "box": [1, 2, 3, 4]}]})";

// NOLINTNEXTLINE(readability-function-size): a table
const std::vector<Bad>& bad_inputs() {
  static const std::vector<Bad> all = {
      bad_sequence("MissingFolder", [](const fs::path&) {}, {"sequence"}),
      bad_sequence("EmptyFolder", [](const fs::path& p) { fs::create_directory(p); }, {"rgb.txt"}),
      bad_sequence("AFileForAFolder", [](const fs::path& p) { write(p, "x"); }, {"sequence"}),
      bad_sequence("NoDepthList",
                   [](const fs::path& p) {
                     copy_of(few_frames(), p);
                     fs::remove(p / "depth.txt");
                   },
                   {"depth.txt"}),
      bad_sequence("NoCamera",
                   [](const fs::path& p) {
                     copy_of(few_frames(), p);
                     fs::remove(p / "camera.yaml");
                   },
                   {"--camera"}),
      bad_sequence("BadLineInTheList",
                   [](const fs::path& p) {
                     copy_of(few_frames(), p);
                     std::ofstream(p / "rgb.txt", std::ios::app) << "yesterday rgb/x.png\n";
                   },
                   {"rgb.txt:"}),
      bad_sequence("NotOneFrameCanBeRead",
                   [](const fs::path& p) {
                     copy_of(few_frames(), p);
                     for (const auto& entry : fs::directory_iterator(p / "rgb")) {
                       fs::resize_file(entry.path(), 10);
                     }
                   },
                   {"not one frame"}),
      bad_run("UnknownCamera", {"--camera", "tum_fr9"}, {"tum_fr9", "tum_fr1"}),
      bad_run("CameraOfAnotherSize", {"--camera", "tum_fr1"}, {""}),
      bad_run("MissingConfig", {"--config", "nowhere.yaml"}, {"nowhere.yaml"}),
      bad_run("SetUnknownKey", {"--set", "orb.level=8"}, {"orb.level", "options"}),
      bad_run("SetOutOfRange", {"--set", "orb.levels=99"}, {"orb.levels", "99", "16"}),
      bad_run("SetWrongType", {"--set", "orb.levels=many"}, {"orb.levels", "many"}),
      bad_run("SetWithoutValue", {"--set", "orb.levels"}, {"key=value"}),
      bad_run("UnknownVariant", {"--dynamic", "some"}, {"some", "full"}),
      bad_run("MissingDetections", {"--detections", "nowhere.jsonl"}, {"nowhere.jsonl"}),
      bad_run("MissingDetector", {"--detector", "nowhere.yaml"}, {"nowhere.yaml"}),
      bad_run("DetectorAndDetections", {"--detector", "a", "--detections", "b"},
              {"one of the two"}),
      bad_run("MissingCatalogue", {"--objects", "nowhere.yaml"}, {"nowhere.yaml"}),
      bad_run("VideoOfAnotherKind", {"--video", "seen.avi"}, {"seen.avi", ".mp4"}),
      bad_run("MissingAssociations", {"--associations", "nowhere.txt"}, {"nowhere.txt"}),
      bad_file("ConfigWithUnknownKey", "--config", "c.yaml", "orb:\n  levles: 8\n",
               {"c.yaml:2", "orb.levles"}),
      bad_file("ConfigOutOfRange", "--config", "c.yaml", "orb:\n\n  levels: 99\n",
               {"c.yaml:3", "orb.levels"}),
      bad_file("ConfigIsNotYaml", "--config", "c.yaml", "orb: [8\n", {"YAML"}),
      bad_file("ConfigIsAList", "--config", "c.yaml", "- orb\n", {}),
      bad_file("CameraWithoutFocalLength", "--camera", "cam.yaml", "width: 320\nheight: 240\n",
               {"fx"}),
      bad_file("EmptyDetections", "--detections", "d.jsonl", "", {}),
      bad_file("BrokenDetections", "--detections", "d.jsonl", kFirstBox + "\n{\"timestamp\":\n",
               {"d.jsonl:2"}),
      bad_file("CatalogueWithUnknownKind", "--objects", "o.yaml", "classes:\n  ghost: [person]\n",
               {"o.yaml:2", "ghost"}),
      {"OutIsBelowAFile",
       [](const TemporaryFolder& folder) {
         write(folder / "file", "x");
         return Arguments{"run", few_frames(), "--out", folder / "file/out"};
       },
       {"file/out"}},
      {"OutIsAFile",
       [](const TemporaryFolder& folder) {
         write(folder / "file", "x");
         return Arguments{"run", few_frames(), "--out", folder / "file"};
       },
       {"file"}},
      {"EvalOfAMissingFile",
       [](const TemporaryFolder&) {
         return Arguments{"eval", few_frames() / "groundtruth.txt", "nowhere.tum"};
       },
       {"nowhere.tum"}},
      {"EvalOfGarbage",
       [](const TemporaryFolder& folder) {
         write(folder / "t.tum", "# t x y z\n1.0 2 3\n");
         return Arguments{"eval", few_frames() / "groundtruth.txt", folder / "t.tum"};
       },
       {"t.tum:2"}},
      {"EvalOfAnotherTime",
       [](const TemporaryFolder& folder) {
         write(folder / "t.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n");
         return Arguments{"eval", few_frames() / "groundtruth.txt", folder / "t.tum"};
       },
       {"t.tum"}},
      {"SimulateIntoAFolderThatIsThere",
       [](const TemporaryFolder& folder) {
         return Arguments{"simulate", folder.path(), "--frames", "1"};
       },
       {"exist"}},
      {"SimulateAnUnknownPath",
       [](const TemporaryFolder& folder) {
         return Arguments{"simulate", folder / "out", "--path", "spiral"};
       },
       {"spiral", "xyz"}},
      {"DetectWithNoDetector",  // the environment says none
       [](const TemporaryFolder& folder) {
         return Arguments{"detect", few_frames(), "--out", folder / "out/d.jsonl"};
       },
       {"--detector FILE"}},
      {"DetectWithAMissingDetector",
       [](const TemporaryFolder& folder) {
         return Arguments{"detect",       few_frames(), "--detector",
                          "nowhere.yaml", "--out",      folder / "out/d.jsonl"};
       },
       {"nowhere.yaml"}},
      {"ReportOfNoRun",
       [](const TemporaryFolder& folder) {
         return Arguments{"report", folder / "nowhere"};
       },
       {"nowhere", "--trajectory"}},
      {"ReportOfANamelessTrajectory",
       [](const TemporaryFolder&) {
         return Arguments{"report", "--trajectory", "peer.tum"};
       },
       {"peer.tum", "NAME=FILE"}},
      {"ReportOfAMissingTrajectory",
       [](const TemporaryFolder&) {
         return Arguments{"report", "--trajectory", "peer=nowhere.tum"};
       },
       {"nowhere.tum"}},
  };
  return all;
}

class BadInput : public testing::TestWithParam<Bad> {};
INSTANTIATE_TEST_SUITE_P(Table, BadInput, testing::ValuesIn(bad_inputs()),
                         [](const auto& test) { return test.param.name; });

TEST_P(BadInput, IsToldInOneLine) {
  const TemporaryFolder folder;
  const Arguments arguments = GetParam().arguments(folder);
  const TemporaryFolder here;
  const Outcome outcome = ydd_slam(arguments, here.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  // Frames that cannot be read are warned about, one by one, before the last is known.
  if (GetParam().name != "NotOneFrameCanBeRead" && GetParam().name != "CameraOfAnotherSize") {
    EXPECT_EQ(outcome.lines_on_err(), 1U) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  for (const std::string& told : GetParam().told) {
    EXPECT_THAT(outcome.error_lines().front(), HasSubstr(told));
  }
  EXPECT_FALSE(fs::exists(folder / "out/trajectory.tum"));
  EXPECT_FALSE(fs::exists(folder / "out/summary.json"));
  EXPECT_TRUE(fs::is_empty(here.path())) << "something was left in the working folder";
}

struct Usage {
  std::string name;
  Arguments arguments;
};

class WrongUsage : public testing::TestWithParam<Usage> {};
INSTANTIATE_TEST_SUITE_P(
    Table, WrongUsage,
    testing::Values(Usage{"Nothing", {}}, Usage{"UnknownCommand", {"walk"}},
                    Usage{"UnknownOption", {"run", "x", "--fast"}}, Usage{"NoSequence", {"run"}},
                    Usage{"TooMany", {"run", "x", "y"}},
                    Usage{"NotANumber", {"run", "x", "--max-frames", "few"}},
                    Usage{"UnknownFormat", {"run", "x", "--trajectory-format", "xyz"}},
                    Usage{"NoValue", {"run", "x", "--out"}}, Usage{"EvalOfOne", {"eval", "x"}},
                    Usage{"OutOfRange", {"simulate", "x", "--jobs", "-1"}},
                    Usage{"ReportOfNothing", {"report"}},
                    Usage{"UnknownLogLevel", {"--log-level", "loud", "options"}},
                    Usage{"NoOutput", {"detect", "x"}}),
    [](const auto& test) { return test.param.name; });

TEST_P(WrongUsage, ExitsWithTwo) {
  const TemporaryFolder here;
  const Outcome outcome = ydd_slam(GetParam().arguments, here.path());
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(outcome.err.empty());
  EXPECT_TRUE(fs::is_empty(here.path()));
}

TEST(CommandLine, HelpAndVersionAreNoFailure) {
  const Outcome help = ydd_slam({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* const command : {"run", "eval", "report", "simulate", "detect", "options"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    const Outcome own = ydd_slam({command, "--help"});
    EXPECT_EQ(own.exit_code, 0);
    EXPECT_GT(own.out.size(), 60U) << command;
  }
  const Outcome version = ydd_slam({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, testing::StartsWith("ydd-slam "));
}

TEST(CommandLine, OldResultsOutliveARunThatFails) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "out");
  write(folder / "out/trajectory.tum", "of yesterday\n");
  const Outcome outcome =
      ydd_slam({"run", few_frames(), "--out", folder / "out", "--set", "orb.levels=99"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(read_file(folder / "out/trajectory.tum").value(), "of yesterday\n");
}

TEST(CommandLine, NothingTemporaryIsLeftWhenAFileCannotBeWritten) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "out/timings.json/in_the_way");
  const Outcome outcome = ydd_slam({"run", few_frames(), "--out", folder / "out", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("timings.json"));
  for (const auto& entry : fs::directory_iterator(folder / "out")) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::EndsWith(".tmp")));
  }
  // One file that cannot be written does not cost the others.
  for (const char* const other : {"trajectory.tum", "frames.json", "summary.json"}) {
    EXPECT_TRUE(fs::exists(folder / "out" / other)) << other;
  }
}

}  // namespace
}  // namespace ydd::e2e
