// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/combined_detector.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Box kPersonBox{100, 100, 200, 400};

std::vector<std::string> names(const Detections& detections) {
  std::vector<std::string> out;
  for (const Detection& d : detections) out.push_back(d.class_name);
  return out;
}

std::vector<std::string> merged(Detections detections, const MergeOptions& options = {}) {
  return names(merge_people(std::move(detections), options));
}

TEST(MergePeople, ABodyOnAPersonIsThatPerson) {
  EXPECT_THAT(merged({{"person", 0.5F, kPersonBox}, {"body", 0.9F, {105, 95, 205, 390}}}),
              ElementsAre("person"));
}

TEST(MergePeople, APartOfAPersonIsThatPersonToo) {
  // Only the trunk: little overlap as a union, but all of it lies in the person.
  EXPECT_THAT(merged({{"person", 0.5F, kPersonBox}, {"body", 0.9F, {110, 150, 190, 230}}}),
              ElementsAre("person"));
  // The other way round: the person was seen in part.
  EXPECT_THAT(merged({{"person", 0.5F, {110, 150, 190, 230}}, {"body", 0.9F, kPersonBox}}),
              ElementsAre("person"));
}

TEST(MergePeople, ABodyWithAHeadBecomesAPersonWithItsOwnScore) {
  const Detections found =
      merge_people({{"head", 0.8F, {130, 100, 170, 150}}, {"body", 0.4F, kPersonBox}}, {});
  ASSERT_THAT(names(found), ElementsAre("head", "person"));
  EXPECT_EQ(found[1].score, 0.4F);
  EXPECT_EQ(found[1].box, kPersonBox);
}

TEST(MergePeople, ASecondPersonBesideADetectedOneIsKept) {
  // The person network saw one of two who overlap by a third.
  EXPECT_THAT(merged({{"person", 0.9F, kPersonBox},
                      {"body", 0.8F, {165, 100, 265, 400}},
                      {"head", 0.7F, {200, 100, 240, 150}}}),
              ElementsAre("person", "person", "head"));
}

TEST(MergePeople, ABodyWithoutAHeadInItsUpperHalfIsDropped) {
  EXPECT_THAT(merged({{"body", 0.9F, kPersonBox}}), IsEmpty());
  EXPECT_THAT(merged({{"body", 0.9F, kPersonBox}, {"head", 0.5F, {300, 100, 340, 150}}}),
              ElementsAre("head"));
  EXPECT_THAT(merged({{"body", 0.9F, kPersonBox}, {"head", 0.5F, {130, 340, 170, 390}}}),
              ElementsAre("head"));
}

TEST(MergePeople, TwoBodiesOfOnePersonGiveOne) {
  EXPECT_THAT(merged({{"head", 0.9F, {130, 100, 170, 150}},
                      {"body", 0.8F, kPersonBox},
                      {"body", 0.5F, {100, 100, 200, 230}}}),
              ElementsAre("head", "person"));
}

TEST(MergePeople, AHandNeedsAPersonOrAHeadWithinReach) {
  const Detection inside{"hand", 0.5F, {150, 250, 170, 270}};
  const Detection beside{"hand", 0.5F, {205, 250, 225, 270}};
  const Detection far{"hand", 0.5F, {400, 250, 420, 270}};
  const Detection person{"person", 0.9F, kPersonBox};
  EXPECT_THAT(merged({inside}), IsEmpty());
  EXPECT_THAT(merged({person, inside}), ElementsAre("person", "hand"));
  EXPECT_THAT(merged({person, beside}), ElementsAre("person", "hand")) << "an outstretched arm";
  EXPECT_THAT(merged({person, far}), ElementsAre("person"));
  const Detection head{"head", 0.9F, {200, 150, 240, 200}};  // reach: 4 x 50 px
  EXPECT_THAT(merged({head, {"hand", 0.5F, {400, 165, 430, 185}}}), ElementsAre("head", "hand"));
  EXPECT_THAT(merged({head, {"hand", 0.5F, {420, 165, 450, 185}}}), ElementsAre("head"));
  const Detection its_head{"head", 0.8F, {130, 100, 170, 150}};  // its person vouches, closer
  EXPECT_THAT(merged({person, its_head, {"hand", 0.5F, {250, 250, 270, 270}}}),
              ElementsAre("person", "head"));
}

TEST(MergePeople, AHandWhoseBodyWasDroppedGoesWithIt) {
  EXPECT_THAT(merged({{"body", 0.9F, kPersonBox}, {"hand", 0.5F, {150, 250, 170, 270}}}),
              IsEmpty());
}

TEST(MergePeople, TheSameThingFromTwoNetworksIsOne) {
  EXPECT_THAT(merged({{"chair", 0.5F, {0, 0, 50, 50}},
                      {"chair", 0.6F, {2, 0, 52, 50}},
                      {"chair", 0.4F, {100, 0, 150, 50}},
                      {"cup", 0.45F, {0, 0, 50, 50}}}),
              ElementsAre("chair", "cup", "chair"));
}

TEST(MergePeople, CanBeSwitchedOff) {
  MergeOptions off;
  off.enabled = false;
  EXPECT_THAT(merged({{"hand", 0.5F, {0, 0, 9, 9}}, {"body", 0.9F, kPersonBox}}, off),
              ElementsAre("body", "hand"));
}

class FixedDetector : public Detector {
 public:
  explicit FixedDetector(Result<Detections> answer) : answer_(std::move(answer)) {}
  Result<Detections> detect(const RgbdFrame&) override { return answer_; }

 private:
  Result<Detections> answer_;
};

std::vector<std::unique_ptr<Detector>> both(Result<Detections> a, Result<Detections> b) {
  std::vector<std::unique_ptr<Detector>> detectors;
  detectors.push_back(std::make_unique<FixedDetector>(std::move(a)));
  detectors.push_back(std::make_unique<FixedDetector>(std::move(b)));
  return detectors;
}

TEST(CombinedDetector, PutsTheListsTogether) {
  CombinedDetector detector(
      both(Detections{{"person", 0.6F, kPersonBox}, {"cup", 0.5F, {0, 0, 9, 9}}},
           Detections{{"body", 0.9F, kPersonBox}, {"head", 0.8F, {130, 100, 170, 150}}}),
      {});
  EXPECT_THAT(names(detector.detect({}).value()), ElementsAre("head", "person", "cup"));
}

TEST(CombinedDetector, AFailureOfOneIsAFailure) {
  CombinedDetector detector(both(Detections{}, Error{"frame 3: no"}), {});
  const auto found = detector.detect({});
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().message, "frame 3: no");
}

}  // namespace
}  // namespace ydd
