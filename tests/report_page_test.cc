// SPDX-License-Identifier: Apache-2.0
//
// Reports as their readers meet them: in a browser.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "browser.h"
#include "small_world.h"

namespace ydd::e2e {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// The visible part: what the scripts made, without scripts, data and the bytes of pictures.
std::string body_of(const std::string& dom) {
  const auto begin = dom.find("<body");
  std::string body = dom.substr(begin, dom.find("<script", begin) - begin);
  const std::string picture = "data:image/jpeg;base64,";
  for (auto at = body.find(picture); at != std::string::npos; at = body.find(picture, at + 1)) {
    const auto bytes = at + picture.size();
    body.erase(bytes, body.find('"', bytes) - bytes);
  }
  return body;
}

void expect_no_complaints(const Outcome& page) {
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(page.err, Not(HasSubstr("Uncaught")));
  EXPECT_THAT(page.err, Not(HasSubstr("Refused to"))) << "the page's own policy";
}

void run_variant(const fs::path& out, const std::string& variant) {
  const Outcome outcome =
      ydd_slam({"run", busy_room(), "--out", out, "--quiet", "--deterministic", "--max-frames",
                "45", "--detections", busy_room() / "detections.jsonl", "--dynamic", variant});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(ReportPage, ShowsARun) {
  YDD_NEEDS_CHROMIUM();
  const TemporaryFolder folder;
  run_variant(folder / "full", "full");
  const Outcome page = dump_dom("file://" + (folder / "full/report.html").string());
  expect_no_complaints(page);
  EXPECT_THAT(page.out, HasSubstr("data-drawn=\"9\"")) << "all plots were drawn";
  const std::string body = body_of(page.out);
  for (const char* const shown :
       {"variant full", "ATE, RMSE (SE(3))", "45 of 45", "From above", "From the side",
        "ground truth", "Key moments", "data:image/jpeg;base64,", "ATE: distance to ground truth",
        "RPE: drift over 1 s", "Requested and kept per frame", "Rejected per rule", "body depth",
        "Processor time per stage", "Distribution of times", "Map growth", "Configuration",
        "OpenCV"}) {
    EXPECT_THAT(body, HasSubstr(shown));
  }
  EXPECT_EQ(count_of(body, "<svg"), 4U) << "the room and the ways of its people, from two sides";
  EXPECT_GE(count_of(body, "class=\"estimate\""), 2U);
  EXPECT_THAT(body, Not(HasSubstr("NaN")));
  EXPECT_THAT(body, Not(HasSubstr("undefined")));
}

TEST(ReportPage, ShowsARunWithoutTruthOnAPhone) {
  YDD_NEEDS_CHROMIUM();
  const TemporaryFolder folder;
  fs::remove(copy_of(few_frames(), folder / "mine") / "groundtruth.txt");
  ASSERT_EQ(ydd_slam({"run", folder / "mine", "--out", folder / "a", "--quiet"}).exit_code, 0);
  const Outcome page = dump_dom("file://" + (folder / "a/report.html").string(), "390,800");
  expect_no_complaints(page);
  const std::string body = body_of(page.out);
  EXPECT_THAT(body, HasSubstr("6 of 6"));
  EXPECT_THAT(body, HasSubstr("No point was rejected."));
  EXPECT_THAT(body, Not(HasSubstr("ATE")));
  EXPECT_THAT(body, Not(HasSubstr("NaN")));
}

TEST(ReportPage, ShowsRunsSideBySide) {
  YDD_NEEDS_CHROMIUM();
  const TemporaryFolder folder;
  run_variant(folder / "off", "off");
  run_variant(folder / "full", "full");
  ASSERT_EQ(ydd_slam({"report", folder / "off", folder / "full", "--trajectory",
                      "peer=" + (busy_room() / "groundtruth.txt").string(), "--out",
                      folder / "page.html"})
                .exit_code,
            0);
  const Outcome page = dump_dom("file://" + (folder / "page.html").string());
  expect_no_complaints(page);
  const std::string body = body_of(page.out);
  for (const char* const shown :
       {"off · full · peer", "ATE RMSE [m]", "tracking, median cpu [ms]", "Each aligned to ground",
        "Poses within so many centimetres", "Share of points rejected", "Settings that differ",
        "dynamics.variant"}) {
    EXPECT_THAT(body, HasSubstr(shown));
  }
  EXPECT_EQ(count_of(body, "class=\"estimate\""), 6U) << "three tracks in two views";
  EXPECT_THAT(body, HasSubstr("class=\"best\""));
  EXPECT_THAT(body, Not(HasSubstr("NaN")));
}

/// Frame numbers are shown by the plots' legends when the pointer is over a frame.
TEST(ReportPage, TextInPlaceOfFrameNumbersStaysText) {
  YDD_NEEDS_CHROMIUM();
  const TemporaryFolder folder;
  run_variant(folder / "full", "full");
  auto frames = nlohmann::json::parse(read_file(folder / "full/frames.json").value());
  for (auto& index : frames["index"]) index = "<img src=x onerror=document.title='owned'>";
  for (auto& points : frames["points"]) points = "<img src=x onerror=document.title='owned'>";
  frames["rejected"]["<img src=x>"] = frames["kept"];
  std::ofstream(folder / "full/frames.json") << frames;
  ASSERT_EQ(ydd_slam({"report", folder / "full"}).exit_code, 0);
  std::string html = read_file(folder / "full/report.html").value();
  const std::string nonce = html.substr(html.find("<script nonce="), 40);
  const std::string hover = nonce.substr(0, nonce.find('>') + 1) +
                            "for (const p of plots) if (p.overTime) p.setSelection(5);</script>";
  html.insert(html.rfind("</body>"), hover);
  std::ofstream(folder / "full/report.html") << html;
  const Outcome page = dump_dom("file://" + (folder / "full/report.html").string());
  expect_no_complaints(page);
  const std::string body = body_of(page.out);
  EXPECT_THAT(body, HasSubstr("frame &lt;img src=x onerror"));
  EXPECT_THAT(body, Not(HasSubstr("<img src=\"x\"")));
  EXPECT_THAT(page.out, Not(HasSubstr("<title>owned")));
}

}  // namespace
}  // namespace ydd::e2e
