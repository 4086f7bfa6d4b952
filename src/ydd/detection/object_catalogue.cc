// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/object_catalogue.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

constexpr std::array<std::string_view, kSubcategoryCount> kNames = {
    "person", "head", "hand", "automatic", "small", "medium", "large", "static"};

constexpr double kLargestExtent_m = 10.0;

struct NamedExtent {
  std::string_view name;
  double DepthExtents::*member;
};
constexpr std::array<NamedExtent, 7> kExtents = {{{"head", &DepthExtents::head_m},
                                                  {"hand", &DepthExtents::hand_m},
                                                  {"half_hand", &DepthExtents::half_hand_m},
                                                  {"automatic", &DepthExtents::automatic_m},
                                                  {"small", &DepthExtents::small_m},
                                                  {"medium", &DepthExtents::medium_m},
                                                  {"large", &DepthExtents::large_m}}};

/// The built-in table, in the order of the subcategories; configs/objects.yaml says the same.
using ClassNames = std::vector<std::string_view>;
std::array<ClassNames, kSubcategoryCount> default_names() {
  return {{
      {"person", "body", "pedestrian", "human", "people", "man", "woman", "child", "boy", "girl",
       "rider", "worker"},
      {"head", "face", "human head", "human face"},
      {"hand", "human hand", "left hand", "right hand", "fist"},
      {"fan", "robot", "cat", "dog", "bird", "horse", "sheep", "cow", "elephant", "bear", "zebra",
       "giraffe"},
      {"cup",     "mug",          "bottle",    "wine glass",  "bowl",           "fork",
       "knife",   "spoon",        "book",      "mouse",       "remote",         "cell phone",
       "phone",   "mobile phone", "cellphone", "scissors",    "hair drier",     "toothbrush",
       "tie",     "banana",       "apple",     "orange",      "sandwich",       "carrot",
       "hot dog", "donut",        "frisbee",   "sports ball", "baseball glove", "glasses",
       "pen"},
      {"keyboard", "laptop", "backpack", "handbag", "umbrella", "teddy bear", "vase", "toaster",
       "cake", "pizza", "broccoli", "skateboard", "tennis racket", "baseball bat", "kite", "bag",
       "box"},
      {"chair", "tv", "monitor", "suitcase", "microwave", "snowboard", "skis", "surfboard",
       "bicycle", "potted plant", "television", "tvmonitor", "pottedplant", "stool", "trolley"},
      {"desk",   "dining table", "diningtable", "sofa",         "table",  "couch", "bed",
       "toilet", "oven",         "sink",        "refrigerator", "bench",  "clock", "lamp",
       "shelf",  "plant",        "poster",      "door",         "window", "wall",  "floor"},
  }};
}

Result<double> parse_extent(const YAML::Node& node, const std::string& source) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !(value > 0) ||
      !(value <= kLargestExtent_m)) {
    return Error{fmt::format("{}: an extent must be a number above 0 and at most {} m",
                             yaml_line(source, node), kLargestExtent_m)};
  }
  return value;
}

Result<DepthExtents> parse_extents(const YAML::Node& node, const std::string& source) {
  DepthExtents extents;
  if (!node) return extents;
  if (!node.IsMap()) {
    return Error{yaml_line(source, node) + ": 'extents_m' must hold 'name: metres' pairs"};
  }
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    double DepthExtents::*member = nullptr;
    std::vector<std::string_view> known;
    for (const NamedExtent& extent : kExtents) {
      known.push_back(extent.name);
      if (extent.name == name) member = extent.member;
    }
    if (member == nullptr) {
      return Error{fmt::format("{}: unknown extent '{}'; known are {}",
                               yaml_line(source, entry.first), on_one_line(name),
                               fmt::join(known, ", "))};
    }
    Result<double> value = parse_extent(entry.second, source);
    if (!value) return value.error();
    extents.*member = *value;
  }
  return extents;
}

/// One entry of a list of classes: a name, or {name: ..., extent_m: ...}.
Result<std::pair<std::string, std::optional<double>>> parse_class(const YAML::Node& node,
                                                                  const std::string& source) {
  std::pair<std::string, std::optional<double>> out;
  if (node.IsScalar()) {
    out.first = node.Scalar();
    return out;
  }
  const Error wrong{yaml_line(source, node) +
                    ": a class must be a name or {name: NAME, extent_m: METRES}"};
  if (!node.IsMap()) return wrong;
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    if (key == "name" && entry.second.IsScalar()) {
      out.first = entry.second.Scalar();
    } else if (key == "extent_m") {
      Result<double> value = parse_extent(entry.second, source);
      if (!value) return value.error();
      out.second = *value;
    } else {
      return wrong;
    }
  }
  if (out.first.empty()) return wrong;
  return out;
}

using Classes = std::map<std::string, ObjectClass, ClassNameLess>;

Result<void> add_classes(const YAML::Node& list, Subcategory subcategory, const std::string& source,
                         Classes& classes) {
  if (list.IsNull()) return {};
  if (!list.IsSequence()) {
    return Error{fmt::format("{}: '{}' must hold a list of class names", yaml_line(source, list),
                             to_string(subcategory))};
  }
  for (const YAML::Node& node : list) {
    auto entry = parse_class(node, source);
    if (!entry) return entry.error();
    const auto& [name, extent_m] = *entry;
    if (!classes.emplace(name, ObjectClass{subcategory, extent_m}).second) {
      return Error{fmt::format("{}: class '{}' is named twice, first as '{}'; keep one",
                               yaml_line(source, node), on_one_line(name),
                               to_string(classes.at(name).subcategory))};
    }
  }
  return {};
}

Result<Classes> parse_classes(const YAML::Node& node, const std::string& source) {
  Classes classes;
  for (const auto& entry : node) {
    const auto subcategory = parse_subcategory(entry.first.Scalar());
    if (!subcategory) {
      return Error{fmt::format("{}: unknown subcategory '{}'; known are {}",
                               yaml_line(source, entry.first), on_one_line(entry.first.Scalar()),
                               fmt::join(kNames, ", "))};
    }
    if (auto added = add_classes(entry.second, *subcategory, source, classes); !added) {
      return added.error();
    }
  }
  for (const auto& [name, object_class] : classes) {
    if (category_of(object_class.subcategory) == Category::dynamic) return classes;
  }
  return Error{source +
               ": no class is dynamic (person, head, hand or automatic); name at least one"};
}

Result<void> check_top_keys(const YAML::Node& root, const std::string& source) {
  if (!root.IsMap()) return Error{source + ": must hold 'classes:' and may hold 'extents_m:'"};
  for (const auto& entry : root) {
    const std::string key = entry.first.Scalar();
    if (key != "extents_m" && key != "classes") {
      return Error{fmt::format("{}: unknown key '{}'; known are extents_m, classes",
                               yaml_line(source, entry.first), on_one_line(key))};
    }
  }
  if (!root["classes"] || !root["classes"].IsMap()) {
    return Error{source + ": 'classes' must hold 'subcategory: [class names]' lines"};
  }
  return {};
}

Result<ObjectCatalogue> parse_catalogue(const YAML::Node& root, const std::string& source) {
  if (auto checked = check_top_keys(root, source); !checked) return checked.error();
  const Result<DepthExtents> extents = parse_extents(root["extents_m"], source);
  if (!extents) return extents.error();
  Result<Classes> classes = parse_classes(root["classes"], source);
  if (!classes) return classes.error();
  return ObjectCatalogue(*extents, std::move(*classes));
}

char folded(char c) {
  if (c == '_' || c == '-') return ' ';
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

}  // namespace

bool ClassNameLess::operator()(std::string_view a, std::string_view b) const {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](char x, char y) { return folded(x) < folded(y); });
}

Category category_of(Subcategory subcategory) {
  switch (subcategory) {
    case Subcategory::person:
    case Subcategory::head:
    case Subcategory::hand:
    case Subcategory::automatic:
      return Category::dynamic;
    case Subcategory::small:
    case Subcategory::medium:
    case Subcategory::large:
      return Category::potentially_dynamic;
    case Subcategory::stationary:
      break;
  }
  return Category::stationary;
}

std::string_view to_string(Subcategory subcategory) {
  return kNames[static_cast<std::size_t>(subcategory)];
}

std::string_view to_string(Category category) {
  static constexpr std::array<std::string_view, 3> kCategoryNames = {
      "dynamic", "potentially dynamic", "static"};
  return kCategoryNames[static_cast<std::size_t>(category)];
}

std::optional<Subcategory> parse_subcategory(std::string_view text) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == text) return static_cast<Subcategory>(i);
  }
  return std::nullopt;
}

ObjectCatalogue ObjectCatalogue::defaults() {
  ObjectCatalogue catalogue;
  const auto names = default_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const std::string_view name : names[i]) {
      catalogue.classes_.emplace(name, ObjectClass{static_cast<Subcategory>(i), std::nullopt});
    }
  }
  return catalogue;
}

Result<ObjectCatalogue> ObjectCatalogue::load(const std::filesystem::path& file) {
  const Result<YAML::Node> root = read_yaml(file);
  if (!root) return root.error();
  return parse_catalogue(*root, file.string());
}

Result<ObjectCatalogue> ObjectCatalogue::parse(const std::string& text, const std::string& source) {
  const Result<YAML::Node> root = parse_yaml(text, source);
  if (!root) return root.error();
  return parse_catalogue(*root, source);
}

Subcategory ObjectCatalogue::subcategory_of(std::string_view class_name) const {
  const auto found = classes_.find(class_name);
  return found == classes_.end() ? Subcategory::stationary : found->second.subcategory;
}

double ObjectCatalogue::extent_m(std::string_view class_name) const {
  const auto found = classes_.find(class_name);
  if (found == classes_.end()) return 0;
  if (found->second.extent_m) return *found->second.extent_m;
  switch (found->second.subcategory) {
    case Subcategory::person:
      return 2 * extents_.half_hand_m;
    case Subcategory::head:
      return extents_.head_m;
    case Subcategory::hand:
      return extents_.hand_m;
    case Subcategory::automatic:
      return extents_.automatic_m;
    case Subcategory::small:
      return extents_.small_m;
    case Subcategory::medium:
      return extents_.medium_m;
    case Subcategory::large:
      return extents_.large_m;
    case Subcategory::stationary:
      break;
  }
  return 0;
}

}  // namespace ydd
