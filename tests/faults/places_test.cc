// SPDX-License-Identifier: Apache-2.0
//
// Where results go: full disks, folders that cannot be written to, names that nobody expects,
// others who write to the same place.
#include <sys/mount.h>
#include <unistd.h>

#include "faults.h"

namespace ydd::faults {
namespace {

/// A disk of its own, in memory. Needs root and the right to mount.
class Disk {
 public:
  explicit Disk(const char* size) {
    mounted_ = ::mount("tmpfs", folder_.path().c_str(), "tmpfs", MS_NODEV,
                       fmt::format("size={}", size).c_str()) == 0;
  }
  ~Disk() {
    if (mounted_) ::umount2(folder_.path().c_str(), MNT_DETACH);
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  bool mounted() const { return mounted_; }
  bool make_read_only() const {
    return ::mount("tmpfs", folder_.path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  }
  const fs::path& path() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  bool mounted_ = false;
};

std::string few() { return few_frames().string(); }

TEST(FullDisk, ResultsThatFitAreThereAndOneLineTellsTheRest) {
  SCOPED_TRACE("every file is whole or not there; the failure names what is missing; no debris");
  for (const char* const size : {"16k", "64k", "256k", "400k"}) {
    SCOPED_TRACE(size);
    const Disk disk(size);
    if (!disk.mounted()) GTEST_SKIP() << "cannot mount a small disk here";
    const Outcome outcome =
        shell("ydd run " + few() + " --quiet --out o --save-map o.map", disk.path());
    expect_told(outcome);
    expect_whole_files(disk.path() / "o");
    expect_no_leftovers(disk.path());
    if (fs::exists(disk.path() / "o.map")) expect_good_map(disk.path() / "o.map");
  }
}

TEST(FullDisk, AMapThatWasThereStays) {
  SCOPED_TRACE("a save that runs out of space leaves the map that was there, and the results");
  const Disk disk("1m");
  if (!disk.mounted()) GTEST_SKIP() << "cannot mount a small disk here";
  const TemporaryFolder folder;
  const std::string map = disk.path() / "o.map";
  ASSERT_EQ(
      shell("ydd run " + few() + " --quiet --out o --save-map " + map, folder.path()).exit_code, 0);
  const std::string before = read_file(map).value();
  const Outcome outcome =
      shell("cat /dev/zero >" + (disk.path() / "filler").string() + " 2>/dev/null; ydd run " +
                room().string() + " --quiet --out p --map " + map + " --save-map " + map,
            folder.path());
  expect_told(outcome);
  EXPECT_EQ(read_file(map).value(), before);
  EXPECT_EQ(poses_in(folder / "p"), static_cast<std::size_t>(kFrames));
  expect_whole_files(folder / "p");
}

TEST(FileSizeLimit, IsAsAFullDisk) {
  SCOPED_TRACE("the same where the limit is one of the process (ulimit -f)");
  const TemporaryFolder folder;
  const Outcome outcome =
      shell("trap '' XFSZ; ulimit -f 40; ydd run " + few() + " --quiet --out o --save-map o.map",
            folder.path());
  expect_told(outcome);
  EXPECT_EQ(poses_in(folder / "o"), 6U);
  expect_whole_files(folder / "o");
  expect_no_leftovers(folder.path());
}

TEST(ReadOnlyFolder, IsToldBeforeAnythingIsComputedOrCostsTheMapAlone) {
  SCOPED_TRACE("one line that names the folder; nothing elsewhere is touched");
  const Disk disk("1m");
  if (!disk.mounted()) GTEST_SKIP() << "cannot mount a small disk here";
  ASSERT_TRUE(disk.make_read_only());
  const Outcome out = shell("ydd run " + few() + " --quiet --out o", disk.path());
  expect_told(out);
  const TemporaryFolder folder;
  const Outcome map =
      shell("ydd run " + few() + " --quiet --out o --save-map " + (disk.path() / "o.map").string(),
            folder.path());
  expect_told(map);
  EXPECT_THAT(map.err, HasSubstr("o.map"));
}

TEST(Devices, AreWrittenToAndNeverReplaced) {
  SCOPED_TRACE("/dev/null is a device before and after");
  const TemporaryFolder folder;
  const Outcome run = shell("ydd run " + few() +
                                " --quiet --out o --save-map o.map; "
                                "ydd map export o.map --sparse /dev/null; "
                                "ydd simulate /dev/null --quiet; test -c /dev/null",
                            folder.path());
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST(Names, ThatAreNotUtf8CostNothing) {
  SCOPED_TRACE("a folder whose name is no text gives all results, and JSON that can be read");
  const TemporaryFolder folder;
  const fs::path odd = folder / "caf\xe9\x01 'x\"";
  fs::create_directory(odd);
  fs::copy(few_frames(), odd / "s\xff", fs::copy_options::recursive);
  const Outcome outcome = ydd_slam({"run", (odd / "s\xff").string(), "--out", (odd / "o").string(),
                                    "--quiet", "--save-map", (odd / "m\xfe.map").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(poses_in(odd / "o"), 6U);
  expect_whole_files(odd / "o");
  expect_good_map(odd / "m\xfe.map");
}

TEST(TwoWriters, OfOneMapOneWinsAndTheFileIsWhole) {
  SCOPED_TRACE(
      "the second one gets a message; both have their results; the map is that of one of them");
  const TemporaryFolder folder;
  for (int i = 0; i < rounds(2); ++i) {
    fs::remove(folder / "o.map");
    const std::string run = "ydd run " + room().string() + " --quiet --save-map o.map --out ";
    const Outcome outcome = shell(
        fmt::format("rm -rf a b; {}a 2>ea & x=$!; sleep {:.1f}; {}b 2>eb; echo $? >cb; wait $x; "
                    "echo $? >ca",
                    run, 0.1 * i, run),
        folder.path());
    const std::string codes = read_file(folder / "ca").value() + read_file(folder / "cb").value();
    EXPECT_THAT(codes, testing::AnyOf("0\n1\n", "1\n0\n", "0\n0\n"))
        << read_file(folder / "eb").value();
    expect_good_map(folder / "o.map");
    expect_whole_files(folder / "a");
    expect_whole_files(folder / "b");
  }
}

TEST(Links, ThatSomebodyPlantedAreNotFollowedByTemporaryFiles) {
  SCOPED_TRACE(
      "what a link in the results' folder leads to is not written by way of temporary names");
  const TemporaryFolder folder;
  fs::create_directory(folder / "o");
  std::ofstream(folder / "precious") << "mine";
  for (const char* const name :
       {"trajectory.tum.tmp", "summary.json.tmp", "report.html.tmp", "config.yaml.tmp"}) {
    fs::create_symlink("../precious", folder / "o" / name);
  }
  fs::create_symlink("precious", folder / "o.map.new");
  const Outcome outcome =
      shell("ydd run " + few() + " --quiet --out o --save-map o.map", folder.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_file(folder / "precious").value(), "mine");
}

}  // namespace
}  // namespace ydd::faults
