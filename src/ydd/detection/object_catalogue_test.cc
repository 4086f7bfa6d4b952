// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/object_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"

namespace ydd {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string error_of(const std::string& text) {
  const auto catalogue = ObjectCatalogue::parse(text, "objects.yaml");
  return catalogue ? "no error" : catalogue.error().message;
}

TEST(ObjectCatalogue, TheFileInTheProjectIsTheBuiltInTable) {
  const auto file = ObjectCatalogue::load(std::string(YDD_SOURCE_DIR) + "/configs/objects.yaml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(*file, ObjectCatalogue::defaults());
}

TEST(ObjectCatalogue, DefaultsOfEverySubcategory) {
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  const std::vector<std::pair<std::string, Subcategory>> expected = {
      {"person", Subcategory::person},
      {"head", Subcategory::head},
      {"hand", Subcategory::hand},
      {"fan", Subcategory::automatic},
      {"robot", Subcategory::automatic},
      {"cat", Subcategory::automatic},
      {"dog", Subcategory::automatic},
      {"cup", Subcategory::small},
      {"mug", Subcategory::small},
      {"bottle", Subcategory::small},
      {"book", Subcategory::small},
      {"mouse", Subcategory::small},
      {"cell phone", Subcategory::small},
      {"remote", Subcategory::small},
      {"keyboard", Subcategory::medium},
      {"laptop", Subcategory::medium},
      {"backpack", Subcategory::medium},
      {"chair", Subcategory::large},
      {"tv", Subcategory::large},
      {"monitor", Subcategory::large},
      {"suitcase", Subcategory::large},
      {"desk", Subcategory::stationary},
      {"never heard of", Subcategory::stationary}};
  for (const auto& [name, subcategory] : expected) {
    EXPECT_EQ(catalogue.subcategory_of(name), subcategory) << name;
  }
  EXPECT_TRUE(catalogue.knows("desk"));
  EXPECT_FALSE(catalogue.knows("never heard of"));
}

TEST(ObjectCatalogue, ExtentsOfTheArticle) {
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  EXPECT_DOUBLE_EQ(catalogue.extent_m("head"), 0.20);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("hand"), 0.18);
  EXPECT_DOUBLE_EQ(catalogue.extents().half_hand_m, 0.50);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("person"), 1.0);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("fan"), 0.70);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("cup"), 0.20);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("keyboard"), 0.45);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("chair"), 0.70);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("desk"), 0);
  EXPECT_DOUBLE_EQ(catalogue.extent_m("never heard of"), 0);
}

TEST(ObjectCatalogue, CategoriesFollowFromSubcategories) {
  for (const auto subcategory :
       {Subcategory::person, Subcategory::head, Subcategory::hand, Subcategory::automatic}) {
    EXPECT_EQ(category_of(subcategory), Category::dynamic);
  }
  for (const auto subcategory : {Subcategory::small, Subcategory::medium, Subcategory::large}) {
    EXPECT_EQ(category_of(subcategory), Category::potentially_dynamic);
  }
  EXPECT_EQ(category_of(Subcategory::stationary), Category::stationary);
}

TEST(ObjectCatalogue, NamesReadBack) {
  for (int i = 0; i < kSubcategoryCount; ++i) {
    const auto subcategory = static_cast<Subcategory>(i);
    EXPECT_EQ(parse_subcategory(to_string(subcategory)), subcategory);
  }
  EXPECT_EQ(to_string(Subcategory::stationary), "static");
  EXPECT_EQ(to_string(Category::potentially_dynamic), "potentially dynamic");
  EXPECT_FALSE(parse_subcategory("people"));
}

TEST(ObjectCatalogue, AUserTableReplacesTheBuiltInOne) {
  const auto catalogue = ObjectCatalogue::parse(
      "extents_m: {small: 0.3}\n"
      "classes:\n"
      "  person: [worker]\n"
      "  automatic: [forklift, {name: drone, extent_m: 0.5}]\n"
      "  small: [part]\n"
      "  medium:\n",
      "x");
  ASSERT_TRUE(catalogue) << catalogue.error().message;
  EXPECT_EQ(catalogue->subcategory_of("worker"), Subcategory::person);
  EXPECT_EQ(catalogue->subcategory_of("person"), Subcategory::stationary);
  EXPECT_DOUBLE_EQ(catalogue->extent_m("drone"), 0.5);
  EXPECT_DOUBLE_EQ(catalogue->extent_m("forklift"), 0.7);
  EXPECT_DOUBLE_EQ(catalogue->extent_m("part"), 0.3);
  EXPECT_DOUBLE_EQ(catalogue->extents().head_m, 0.2);
}

TEST(ObjectCatalogue, EachMistakeIsOneLineWithItsPlace) {
  EXPECT_THAT(error_of("classes:\n  people: [man]\n"),
              StartsWith("objects.yaml:2: unknown subcategory 'people'; known are person"));
  EXPECT_THAT(error_of("classes:\n  person: [man]\n  small: [cup,\n    man]\n"),
              StartsWith("objects.yaml:4: class 'man' is named twice, first as 'person'"));
  EXPECT_THAT(error_of("extents_m:\n  head: 0.2\n  foot: 0.1\nclasses: {person: [man]}\n"),
              StartsWith("objects.yaml:3: unknown extent 'foot'; known are head"));
  EXPECT_THAT(error_of("extents_m:\n  head: -1\nclasses: {person: [man]}\n"),
              StartsWith("objects.yaml:2: an extent must be a number above 0"));
  EXPECT_THAT(error_of("extents_m:\n  head: .nan\nclasses: {person: [man]}\n"),
              StartsWith("objects.yaml:2: an extent must be a number"));
  EXPECT_THAT(error_of("classes:\n  person: man\n"),
              StartsWith("objects.yaml:2: 'person' must hold a list"));
  EXPECT_THAT(error_of("classes:\n  person:\n  - {nam: man}\n"),
              StartsWith("objects.yaml:3: a class must be a name or {name"));
  EXPECT_THAT(error_of("classes:\n  person:\n  - {name: man, extent_m: wide}\n"),
              StartsWith("objects.yaml:3: an extent must be a number"));
  EXPECT_THAT(error_of("clases:\n  person: [man]\n"),
              StartsWith("objects.yaml:1: unknown key 'clases'"));
  EXPECT_THAT(error_of("classes:\n  small: [cup]\n"), HasSubstr("no class is dynamic"));
  EXPECT_THAT(error_of("extents_m: {head: 0.2}\n"), HasSubstr("'classes' must hold"));
  EXPECT_THAT(error_of("extents_m: 3\nclasses: {person: [man]}\n"),
              StartsWith("objects.yaml:1: 'extents_m' must hold"));
  EXPECT_THAT(error_of(""), HasSubstr("must hold 'classes:'"));
  EXPECT_THAT(error_of("classes: [\n"), HasSubstr("not valid YAML"));
}

TEST(ObjectCatalogue, AMissingFileIsNamed) {
  const auto catalogue = ObjectCatalogue::load("no/such/objects.yaml");
  ASSERT_FALSE(catalogue);
  EXPECT_THAT(catalogue.error().message, HasSubstr("no/such/objects.yaml"));
}

TEST(ObjectCatalogue, NamesMatchInAnyCaseAndWithAnyBlank) {
  const ObjectCatalogue catalogue = ObjectCatalogue::defaults();
  for (const char* const name : {"Person", "PERSON", "pedestrian", "Human", "man"}) {
    EXPECT_EQ(catalogue.subcategory_of(name), Subcategory::person) << name;
  }
  EXPECT_EQ(catalogue.subcategory_of("Cell_Phone"), Subcategory::small);
  EXPECT_EQ(catalogue.subcategory_of("DINING-table"), Subcategory::stationary);
  EXPECT_TRUE(catalogue.knows("DINING-table"));
  EXPECT_FALSE(catalogue.knows("persona"));
  EXPECT_EQ(catalogue.extent_m("Person"), catalogue.extent_m("person"));
  const auto twice = ObjectCatalogue::parse("classes: {person: [a b, A_B]}", "o.yaml");
  ASSERT_FALSE(twice);
  EXPECT_NE(twice.error().message.find("class 'A_B' is named twice"), std::string::npos);
}

}  // namespace
}  // namespace ydd
