// SPDX-License-Identifier: Apache-2.0
//
// The window of `run --view`, on a virtual screen with OpenGL in software.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "small_world.h"
#include "ydd/image/decode.h"
#include "ydd/viewer/map_scene.h"
#include "ydd/viewer/window_layout.h"

namespace ydd::e2e {
namespace {

using testing::HasSubstr;

bool on_path(const std::string& program) {
  return run_program({"sh", "-c", "command -v " + program}, ".").exit_code == 0;
}

bool built_with_window() {
  const Outcome outcome = ydd_slam({"run", "no-such-folder", "--view"});
  return outcome.err.find("built without its window") == std::string::npos;
}

// Software GL draws in threads that ThreadSanitizer cannot see into.
#ifdef __SANITIZE_THREAD__
constexpr bool kThreadsWatched = true;
#else
constexpr bool kThreadsWatched = false;
#endif

/// Skips a test that needs a screen. (GTEST_SKIP returns from the function that it is in.)
#define REQUIRE_A_SCREEN()                                                  \
  if (kThreadsWatched) GTEST_SKIP() << "the GL driver is not instrumented"; \
  if (!built_with_window()) GTEST_SKIP() << "built without the window";     \
  if (!on_path("xvfb-run")) GTEST_SKIP() << "xvfb-run is not there (tools/install-deps)"

/// `xvfb-run` with its authority file in `folder`: its own temporary folder sometimes cannot be
/// removed while the server ends, which it reports in place of the program's exit code.
std::vector<std::string> virtual_screen(const fs::path& folder) {
  return {"xvfb-run", "-a", "-f", folder / "xauthority", "-s", "-screen 0 1280x720x24"};
}

Outcome on_virtual_screen(const std::vector<std::string>& arguments, const fs::path& folder) {
  std::vector<std::string> all = virtual_screen(folder);
  all.emplace_back(YDD_BINARY);
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_program(all, folder);
}

cv::Mat read_picture(const fs::path& file) {
  const Result<ColourImage> image = load_colour(file);
  if (!image) return {};
  std::vector<Bgr> pixels(image->data(),
                          image->data() + std::size_t(image->width()) * image->height());
  return cv::Mat(image->height(), image->width(), CV_8UC3, pixels.data()).clone();
}

cv::Mat part(const cv::Mat& picture, const PixelRect& r) {
  return picture(cv::Rect(r.x, r.y, r.width, r.height));
}

int pixels_like(const cv::Mat& picture, Rgba colour, int tolerance) {
  const cv::Scalar bgr(colour[2], colour[1], colour[0]);
  cv::Mat inside;
  cv::inRange(picture, bgr - cv::Scalar::all(tolerance), bgr + cv::Scalar::all(tolerance), inside);
  return cv::countNonZero(inside);
}

double deviation(const cv::Mat& picture) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(picture, mean, deviation);
  return deviation[0] + deviation[1] + deviation[2];
}

/// Mean difference of two pictures per channel, after blurring: fonts and filters may differ. Of
/// the lower left: saved pictures have a map in the upper right corner and the rate on top.
double difference(cv::Mat a, cv::Mat b) {
  cv::resize(b, b, a.size(), 0, 0, cv::INTER_LINEAR);
  const cv::Rect compared(0, a.rows / 3, a.cols / 2, 2 * a.rows / 3);
  a = a(compared);
  b = b(compared);
  cv::Mat soft_a;
  cv::Mat soft_b;
  cv::blur(a, soft_a, {5, 5});
  cv::blur(b, soft_b, {5, 5});
  cv::absdiff(soft_a, soft_b, soft_a);
  const cv::Scalar mean = cv::mean(soft_a);
  return (mean[0] + mean[1] + mean[2]) / 3;
}

TEST(View, ShowsPictureMapAndPanels) {
  REQUIRE_A_SCREEN();
  const TemporaryFolder folder;
  const Outcome outcome =
      on_virtual_screen({"run", busy_room().string(), "--out", "a", "--quiet", "--detections",
                         (busy_room() / "detections.jsonl").string(), "--frames", "pictures",
                         "--view", "--view-close-at-end", "--view-screenshot", "view.png"},
                        folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const cv::Mat window = read_picture(folder / "view.png");
  ASSERT_EQ(window.size(), cv::Size(1280, 720));
  const WindowLayout layout = layout_window(1280, 720, 320.0 / 240);

  const std::string last = fmt::format("{:06d}.png", kFrames - 1);
  const cv::Mat annotated = read_picture(folder / "pictures" / last);
  ASSERT_FALSE(annotated.empty());
  EXPECT_LT(difference(part(window, layout.picture), annotated), 4);
  const cv::Mat first = read_picture(folder / "pictures/000000.png");
  EXPECT_GT(difference(part(window, layout.picture), first), 6) << "not the last frame";

  const cv::Mat map = part(window, layout.map);
  EXPECT_GT(pixels_like(map, scene_colour::kPoint, 40), 300);
  EXPECT_GT(pixels_like(map, scene_colour::kTrajectory, 40), 20);
  EXPECT_GT(pixels_like(map, scene_colour::kTracking, 30), 50);
  EXPECT_GT(pixels_like(map, scene_colour::kTrack, 30), 200) << "more than the layer's chip";
  EXPECT_GT(deviation(part(window, layout.toolbar)), 10);
  EXPECT_GT(deviation(part(window, layout.charts)), 20);
  // Results are those of a run without a window.
  const auto summary = nlohmann::json::parse(read_file(folder / "a/summary.json").value());
  EXPECT_EQ(summary.at("frames_processed"), kFrames);
  EXPECT_TRUE(summary.at("live_commands").empty());
}

TEST(View, ChangesNothingInWhatIsComputed) {
  REQUIRE_A_SCREEN();
  const TemporaryFolder folder;
  const std::vector<std::string> options = {"run", few_frames().string(), "--deterministic",
                                            "--quiet"};
  std::vector<std::string> watched = options;
  watched.insert(watched.end(), {"--out", "a", "--view", "--view-close-at-end", "--view-dense"});
  std::vector<std::string> alone = options;
  alone.insert(alone.end(), {"--out", "b"});
  const Outcome outcome = on_virtual_screen(watched, folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(ydd_slam(alone, folder.path()).exit_code, 0);
  EXPECT_EQ(read_file(folder / "a/trajectory.tum").value(),
            read_file(folder / "b/trajectory.tum").value());
}

/// Presses keys in the window and closes it, as a user would, while the run is going on.
Outcome with_user(const std::string& user, const std::vector<std::string>& arguments,
                  const fs::path& folder) {
  const std::string script = fmt::format(
      "\"$@\" & run=$!; xdotool search --sync --onlyvisible --name ydd-slam >window; "
      "xdotool mousemove 900 400; {}; wait $run",
      user);
  std::vector<std::string> all = virtual_screen(folder);
  all.insert(all.end(), {"sh", "-c", script, "sh", YDD_BINARY});
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_program(all, folder);
}

TEST(View, KeysStepAndClosingLetsAPausedRunGoOn) {
  REQUIRE_A_SCREEN();
  if (!on_path("xdotool")) GTEST_SKIP() << "xdotool is not there (tools/install-deps)";
  const TemporaryFolder folder;
  const Outcome outcome = with_user(
      "xdotool key s; xdotool key s; xdotool key p; "
      "while ! ls a/view-*.png >/dev/null 2>&1; do sleep 0.1; done; "
      "xdotool key q",
      {"run", few_frames().string(), "--out", "a", "--quiet", "--view", "--view-paused"},
      folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(read_file(folder / "a/summary.json").value());
  EXPECT_EQ(summary.at("frames_processed"), 6);
  std::vector<std::string> commands;
  for (const auto& done : summary.at("live_commands")) commands.push_back(done.at("command"));
  EXPECT_THAT(commands, testing::ElementsAre("step", "step", "step", "resume"));
  EXPECT_EQ(summary.at("live_commands").at(1).at("after_frame"), 0);
}

TEST(View, WithoutADisplaySaysSoInOneLine) {
  if (!built_with_window()) GTEST_SKIP() << "built without the window";
  const TemporaryFolder folder;
  const Outcome outcome =
      run_program({"env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", YDD_BINARY, "run",
                   few_frames().string(), "--out", "a", "--quiet", "--view"},
                  folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_EQ(outcome.error_lines().size(), 1U) << outcome.err;
  EXPECT_THAT(outcome.error_lines().front(), HasSubstr("--view: no window can be opened"));
  EXPECT_EQ(outcome.lines_on_err(), 1U) << outcome.err;
}

TEST(View, ARunThatFailsClosesItsWindow) {
  REQUIRE_A_SCREEN();
  const TemporaryFolder folder;
  const fs::path broken = copy_of(few_frames(), folder / "broken");
  for (const auto& entry : fs::directory_iterator(broken / "rgb")) {
    fs::resize_file(entry.path(), 10);
  }
  const Outcome outcome = on_virtual_screen({"run", "broken", "--quiet", "--view"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("not one frame"));
}

TEST(View, AScreenshotIsAPngOrAJpeg) {
  const Outcome outcome = ydd_slam({"run", "somewhere", "--view", "--view-screenshot", "a.gif"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr(".png or .jpg"));
}

TEST(View, ItsOptionsNeedTheWindow) {
  const Outcome outcome = ydd_slam({"run", "somewhere", "--view-screenshot", "a.png"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--view"));
}

}  // namespace
}  // namespace ydd::e2e
