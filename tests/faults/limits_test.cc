// SPDX-License-Identifier: Apache-2.0
//
// Too little of everything that a system can give, and surroundings that are not as at home.
#include "faults.h"

namespace ydd::faults {
namespace {

std::string few() { return few_frames().string(); }

/// The run succeeded with everything there, or failed with one line and nothing half done.
void expect_all_or_told(const Outcome& outcome, const fs::path& folder) {
  if (outcome.exit_code == 0) {
    EXPECT_EQ(poses_in(folder / "o"), 6U);
  } else {
    expect_told(outcome);
  }
  expect_whole_files(folder / "o");
}

class OpenFiles : public testing::TestWithParam<int> {};

TEST_P(OpenFiles, FewAreEnoughOrTold) {
  SCOPED_TRACE("descriptors run out: one line, no crash, no half-written file");
  const TemporaryFolder folder;
  // Whoever started the test may have left some open, and then not even the loader has one.
  expect_all_or_told(shell(fmt::format("exec 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-\n"
                                       "ulimit -n {}; ydd run {} --quiet --out o --save-map o.map",
                                       GetParam(), few()),
                           folder.path()),
                     folder.path());
}

INSTANTIATE_TEST_SUITE_P(Limits, OpenFiles, testing::Values(6, 8, 10, 12, 16, 24, 64),
                         [](const auto& tried) { return fmt::format("{}", tried.param); });

class Memory : public testing::TestWithParam<int> {};

TEST_P(Memory, LittleIsEnoughOrTold) {
  if (kSanitized) GTEST_SKIP() << "sanitizers reserve terabytes of addresses";
  SCOPED_TRACE("address space runs out: one line, never an abort; what was done is written");
  const TemporaryFolder folder;
  expect_all_or_told(shell(fmt::format("ulimit -c 0; ulimit -v {}; ydd run {} --quiet --out o",
                                       GetParam() * 1024, few()),
                           folder.path()),
                     folder.path());
}

INSTANTIATE_TEST_SUITE_P(Limits_MiB, Memory, testing::Values(300, 400, 500, 700, 1000, 2000),
                         [](const auto& tried) { return fmt::format("{}", tried.param); });

TEST(Threads, ThatCannotBeStartedAreToldAndNotWaitedFor) {
  if (kSanitized) GTEST_SKIP() << "sanitizers reserve terabytes of addresses";
  SCOPED_TRACE("no second thread to be had: one line or a run without, never a hang");
  const TemporaryFolder folder;
  // A limit on processes does not hold for root; stacks that do not fit do for everybody.
  for (const char* const stack_KiB : {"2097152", "33554432"}) {
    SCOPED_TRACE(stack_KiB);
    fs::remove_all(folder / "o");
    expect_all_or_told(
        shell(
            fmt::format("ulimit -c 0; ulimit -v 6291456; ulimit -s {}; ydd run {} --quiet --out o",
                        stack_KiB, few()),
            folder.path()),
        folder.path());
  }
}

TEST(Cores, OneIsEnoughToKeepTracking) {
  if (kSanitized) GTEST_SKIP() << "sanitized programs do not keep a camera's pace";
  SCOPED_TRACE(
      "--realtime on one core that others use too: frames are dropped, the camera is not lost");
  const TemporaryFolder folder;
  const Outcome outcome = shell(
      "(taskset -c 0 timeout 60 sh -c 'while :; do :; done') & x=$!\n"
      "timeout 60 taskset -c 0 " YDD_BINARY " run " +
          room().string() + " --realtime --quiet --out o; r=$?; kill $x; exit $r",
      folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const json summary = json_of(folder / "o/summary.json");
  EXPECT_GE(summary.value("frames_tracked", 0), 5);
  EXPECT_GT(summary.value("frames_tracked", 0), summary.value("frames_processed", 0) / 2);
}

struct Surroundings {
  const char* name;
  const char* settings;
};

class Elsewhere : public testing::TestWithParam<Surroundings> {};

TEST_P(Elsewhere, ResultsAreTheSame) {
  SCOPED_TRACE("numbers have points, files go where they belong, whatever the surroundings");
  const TemporaryFolder folder;
  const Outcome outcome =
      shell(fmt::format("timeout -s KILL {} env {} " YDD_BINARY
                        " run {} --deterministic --quiet --out o --save-map o.map",
                        kPatience_s, GetParam().settings, few()),
            folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Outcome plain =
      shell("ydd run " + few() + " --deterministic --quiet --out p", folder.path());
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  for (const char* const file : {"trajectory.tum", "keyframes.tum", "config.yaml"}) {
    EXPECT_EQ(read_file(folder / "o" / file).value(), read_file(folder / "p" / file).value());
  }
  expect_whole_files(folder / "o");
  expect_good_map(folder / "o.map");
}

INSTANTIATE_TEST_SUITE_P(
    Surroundings, Elsewhere,
    testing::Values(Surroundings{"GermanNumbers", "LC_ALL=de_DE.UTF-8"},
                    Surroundings{"TurkishLetters", "LC_ALL=tr_TR.UTF-8"},
                    Surroundings{"UnknownLocale", "LC_ALL=xx_YY LANG=nonsense"},
                    Surroundings{"NoHome", "-u HOME"}, Surroundings{"HomeIsGone", "HOME=/nowhere"},
                    Surroundings{"NoTemporaryFolder", "TMPDIR=/nowhere TMP=/nowhere"},
                    Surroundings{"NothingAtAll", "-i YDD_DETECTOR=none"}),
    [](const auto& tried) { return tried.param.name; });

}  // namespace
}  // namespace ydd::faults
