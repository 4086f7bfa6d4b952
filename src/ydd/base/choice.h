// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

namespace ydd {

/// An enumeration whose values have names in files and on the command line. Beside it stands
///
///     constexpr std::array<std::string_view, 2> choices_of(Lens) { return {"pinhole", "fisheye"};
///     }
///
/// with the names in the order of the values, which count from 0.
template <class E>
concept Choice = std::is_enum_v<E> && requires(E value) {
  { choices_of(value).size() } -> std::convertible_to<std::size_t>;
};

/// The value's name, as in files and on the command line.
template <Choice E>
constexpr std::string_view to_string(E value) {
  return choices_of(value)[static_cast<std::size_t>(value)];
}

/// Nothing when no value has that name.
template <Choice E>
constexpr std::optional<E> parse_choice(std::string_view name) {
  const auto names = choices_of(E{});
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<E>(i);
  }
  return std::nullopt;
}

}  // namespace ydd
