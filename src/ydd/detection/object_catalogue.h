// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ydd/base/result.h"

namespace ydd {

/// How a class moves, coarse.
enum class Category { dynamic, potentially_dynamic, stationary };

/// How a class moves and how deep it is: the eight kinds of the method (docs/method.md, section 2).
enum class Subcategory { person, head, hand, automatic, small, medium, large, stationary };
inline constexpr int kSubcategoryCount = 8;  ///< how many values Subcategory has

/// person, head, hand, automatic: dynamic; small, medium, large: potentially dynamic.
Category category_of(Subcategory subcategory);
/// As written in the table: "person", ..., "static".
std::string_view to_string(Subcategory subcategory);
/// "dynamic", "potentially dynamic", "static".
std::string_view to_string(Category category);
/// Inverse of to_string; nothing for any other text.
std::optional<Subcategory> parse_subcategory(std::string_view text);

/// Extents along the optical axis, metres.
struct DepthExtents {
  double head_m = 0.20;       ///< of a head
  double hand_m = 0.18;       ///< of a hand
  double half_hand_m = 0.50;  ///< head centre to an outstretched elbow
  double automatic_m = 0.70;  ///< of what moves by itself, where its class has none of its own
  double small_m = 0.20;      ///< of a cup, a bottle, a book
  double medium_m = 0.45;     ///< of a keyboard, a laptop, a backpack
  double large_m = 0.70;      ///< of a chair, a screen, a suitcase
  friend bool operator==(const DepthExtents&, const DepthExtents&) = default;
};

/// Order of class names in which neither case nor '_' and '-' for a blank make a difference:
/// "Cell_Phone" is "cell phone".
struct ClassNameLess {
  /// Names are found without making strings of them.
  using is_transparent = void;  // NOLINT(readability-identifier-naming): the standard's
  bool operator()(std::string_view a, std::string_view b) const;  ///< Whether `a` comes before `b`.
};

/// What the catalogue knows of one class.
struct ObjectClass {
  Subcategory subcategory = Subcategory::stationary;  ///< how it moves
  std::optional<double> extent_m;  ///< of this class; none: that of its subcategory
  friend bool operator==(const ObjectClass&, const ObjectClass&) = default;
};

/// The table from class names to the subcategories of the method. A value; a class that is not in
/// it is static. Names match as ClassNameLess has it.
///
/// The file, here with one class that has an extent of its own:
///
///     extents_m: {head: 0.20, hand: 0.18, half_hand: 0.50, automatic: 0.70,
///                 small: 0.20, medium: 0.45, large: 0.70}
///     classes:
///       person: [person, body]
///       automatic: [fan, {name: cat, extent_m: 0.4}]
///       small: [cup, bottle]
class ObjectCatalogue {
 public:
  ObjectCatalogue() = default;
  /// Of a table of one's own.
  ObjectCatalogue(const DepthExtents& extents,
                  std::map<std::string, ObjectClass, ClassNameLess> classes)
      : extents_(extents), classes_(std::move(classes)) {}

  /// The built-in table: COCO names, head, hand, and a few more; the same as configs/objects.yaml.
  static ObjectCatalogue defaults();

  /// Reads a table; it replaces the built-in one as a whole, but extents it does not name keep
  /// their defaults. Fails with one line "file:line: what to do" on unreadable YAML, an unknown key
  /// or subcategory, a class named twice, an extent outside (0, 10] m, and when no class is
  /// dynamic.
  static Result<ObjectCatalogue> load(const std::filesystem::path& file);
  /// The same from text; `source` starts the message of a failure.
  static Result<ObjectCatalogue> parse(const std::string& text, const std::string& source);

  /// Whether the class is in the table.
  bool knows(std::string_view class_name) const { return classes_.contains(class_name); }
  /// How a class moves; one that it does not know is `stationary`.
  Subcategory subcategory_of(std::string_view class_name) const;
  /// Whether its subcategory is `person`.
  bool is_person(std::string_view class_name) const {
    return subcategory_of(class_name) == Subcategory::person;
  }
  /// Extent along the optical axis; of a person `2 * half_hand`, of a static class 0.
  double extent_m(std::string_view class_name) const;
  /// By subcategory, where a class has none of its own.
  const DepthExtents& extents() const { return extents_; }
  /// By class name.
  const std::map<std::string, ObjectClass, ClassNameLess>& classes() const { return classes_; }

  friend bool operator==(const ObjectCatalogue&, const ObjectCatalogue&) = default;

 private:
  DepthExtents extents_;
  std::map<std::string, ObjectClass, ClassNameLess> classes_;
};

}  // namespace ydd
