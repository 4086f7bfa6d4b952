// SPDX-License-Identifier: Apache-2.0
// Networks that others made to harm: whichever library is to run them, one line says what is wrong
// before it gets them.
#include "ydd/inference/onnx_graph.h"

#include <unistd.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ydd/inference/network.h"
#include "ydd/inference/onnx_sizes.h"
#include "ydd/inference/tiny_onnx_testing.h"

namespace ydd {
namespace {

using testing::HasSubstr;
using testing_onnx::bytes;
using testing_onnx::GraphWriter;
using testing_onnx::integer_tensor;
using testing_onnx::ints;
using testing_onnx::model;
using testing_onnx::number;
using testing_onnx::tensor;
using testing_onnx::value_info;

constexpr std::uint64_t kHuge = std::uint64_t{1} << 32U;
const std::string kImages = bytes(11, value_info("images", {1, 3, 0, 0}));
const std::string kWeights = bytes(5, tensor("w", {4, 3, 1, 1}, std::vector<float>(12, 0.1F)));

std::string node(std::string_view op, const std::vector<std::string>& from,
                 const std::vector<std::string>& to, const std::string& attributes = "") {
  std::string out;
  for (const std::string& name : from) out += bytes(1, name);
  for (const std::string& name : to) out += bytes(2, name);
  return bytes(1, out + bytes(3, "n") + bytes(4, op) + attributes);
}

/// A graph from `images` to `out`.
std::string graph(const std::string& nodes_and_constants, const std::string& input = kImages) {
  return model(nodes_and_constants + bytes(2, "g") + input + bytes(12, value_info("out", {})));
}

std::string convolution(const std::string& attributes) {
  return graph(node("Conv", {"images", "w"}, {"out"}, attributes) + kWeights);
}

std::string one(std::string_view op, const std::string& attributes) {
  return graph(node(op, {"images"}, {"out"}, attributes));
}

std::string resize(const std::vector<float>& scales) {
  return graph(
      node("Resize", {"images", "roi", "s"}, {"out"}, GraphWriter::text("mode", "nearest")) +
      bytes(5, tensor("roi", {0}, {})) + bytes(5, tensor("s", {scales.size()}, scales)));
}

std::string with_integers(std::string_view op, const std::vector<std::int64_t>& values,
                          const std::string& attributes = "") {
  return graph(node(op, {"images", "c"}, {"out"}, attributes) +
               bytes(5, integer_tensor("c", {values.size()}, values)));
}

/// Twice as large, and again.
std::string chain(const std::string& op, int length) {
  std::string nodes = bytes(5, tensor("s", {4}, {1, 1, 16, 16})) + bytes(5, tensor("r", {0}, {}));
  std::string from = "images";
  for (int i = 0; i < length; ++i) {
    const std::string to = i + 1 == length ? "out" : fmt::format("v{}", i);
    nodes +=
        op == "Concat"
            ? node(op, std::vector<std::string>(64, from), {to}, GraphWriter::integer("axis", 1))
            : node("Resize", {from, "r", "s"}, {to},
                   GraphWriter::text("mode", "nearest") +
                       GraphWriter::text("nearest_mode", "floor") +
                       GraphWriter::text("coordinate_transformation_mode", "asymmetric"));
    from = to;
  }
  return graph(nodes);
}

std::string fake_tensor(const std::vector<std::uint64_t>& dims, std::uint64_t type,
                        const std::string& content) {
  std::string out;
  for (const std::uint64_t d : dims) out += number(1, d);
  return graph(node("Conv", {"images", "w"}, {"out"}) +
               bytes(5, out + number(2, type) + bytes(8, "w") + content));
}

std::string deep_graphs(int depth) {
  std::string inner = bytes(2, "g");
  for (int i = 0; i < depth; ++i) {
    inner = node("If", {"images"}, {"out"}, bytes(5, bytes(1, "then_branch") + bytes(6, inner)));
  }
  return graph(inner);
}

struct Crafted {
  std::string name, onnx, message;
};

std::vector<Crafted> crafted() {
  const auto twelve = [](float v) { return std::vector<float>(12, v); };
  std::vector<Crafted> all;
  // Numbers that are something else in 32 bits, or nothing that a window can have.
  for (const char* list : {"strides", "dilations", "kernel_shape"}) {
    for (const std::uint64_t v : {std::uint64_t{0}, kHuge, kHuge + 1, ~std::uint64_t{0},
                                  std::uint64_t{1} << 63U, std::uint64_t{1} << 31U}) {
      all.push_back({list, convolution(ints(list, {v, 1})), fmt::format("'{}' holds", list)});
      all.push_back({list, one("MaxPool", ints(list, {1, v})), fmt::format("'{}' holds", list)});
    }
  }
  for (const std::uint64_t v : {kHuge, ~std::uint64_t{0}, std::uint64_t{1} << 30U}) {
    all.push_back({"pads", convolution(ints("pads", {0, v, 0, 0})), "'pads' holds"});
    all.push_back({"group", convolution(GraphWriter::integer("group", v)), "'group' holds"});
    all.push_back({"axis",
                   one("Softmax", GraphWriter::integer("axis", v == ~std::uint64_t{0} ? 99 : v)),
                   "'axis' holds"});
  }
  all.push_back({"no group", convolution(GraphWriter::integer("group", 0)), "'group' holds 0"});
  all.push_back({"unfit group", convolution(GraphWriter::integer("group", 3)), "groups"});
  all.push_back(
      {"blocks", one("DepthToSpace", GraphWriter::integer("blocksize", 0)), "'blocksize'"});
  all.push_back({"perm", one("Transpose", ints("perm", {0, 1, 1, 3})), "no order of dimensions"});
  all.push_back({"perm", one("Transpose", ints("perm", {0, 1, 2, 9})), "'perm' holds 9"});
  all.push_back({"short perm", one("Transpose", ints("perm", {1, 0})), "other dimensions"});
  all.push_back(
      {"unknown", one("Relu", GraphWriter::integer("whatever", kHuge)), "'whatever' holds"});
  all.push_back({"twice",
                 one("Softmax", GraphWriter::integer("axis", 1) + GraphWriter::integer("axis", 2)),
                 "has 'axis' twice"});
  // Upsampling beyond 32 bits.
  for (const float s : {67108864.0F, 0.0F, -2.0F, std::numeric_limits<float>::infinity(),
                        std::numeric_limits<float>::quiet_NaN()}) {
    all.push_back({"scales", resize({1, 1, s, s}), "scales hold"});
  }
  all.push_back({"few scales", resize({1, 2}), "scales for other dimensions"});
  all.push_back({"resize chain", chain("Resize", 8), "would hold more than"});
  all.push_back({"concat chain", chain("Concat", 8), "would hold more than"});
  all.push_back({"sizes",
                 graph(node("Resize", {"images", "", "", "c"}, {"out"}) +
                       bytes(5, integer_tensor("c", {4}, {1, 3, 1 << 30, 1 << 30}))),
                 "a size of 1073741824"});
  // Other operators.
  all.push_back({"reshape", with_integers("Reshape", {1, -1, -1}), "size that is none"});
  all.push_back({"reshape", with_integers("Reshape", {1, 7, 1234567}), "numbers"});
  all.push_back({"reshape", with_integers("Reshape", {1LL << 33, 1LL << 31}), "would hold more"});
  all.push_back(
      {"expand", with_integers("Expand", {1LL << 20, 3, 1LL << 20, 1}), "would hold more"});
  all.push_back({"tile", with_integers("Tile", {1, 1 << 20, 1 << 10, 1 << 10}), "would hold more"});
  all.push_back({"tile", with_integers("Tile", {1, -4, 1, 1}), "repeats -4 times"});
  all.push_back({"pad", with_integers("Pad", {0, 0, 1LL << 40, 0, 0, 0, 0, 0}), "pad of"});
  all.push_back({"pad", with_integers("Pad", {0, 0, -4000, 0, 0, 0, 0, 0}), "size of -"});
  all.push_back({"gather", with_integers("Gather", {1 << 20}), "takes number 1048576"});
  all.push_back(
      {"split", with_integers("Split", {-1, 4}, GraphWriter::integer("axis", 1)), "parts"});
  all.push_back(
      {"constant",
       graph(node("ConstantOfShape", {"c"}, {"x"}) + node("Add", {"images", "x"}, {"out"}) +
             bytes(5, integer_tensor("c", {2}, {1LL << 31, 1LL << 31}))),
       "would hold more"});
  all.push_back(
      {"slice",
       graph(node("Slice", {"images", "a", "b", "c", "d"}, {"out"}) +
             bytes(5, integer_tensor("a", {1}, {0})) + bytes(5, integer_tensor("b", {1}, {9})) +
             bytes(5, integer_tensor("c", {1}, {2})) + bytes(5, integer_tensor("d", {1}, {0}))),
       "step of 0"});
  all.push_back(
      {"slice",
       graph(node("Slice", {"images", "a", "b", "c"}, {"out"}) +
             bytes(5, integer_tensor("a", {1}, {0})) + bytes(5, integer_tensor("b", {1}, {9})) +
             bytes(5, integer_tensor("c", {1}, {6}))),
       "a dimension that there is not"});
  all.push_back(
      {"concat", one("Concat", GraphWriter::integer("axis", 5)), "a dimension that there is not"});
  // Graphs that cannot be computed.
  all.push_back({"self", graph(node("Relu", {"out"}, {"out"})), "reads 'out', which nothing"});
  all.push_back({"circle",
                 graph(node("Add", {"images", "b"}, {"a"}) + node("Relu", {"a"}, {"b"}) +
                       node("Relu", {"b"}, {"out"})),
                 "reads 'b', which nothing"});
  all.push_back({"missing", graph(node("Relu", {"nobody"}, {"out"})), "reads 'nobody'"});
  all.push_back({"two makers",
                 graph(node("Relu", {"images"}, {"out"}) + node("Tanh", {"images"}, {"out"})),
                 "'out' is made twice"});
  all.push_back(
      {"no maker", graph(node("Relu", {"images"}, {"other"})), "nothing makes its output"});
  all.push_back({"no input", graph(node("Relu", {}, {"out"})), "lacks an input"});
  all.push_back({"no weights", graph(node("Conv", {"images"}, {"out"})), "lacks an input"});
  all.push_back({"no output", graph(node("Relu", {"images"}, {})), "gives nothing"});
  all.push_back({"no operator", graph(node("", {"images"}, {"out"})), "without a name"});
  all.push_back({"two constants",
                 graph(node("Conv", {"images", "w"}, {"out"}) + kWeights + kWeights),
                 "there twice"});
  all.push_back({"deep", deep_graphs(50), "too deep"});
  std::string many = node("Relu", {"images"}, {"out"});
  for (int i = 0; i < 20'001; ++i) many += node("Relu", {"images"}, {fmt::format("m{}", i)});
  all.push_back({"many", graph(many), "operators; networks have at most"});
  // Constants that are not what they say.
  all.push_back({"dims", fake_tensor({kHuge, kHuge, 1, 1}, 1, ""), "would hold more than"});
  all.push_back({"dims", fake_tensor({~std::uint64_t{0}, 3, 1, 1}, 1, ""), "a size of -1"});
  all.push_back({"dims", fake_tensor(std::vector<std::uint64_t>(9, 1), 1, ""), "9 dimensions"});
  all.push_back(
      {"short", fake_tensor({4, 3, 1, 1}, 1, bytes(9, "1234")), "1 numbers instead of 12"});
  all.push_back({"odd", fake_tensor({1}, 1, bytes(9, "12345")), "instead of 1"});
  all.push_back({"half", fake_tensor({4, 3, 1, 1}, 10, number(5, 0)), "1 numbers instead of 12"});
  all.push_back({"text", fake_tensor({1}, 8, bytes(6, "x")), "not numbers"});
  all.push_back({"elsewhere", fake_tensor({1}, 1, number(14, 1)), "a file of its own"});
  all.push_back({"channels",
                 graph(node("Conv", {"images", "w"}, {"out"}) +
                       bytes(5, tensor("w", {4, 2, 1, 3}, std::vector<float>(24, 1)))),
                 "takes 2 channels and gets 3"});
  all.push_back({"window",
                 graph(node("Conv", {"images", "w"}, {"out"}, ints("kernel_shape", {3, 3})) +
                       bytes(5, tensor("w", {4, 3, 1, 1}, twelve(1)))),
                 "another size than its window"});
  all.push_back({"bias",
                 graph(node("Conv", {"images", "w", "b"}, {"out"}) + kWeights +
                       bytes(5, tensor("b", {3}, {1, 2, 3}))),
                 "bias"});
  // Inputs.
  all.push_back({"input",
                 graph(node("Relu", {"images"}, {"out"}),
                       bytes(11, value_info("images", {1, 3, kHuge, kHuge}))),
                 "would hold more than"});
  all.push_back(
      {"batch",
       graph(node("Relu", {"images"}, {"out"}), bytes(11, value_info("images", {4, 3, 64, 64}))),
       "was exported for batches of 4; export it with batch 1"});
  all.push_back(
      {"flat", graph(node("Relu", {"images"}, {"out"}), bytes(11, value_info("images", {1, 100}))),
       "input of 2 dimensions"});
  all.push_back(
      {"last",
       graph(node("Relu", {"images"}, {"out"}), bytes(11, value_info("images", {1, 64, 64, 3}))),
       "channels first"});
  all.push_back(
      {"grey",
       graph(node("Relu", {"images"}, {"out"}), bytes(11, value_info("images", {1, 1, 64, 64}))),
       "1 channels instead of 3"});
  all.push_back({"two inputs",
                 graph(node("Add", {"images", "more"}, {"out"}),
                       kImages + bytes(11, value_info("more", {1, 3, 0, 0}))),
                 "has 2 inputs"});
  all.push_back({"none", graph(node("Relu", {"w"}, {"out"}) + kWeights, ""), "has 0 inputs"});
  return all;
}

class CraftedNetworks : public testing::TestWithParam<const char*> {
 protected:
  /// What load_network(), or the first look, says.
  static std::string answer_to(const std::string& onnx) {
    const auto file =
        std::filesystem::temp_directory_path() / fmt::format("ydd_crafted_{}.onnx", ::getpid());
    testing_onnx::write(file, onnx);
    auto session = load_network(file, {.backend = parse_choice<Backend>(GetParam()).value(),
                                       .input_width_px = 64,
                                       .input_height_px = 64});
    std::filesystem::remove(file);
    if (!session) return session.error().message;
    const std::vector<float> grey(std::size_t{3} * 64 * 64, 0.5F);
    const auto outputs = (*session)->run({{1, 3, 64, 64}, grey});
    return outputs ? "runs" : outputs.error().message;
  }
};

TEST_P(CraftedNetworks, AreRefusedInOneLineThatSaysWhy) {
  testing::internal::CaptureStderr();
  for (const Crafted& c : crafted()) {
    const std::string answer = answer_to(c.onnx);
    EXPECT_THAT(answer, HasSubstr(c.message)) << c.name;
    EXPECT_EQ(answer.find('\n'), std::string::npos) << c.name;
    EXPECT_LT(answer.size(), 400U) << c.name;
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// Whatever a byte becomes, the answer is a line or a result.
TEST_P(CraftedNetworks, OfAnyOneByteDoNotCrash) {
  const std::string whole = convolution(ints("kernel_shape", {1, 1}) + ints("strides", {1, 1}) +
                                        ints("pads", {0, 0, 0, 0}) + ints("dilations", {1, 1}) +
                                        GraphWriter::integer("group", 1));
  const std::string sound = answer_to(whole);
  for (const char* const absent : {"oneDNN has no kernels", "no oneDNN"}) {
    if (sound.find(absent) != std::string::npos) GTEST_SKIP() << sound;
  }
  ASSERT_EQ(sound, "runs");
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      std::string broken = whole;
      broken[at] = static_cast<char>(value);
      EXPECT_EQ(answer_to(broken).find('\n'), std::string::npos) << at << " " << value;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(By, CraftedNetworks, testing::Values("opencv", "onednn", "auto"),
                         [](const auto& tried) { return std::string(tried.param); });

TEST(OnnxSizes, AreThoseOfTheNetwork) {
  const auto read = read_onnx(testing_onnx::miniature_yolo_model());
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(check_sizes(*read, {1, 3, 64, 96}).ok());
  EXPECT_TRUE(check_sizes(*read, {1, 3, 4096, 4096}).ok());
  const auto odd = check_sizes(*read, {1, 3, 65, 96});
  ASSERT_FALSE(odd.ok());
  EXPECT_THAT(odd.error().message, HasSubstr("different sizes"));
  const auto large = check_sizes(*read, {1, 3, 1 << 15, 1 << 15});
  ASSERT_FALSE(large.ok());
  EXPECT_THAT(large.error().message, HasSubstr("would hold more than 268435456 numbers"));
}

}  // namespace
}  // namespace ydd
