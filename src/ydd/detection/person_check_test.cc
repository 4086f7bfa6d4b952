// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/person_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string warning(const std::vector<std::string>& classes) {
  return nobody_warning(classes, ObjectCatalogue::defaults(), "net.yaml").value_or("none");
}

TEST(PersonCheck, AnyPersonHeadOrHandIsEnough) {
  EXPECT_EQ(warning({"chair", "Person"}), "none");
  EXPECT_EQ(warning({"quasar", "PEDESTRIAN"}), "none");
  EXPECT_EQ(warning({"hand"}), "none");
  EXPECT_EQ(warning({"Head"}), "none");
}

TEST(PersonCheck, NamesWhatTheCatalogueDoesNotKnow) {
  EXPECT_THAT(warning({"chair", "persona", "quasar", "persona"}),
              AllOf(HasSubstr("net.yaml: none of the classes counts as a person"),
                    HasSubstr("does not know 'persona', 'quasar':"), Not(HasSubstr("chair"))));
  EXPECT_THAT(warning({"chair", "dog"}), HasSubstr("none of the classes is a person"));
  std::vector<std::string> many;
  for (int i = 0; i < 20; ++i) many.push_back("c" + std::to_string(i));
  EXPECT_THAT(warning(many), HasSubstr("'c7' and 12 more"));
}

TEST(PersonCheck, PeopleGetTheNamesThatTheRulesKnow) {
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  EXPECT_EQ(name_in_rules("Pedestrian", catalogue), "person");
  EXPECT_EQ(name_in_rules("PERSON", catalogue), "person");
  EXPECT_EQ(name_in_rules("Body", catalogue), "body");
  EXPECT_EQ(name_in_rules("Human_Head", catalogue), "head");
  EXPECT_EQ(name_in_rules("face", catalogue), "face");
  EXPECT_EQ(name_in_rules("Left_Hand", catalogue), "hand");
  EXPECT_EQ(name_in_rules("Cell_Phone", catalogue), "Cell_Phone");
  EXPECT_EQ(name_in_rules("persona", catalogue), "persona");
  RecordedFrame frame;
  frame.detections.push_back({.detection = {"Woman", 1.0F, {0, 0, 9, 9}}});
  EXPECT_THAT(named_by_rules(DetectionRecording({frame}), catalogue).class_names(),
              testing::ElementsAre("person"));
}

TEST(PersonCheck, ARecordingWithoutPeopleIsFineIfAllNamesAreKnown) {
  const auto warning_of = [](const std::string& class_name) {
    RecordedFrame frame;
    frame.detections.push_back({.detection = {class_name, 1.0F, {0, 0, 9, 9}}});
    return nobody_warning(DetectionRecording({frame}), ObjectCatalogue::defaults(), "d.jsonl");
  };
  EXPECT_EQ(warning_of("chair"), std::nullopt);
  EXPECT_EQ(warning_of("PERSON"), std::nullopt);
  EXPECT_THAT(warning_of("persona").value_or("none"), HasSubstr("d.jsonl: none of the classes"));
  EXPECT_EQ(nobody_warning(DetectionRecording({RecordedFrame()}), ObjectCatalogue::defaults(), "d"),
            std::nullopt);
}

}  // namespace
}  // namespace ydd
