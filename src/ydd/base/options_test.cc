// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/options.h"

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"

namespace ydd {
namespace {

using testing::HasSubstr;

struct OrbPart {
  int levels = 8;
  double step = 1.2;
  void describe(OptionTable& t) {
    t.add("levels", levels, {1, 16}, "", "pyramid levels");
    t.add("step", step, {1.01, 2.0}, "", "scale between levels");
  }
};

/// Two levels of groups, as the application has them.
struct Nested {
  OrbPart orb;
  void describe(OptionTable& t) { t.group("orb", orb); }
};
struct Root {
  bool loop = true;
  std::string mode = "full";
  std::string note = "plain: text # with signs";
  Nested features;
  double range_m = 4.0;
  void describe(OptionTable& t) {
    t.add("loop", loop, "close loops");
    t.add("mode", mode, {"off", "full"}, "what to reject");
    t.add("note", note, {}, "anything");
    t.group("features", features);
    t.add("range", range_m, {0.0}, "m", "how far");
  }
};

class Options : public testing::Test {
 protected:
  Options()
      : file_(std::filesystem::path(testing::TempDir()) / fmt::format("o{}.yaml", ::getpid())) {
    root_.describe(table_);
  }
  ~Options() override { std::filesystem::remove(file_); }

  Result<void> load(std::string_view yaml) {
    EXPECT_TRUE(write_file_atomically(file_, yaml));
    return table_.load_yaml(file_);
  }
  std::string error_of_yaml(std::string_view yaml) {
    const auto result = load(yaml);
    return result ? "no error" : result.error().message;
  }

  std::filesystem::path file_;
  Root root_;
  OptionTable table_;
};

TEST_F(Options, KeysAreDottedPathsInOrderOfDescription) {
  std::vector<std::string> keys;
  for (const Option& option : table_.options()) keys.push_back(option.key);
  EXPECT_THAT(keys, testing::ElementsAre("loop", "mode", "note", "features.orb.levels",
                                         "features.orb.step", "range"));
}

TEST_F(Options, SetsEveryKindOfValue) {
  EXPECT_TRUE(table_.set("loop", "false", "--set"));
  EXPECT_TRUE(table_.set("mode", "off", "--set"));
  EXPECT_TRUE(table_.set("features.orb.levels", "+4", "--set"));
  EXPECT_TRUE(table_.set_assignment("features.orb.step=1.5e0", "--set"));
  EXPECT_TRUE(table_.set_assignment("note=a=b", "--set"));
  EXPECT_FALSE(root_.loop);
  EXPECT_EQ(root_.mode, "off");
  EXPECT_EQ(root_.features.orb.levels, 4);
  EXPECT_DOUBLE_EQ(root_.features.orb.step, 1.5);
  EXPECT_EQ(root_.note, "a=b");
}

TEST_F(Options, RefusalsNameKeyValueAndWhatIsAllowed) {
  const auto refusal = [&](std::string_view key, std::string_view text) {
    const auto result = table_.set(key, text, "there:7");
    return result ? std::string("no error") : result.error().message;
  };
  EXPECT_EQ(refusal("features.orb.levels", "99"),
            "there:7: 'features.orb.levels' is '99' but must be a whole number in [1, 16]");
  EXPECT_EQ(refusal("range", "-1"), "there:7: 'range' is '-1' but must be a number >= 0 m");
  EXPECT_EQ(refusal("loop", "yes"), "there:7: 'loop' is 'yes' but must be true or false");
  EXPECT_EQ(refusal("mode", "on"), "there:7: 'mode' is 'on' but must be one of off, full");
  EXPECT_THAT(refusal("orb.levels", "4"), HasSubstr("there:7: unknown option 'orb.levels'"));
  for (const char* text : {"", "4.5", "four", "4x", " 4", "0x4", "99999999999999999999"}) {
    EXPECT_THAT(refusal("features.orb.levels", text), HasSubstr("must be a whole number")) << text;
  }
  for (const char* text : {"", "nan", "inf", "1.2.3", "1,5"}) {
    EXPECT_THAT(refusal("range", text), HasSubstr("must be a number")) << text;
  }
  EXPECT_EQ(root_.features.orb.levels, 8) << "a refused value must not stick";
}

TEST_F(Options, AssignmentsNeedAKeyAndAnEqualsSign) {
  EXPECT_THAT(table_.set_assignment("loop", "--set").error().message, HasSubstr("key=value"));
  EXPECT_FALSE(table_.set_assignment("=1", "--set"));
  EXPECT_FALSE(table_.set_assignment("", "--set"));
}

TEST_F(Options, ReadsNestedYaml) {
  const auto loaded =
      load("# comment\nloop: false\nfeatures:\n  orb:\n    levels: 5\nrange: 2.5\n");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_FALSE(root_.loop);
  EXPECT_EQ(root_.features.orb.levels, 5);
  EXPECT_DOUBLE_EQ(root_.features.orb.step, 1.2);
  EXPECT_DOUBLE_EQ(root_.range_m, 2.5);
}

TEST_F(Options, AnEmptyFileChangesNothing) { EXPECT_TRUE(load("# nothing\n")); }

TEST_F(Options, YamlErrorsNameFileAndLine) {
  const std::string file = file_.string();
  EXPECT_THAT(error_of_yaml("loop: true\nfeatures:\n  orb:\n    levels: 17\n"),
              HasSubstr(file + ":4: 'features.orb.levels' is '17'"));
  EXPECT_THAT(error_of_yaml("loop: true\nspeed: 3\n"), HasSubstr(file + ":2: unknown option"));
  EXPECT_THAT(error_of_yaml("mode: [a, b]\n"), HasSubstr(":1: 'mode' must be a single value"));
  EXPECT_THAT(error_of_yaml("- a\n- b\n"), HasSubstr("must hold 'key: value' lines"));
  EXPECT_THAT(error_of_yaml("loop: true\n  mode: off\n :::\n"), HasSubstr("not valid YAML"));
  std::filesystem::remove(file_);
  EXPECT_THAT(table_.load_yaml(file_).error().message, HasSubstr("cannot be opened"));
}

TEST_F(Options, AKeyTwiceMustHaveOneValue) {
  const std::string file = file_.string();
  EXPECT_EQ(error_of_yaml("loop: true\nrange: 2\nloop: false\n"),
            file + ":3: 'loop' is 'false' here and 'true' in line 1; keep one");
  EXPECT_EQ(error_of_yaml("features.orb.levels: 4\nfeatures:\n  orb: {levels: 5}\n"),
            file + ":3: 'features.orb.levels' is '5' here and '4' at " + file + ":1; keep one");
  EXPECT_EQ(error_of_yaml("loop: true\nloop: true\n"), "no error");
}

TEST_F(Options, UnknownKeysSuggestTheNearestKnown) {
  EXPECT_THAT(error_of_yaml("features:\n  orb:\n    level: 5\n"),
              HasSubstr(":3: unknown option 'features.orb.level'; did you mean "
                        "'features.orb.levels'?"));
  EXPECT_THAT(error_of_yaml("orb: {step: 1.5}\n"), HasSubstr("did you mean 'features.orb.step'?"));
  EXPECT_THAT(error_of_yaml("colour: 5\n"), testing::Not(HasSubstr("did you mean")));
}

TEST_F(Options, FilesOfOthersCannotBringItDown) {
  EXPECT_THAT(error_of_yaml("a: &a {b: *a}"), HasSubstr(":1: not valid YAML: an alias stands"));
  EXPECT_THAT(error_of_yaml(std::string(100'000, '[')), HasSubstr("not valid YAML"));
  EXPECT_THAT(error_of_yaml("{? [a] : 1}"), HasSubstr("a key must be plain text"));
}

TEST_F(Options, WhatIsWrittenIsReadBackTheSame) {
  root_.mode = "off";
  root_.features.orb.step = 1.0 / 3.0 + 1.0;
  root_.range_m = 1e-7;
  root_.note = "quote \" colon: hash # true";
  const std::string yaml = table_.to_yaml();
  Root again;
  OptionTable other;
  again.describe(other);
  ASSERT_TRUE(write_file_atomically(file_, yaml));
  const auto loaded = other.load_yaml(file_);
  ASSERT_TRUE(loaded) << loaded.error().message << "\n" << yaml;
  EXPECT_EQ(again.mode, root_.mode);
  EXPECT_EQ(again.note, root_.note);
  EXPECT_EQ(again.features.orb.step, root_.features.orb.step);
  EXPECT_EQ(again.range_m, root_.range_m);
  EXPECT_EQ(other.to_yaml(), yaml);
}

TEST_F(Options, YamlShowsUnitRangeAndSentence) {
  const std::string yaml = table_.to_yaml();
  EXPECT_THAT(yaml, HasSubstr("features:\n  orb:\n    levels: 8  # pyramid levels in [1, 16]\n"));
  EXPECT_THAT(yaml, HasSubstr("range: 4  # [m] how far >= 0\n"));
  EXPECT_THAT(yaml, HasSubstr("mode: full  # what to reject (off | full)\n"));
}

TEST_F(Options, DefaultsAreInsideTheirRanges) {
  Root again;
  OptionTable other;
  again.describe(other);
  for (const Option& option : table_.options()) {
    if (option.key == "note") continue;
    EXPECT_TRUE(other.set(option.key, format_value(option), "default")) << option.key;
  }
}

enum class Lens { pinhole, fisheye };
constexpr std::array<std::string_view, 2> choices_of(Lens) { return {"pinhole", "fish-eye"}; }

/// Options as most structures have them: an enumeration, and a number with a unit.
struct LensOptions {
  Lens lens = Lens::fisheye;
  double reach_m = 2;
  void describe(OptionTable& t) {
    t.add("lens", lens, "kind of lens");
    t.add("reach_m", reach_m, {0, 10}, "m", "how far");
  }
};

TEST(ChoiceOption, IsReadWrittenAndRefusedByName) {
  LensOptions options;
  OptionTable table;
  options.describe(table);
  EXPECT_EQ(format_value(table.options()[0]), "fish-eye");
  ASSERT_TRUE(table.set("lens", "pinhole", "--set").ok());
  EXPECT_EQ(options.lens, Lens::pinhole);
  const auto refused = table.set("lens", "fisheye", "--set");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("must be one of pinhole, fish-eye"));
  EXPECT_EQ(options.lens, Lens::pinhole);
  EXPECT_THAT(table.to_yaml(), HasSubstr("lens: pinhole  # kind of lens (pinhole | fish-eye)"));
}

TEST(ChoiceOption, NamesGoBothWays) {
  EXPECT_EQ(to_string(Lens::fisheye), "fish-eye");
  EXPECT_EQ(parse_choice<Lens>("fish-eye"), Lens::fisheye);
  EXPECT_FALSE(parse_choice<Lens>("fisheye").has_value());
}

TEST(OptionTable, AKeyThatLacksItsUnitIsSuggested) {
  LensOptions options;
  OptionTable table;
  options.describe(table);
  const auto refused = table.set("reach", "1", "--set");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("did you mean 'reach_m'?"));
}

}  // namespace
}  // namespace ydd
