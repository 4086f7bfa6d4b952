// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/class_table.h"

#include <unistd.h>

#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ydd {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Result<std::vector<std::string>> parse(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("ydd_classes_{}.yaml", ::getpid());
  std::ofstream(file) << text;
  auto table = read_class_table(file);
  std::filesystem::remove(file);
  return table;
}

std::string failure_of(const std::string& text) {
  const auto table = parse(text);
  return table ? "no failure" : table.error().message;
}

TEST(ClassTable, ReadsListsAndNumberedMaps) {
  EXPECT_THAT(parse("names: [body, head, hand]").value(), ElementsAre("body", "head", "hand"));
  EXPECT_THAT(parse("nc: 3\nnames:\n  2: hand\n  0: body\n  1: head\ntrain: x\n").value(),
              ElementsAre("body", "head", "hand"));
}

TEST(ClassTable, ErrorsNameTheLine) {
  EXPECT_THAT(failure_of("classes: [a]"), HasSubstr("must hold 'names:"));
  EXPECT_THAT(failure_of("just text"), HasSubstr("must hold 'names:"));
  EXPECT_THAT(failure_of(""), HasSubstr("must hold 'names:"));
  EXPECT_THAT(failure_of("names: []"), HasSubstr("must hold 'names:"));
  EXPECT_THAT(failure_of("names:\n  - a\n  - [b]"),
              HasSubstr(".yaml:3: a class name must be text"));
  EXPECT_THAT(failure_of("names:\n  - a\n  - a"), HasSubstr(".yaml:3: class 'a' is named twice"));
  EXPECT_THAT(failure_of("names:\n  0: a\n  2: b"), HasSubstr(":3: class number 2 where 1"));
  EXPECT_THAT(failure_of("names:\n  x: a"), HasSubstr(":2: a class number must be"));
  EXPECT_THAT(failure_of("names: [a"), HasSubstr("not valid YAML"));
  EXPECT_FALSE(read_class_table("/nowhere/classes.yaml").ok());
}

TEST(ClassTable, TheTablesOfTheProjectAreWhole) {
  const std::filesystem::path configs = YDD_SOURCE_DIR "/configs/detector";
  const auto coco = read_class_table(configs / "coco_classes.yaml");
  ASSERT_TRUE(coco.ok()) << coco.error().message;
  EXPECT_EQ(coco->size(), 80U);
  EXPECT_EQ(coco->at(56), "chair");
  EXPECT_EQ(coco->back(), "toothbrush");
  EXPECT_THAT(read_class_table(configs / "body_head_hand_classes.yaml").value(),
              ElementsAre("body", "head", "hand"));
}

}  // namespace
}  // namespace ydd
