// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/yaml_reader.h"

#include <sys/stat.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/base/files.h"
#include "ydd/base/temporary_folder_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text) {
  const auto root = parse_yaml(text, "a.yaml");
  return root ? "no error" : root.error().message;
}

std::string nested(int levels) {
  std::string text = "a: ";
  for (int i = 0; i < levels; ++i) text += "[";
  for (int i = 0; i < levels; ++i) text += "]";
  return text;
}

TEST(YamlReader, AnAliasInsideOfWhatItNamesIsRefused) {
  EXPECT_THAT(error_of("x: 1\na: &a {b: *a}"), HasSubstr("a.yaml:2: not valid YAML: an alias"));
  EXPECT_THAT(error_of("&a [*a]"), HasSubstr("an alias stands inside"));
  EXPECT_THAT(error_of("&a {b: {c: [1, &d {e: *a}]}}"), HasSubstr("an alias stands inside"));
  EXPECT_THAT(error_of("a: &a {*a : 1}"), HasSubstr("an alias stands inside"));
}

TEST(YamlReader, AliasesThatMultiplyAreRefusedAndPlainOnesResolved) {
  std::string laughs = "x0: &x0 [lol]\n";
  for (int i = 1; i < 60; ++i) laughs += fmt::format("x{0}: &x{0} [*x{1}, *x{1}]\n", i, i - 1);
  EXPECT_THAT(error_of(laughs), HasSubstr("more than 100000 values"));
  const auto root = parse_yaml("a: &a {b: 1}\nc: *a\nd: [*a, *a]\n", "a.yaml");
  ASSERT_TRUE(root) << root.error().message;
  EXPECT_EQ((*root)["d"][1]["b"].Scalar(), "1");
}

TEST(YamlReader, NestingHasABound) {
  EXPECT_EQ(error_of(nested(30)), "no error");
  EXPECT_THAT(error_of(nested(40)), HasSubstr("nested in more than 32 levels"));
  EXPECT_NE(error_of(nested(200'000)), "no error");
  EXPECT_NE(error_of(std::string(200'000, '{')), "no error");
  std::string dashes;
  for (int i = 0; i < 100'000; ++i) dashes += "- ";
  EXPECT_NE(error_of(dashes), "no error");
}

TEST(YamlReader, AKeyTwiceMustHaveOneValue) {
  EXPECT_EQ(error_of("a: 1\nb: 2\na: 3\n"),
            "a.yaml:3: 'a' is '3' here and '1' in line 1; keep one");
  EXPECT_THAT(error_of("m:\n  - {a: 1, a: 2}\n"), HasSubstr("a.yaml:2: 'a' is '2' here"));
  EXPECT_THAT(error_of("a: [1]\na: [2]\n"), HasSubstr("a list or map here and a list or map"));
  EXPECT_EQ(error_of("a: 1.50\na: 1.5\n"), "no error");
  EXPECT_EQ(error_of("a: [1, 2]\na: [1, 2]\n"), "no error");
  EXPECT_TRUE(parse_yaml("a: 1\na: 2\n", "a.yaml", Keys::may_contradict));
}

TEST(YamlReader, OneDocumentOfText) {
  EXPECT_THAT(error_of("a: 1\n---\nb: 2\n"), HasSubstr("a.yaml:2: not valid YAML: a second"));
  EXPECT_EQ(error_of("---\na: 1\n---\n"), "no error");
  EXPECT_EQ(error_of(""), "no error");
  EXPECT_THAT(error_of(std::string("a: 1\0b", 6)), HasSubstr("a zero byte"));
  EXPECT_THAT(error_of(std::string((4 << 20) + 1, '#')), HasSubstr("more than such a file"));
}

TEST(YamlReader, ALoneCommaOrBracketIsNoEndlessRowOfDocuments) {
  for (const char* const text : {",s", "a: 1\n,", "]", "}\n", "---\n,", "# a\n\n, b"}) {
    EXPECT_THAT(error_of(text), HasSubstr("not valid YAML")) << text;
  }
  EXPECT_THAT(error_of(",s"), HasSubstr("a.yaml:1: not valid YAML: a comma or bracket"));
  EXPECT_EQ(error_of("---\n---\n---\n"), "no error");
}

TEST(YamlReader, OpenCvsDialectKeepsItsLines) {
  const auto root =
      parse_yaml("\xEF\xBB\xBF%YAML:1.0\n---\n# c\nViewer.Size:2\n  \nb: x:y\nc:[1]\n", "a.yaml");
  ASSERT_TRUE(root) << root.error().message;
  EXPECT_EQ((*root)["Viewer.Size"].Scalar(), "2");
  EXPECT_EQ((*root)["b"].Scalar(), "x:y");
  EXPECT_EQ((*root)["c"][0].Scalar(), "1");
  EXPECT_EQ((*root)["b"].Mark().line, 5);
  EXPECT_EQ(error_of("%YAML:1.0"), "no error");
  EXPECT_EQ(error_of("%YAML:1.0\n"), "no error");
}

TEST(YamlReader, OnlyFilesAreOpened) {
  const TemporaryFolder folder;
  const auto refusal = [](const std::filesystem::path& file) {
    const auto root = read_yaml(file);
    return root ? "no error" : root.error().message;
  };
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder / "pipe"), HasSubstr("pipe: not a file but"));
  EXPECT_THAT(refusal(folder.path()), HasSubstr("not a file but"));
  EXPECT_THAT(refusal("/dev/null"), HasSubstr("not a file but"));
  EXPECT_THAT(refusal(folder / "none"), HasSubstr("none: cannot be opened"));
  ASSERT_TRUE(write_file_atomically(folder / "big", std::string((4 << 20) + 1, '#')));
  EXPECT_THAT(refusal(folder / "big"), HasSubstr("more than such a file"));
}

}  // namespace
}  // namespace ydd
