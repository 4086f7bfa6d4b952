// SPDX-License-Identifier: Apache-2.0
//
// Runs that are ended from outside: by signals, by kill -9, by whoever reads their output going
// away.
#include <csignal>
#include <random>

#include "faults.h"

namespace ydd::faults {
namespace {

/// A run of the room at its pace in the background, and what happens to it after so long. Waits
/// for the first frame: a signal that comes while the program loads ends it as it ends any.
Outcome run_and(const std::string& what, const fs::path& folder, const std::string& options) {
  return shell(fmt::format(R"(rm -rf o err
# A shell's background jobs ignore SIGINT.
timeout -s KILL {} env --default-signal=INT sh -c 'echo $$ >pid; exec {} run {} --realtime --out o {}' >out 2>err &
while ! grep -q "map started" err 2>/dev/null && kill -0 $! 2>/dev/null; do sleep 0.02; done
p=$(cat pid)
{}
wait $!)",
                           kPatience_s, YDD_BINARY, room().string(), options, what),
               folder);
}

TEST(Signals, AtAnyMomentLeaveWhatWasDone) {
  SCOPED_TRACE("what was tracked until then is written whole, and the exit code names the signal");
  const TemporaryFolder folder;
  std::mt19937 random(1);
  constexpr std::pair<const char*, int> kSignals[] = {{"INT", 2}, {"TERM", 15}, {"HUP", 1}};
  int early = 0;
  for (int i = 0; i < rounds(3); ++i) {
    const auto [name, number] = kSignals[static_cast<std::size_t>(i) % std::size(kSignals)];
    const double wait_s = std::uniform_real_distribution<double>(0.0, 2.2)(random);
    SCOPED_TRACE(fmt::format("round {}: {} after {:.3f} s", i, name, wait_s));
    const Outcome outcome =
        run_and(fmt::format("sleep {:.3f}; kill -{} $p 2>/dev/null", wait_s, name), folder.path(),
                "--save-map o.map --replace-map");
    EXPECT_THAT(outcome.exit_code, testing::AnyOf(0, 128 + number));
    expect_whole_files(folder / "o");
    expect_no_leftovers(folder.path());
    EXPECT_GT(poses_in(folder / "o"), 0U);
    EXPECT_EQ(json_of(folder / "o/summary.json").value("complete", true), outcome.exit_code == 0);
    expect_good_map(folder / "o.map");
    early += outcome.exit_code == 0 ? 0 : 1;
  }
  EXPECT_GT(early, 0) << "no signal came in time";
}

TEST(Signals, ASecondOneEndsAtOnceAndBreaksNothing) {
  SCOPED_TRACE(
      "no half-written file, whatever was being written; a map that was there is still one");
  const TemporaryFolder folder;
  ASSERT_EQ(shell(fmt::format("ydd run {} --out first --quiet --save-map o.map", room().string()),
                  folder.path())
                .exit_code,
            0);
  for (int i = 0; i < rounds(2); ++i) {
    const Outcome outcome = run_and(
        fmt::format("sleep {}; kill -TERM $p; sleep 0.3; kill -TERM $p 2>/dev/null", 0.2 + 0.1 * i),
        folder.path(), "--map o.map --save-map o.map");
    EXPECT_THAT(outcome.exit_code, testing::AnyOf(0, 128 + SIGTERM));
    expect_whole_files(folder / "o");
    expect_good_map(folder / "o.map");
  }
}

TEST(Kill, AtAnyMomentLeavesAMapThatCanBeGoneOnWith) {
  SCOPED_TRACE("kill -9, also while the map is being saved: the file holds one complete save");
  const TemporaryFolder folder;
  ASSERT_EQ(shell(fmt::format("ydd run {} --out first --quiet --save-map o.map", room().string()),
                  folder.path())
                .exit_code,
            0);
  std::mt19937 random(2);
  for (int i = 0; i < rounds(3); ++i) {
    const double wait_s = std::uniform_real_distribution<double>(0.0, 2.2)(random);
    SCOPED_TRACE(fmt::format("round {}: after {:.3f} s", i, wait_s));
    run_and(fmt::format("sleep {:.3f}; kill -KILL $p 2>/dev/null", wait_s), folder.path(),
            "--map o.map --save-map o.map --set map.autosave_s=0.001");
    expect_good_map(folder / "o.map");
  }
  // A killed program cannot tidy up; the next one goes on all the same.
  const Outcome next = shell(
      fmt::format("ydd run {} --map o.map --save-map o.map --out last --quiet", room().string()),
      folder.path());
  EXPECT_EQ(next.exit_code, 0) << next.err;
  EXPECT_EQ(poses_in(folder / "last"), static_cast<std::size_t>(kFrames));
}

TEST(Pipes, ThatBreakCostNoResults) {
  SCOPED_TRACE("whoever reads standard output or error goes away: the run goes on and is written");
  const TemporaryFolder folder;
  for (const char* const where : {"2>err | true", "2>&1 >out | true", "--json 2>err | head -c 1"}) {
    SCOPED_TRACE(where);
    shell(fmt::format("rm -rf o; ydd run {} --out o {}", few_frames().string(), where),
          folder.path());
    EXPECT_EQ(poses_in(folder / "o"), 6U);
    expect_whole_files(folder / "o");
  }
}

TEST(Pipes, ThatAreFullOrClosedAreAFailureThatTells) {
  SCOPED_TRACE("a summary that nobody got is a failure; the files are there all the same");
  const TemporaryFolder folder;
  const Outcome full = shell(
      fmt::format("ydd run {} --out o --json >/dev/full", few_frames().string()), folder.path());
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(poses_in(folder / "o"), 6U);
  const Outcome closed =
      shell(fmt::format("ydd run {} --out p --save-map p.map <&- >&- 2>&-", few_frames().string()),
            folder.path());
  EXPECT_EQ(poses_in(folder / "p"), 6U);
  expect_whole_files(folder / "p");
  expect_good_map(folder / "p.map");
}

TEST(Pipes, AsInputAreRefusedAndNotWaitedFor) {
  SCOPED_TRACE("a FIFO where a file is expected is one line, never a hang");
  const TemporaryFolder folder;
  for (const char* const use :
       {"run S --camera fifo", "run S --config fifo", "run S --detections fifo", "run S --map fifo",
        "run S --objects fifo", "eval fifo fifo", "map info fifo", "run S --associations fifo"}) {
    std::string command = use;
    if (const std::size_t at = command.find(" S "); at != std::string::npos) {
      command.replace(at, 3, " " + few_frames().string() + " --out o ");
    }
    SCOPED_TRACE(command);
    expect_told(shell("test -p fifo || mkfifo fifo; ydd " + command, folder.path()));
  }
}

}  // namespace
}  // namespace ydd::faults
