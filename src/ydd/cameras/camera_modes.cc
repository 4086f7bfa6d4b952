// SPDX-License-Identifier: Apache-2.0
#include "ydd/cameras/camera_modes.h"

#include <algorithm>
#include <charconv>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ydd {
namespace {

constexpr CameraMode kUsual{640, 480, 30};

bool has_mode(const std::vector<CameraMode>& modes, const CameraMode& mode) {
  return std::find(modes.begin(), modes.end(), mode) != modes.end();
}

/// The smallest is the best.
auto distance_from_usual(const CameraMode& mode) {
  const bool too_large = mode.width_px > kUsual.width_px || mode.height_px > kUsual.height_px;
  const int pixels = mode.width_px * mode.height_px;
  const bool too_slow = mode.fps < kUsual.fps;
  return std::tuple(too_large, too_large ? pixels : -pixels, too_slow,
                    too_slow ? -mode.fps : mode.fps);
}

}  // namespace

std::string to_string(const CameraMode& mode) {
  return fmt::format("{}x{}@{}", mode.width_px, mode.height_px, mode.fps);
}

std::optional<CameraMode> parse_camera_mode(const std::string& text) {
  CameraMode mode;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto take = [&](int& value, char after) {
    const auto [stop, error] = std::from_chars(at, end, value);
    const bool ends = after == '\0' ? stop == end : stop != end && *stop == after;
    at = stop == end ? stop : stop + 1;
    return error == std::errc() && ends && value > 0 && value <= 100'000;
  };
  const bool ok = take(mode.width_px, 'x') && take(mode.height_px, '@') && take(mode.fps, '\0');
  return ok ? std::optional(mode) : std::nullopt;
}

std::string listed(std::vector<CameraMode> modes) {
  std::sort(modes.begin(), modes.end());
  modes.erase(std::unique(modes.begin(), modes.end()), modes.end());
  std::vector<std::string> names;
  for (const CameraMode& mode : modes) names.push_back(to_string(mode));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

Result<CameraMode> choose_camera_mode(const std::vector<CameraMode>& colour,
                                      const std::vector<CameraMode>& depth,
                                      const std::string& wanted) {
  if (!wanted.empty()) {
    const auto mode = parse_camera_mode(wanted);
    if (!mode) {
      return Error{fmt::format(
          "sequence.camera_mode (--mode): expected a mode such as 640x480@30, found '{}'", wanted)};
    }
    if (!has_mode(depth, *mode)) {
      return Error{
          fmt::format("has no depth in {} (--mode); there are: {}", wanted, listed(depth))};
    }
    if (!has_mode(colour, *mode)) {
      return Error{
          fmt::format("has no colour in {} (--mode); there are: {}", wanted, listed(colour))};
    }
    return *mode;
  }
  std::vector<CameraMode> both;
  for (const CameraMode& mode : colour) {
    if (has_mode(depth, mode)) both.push_back(mode);
  }
  if (both.empty()) {
    return Error{fmt::format("has no mode that colour ({}) and depth ({}) share", listed(colour),
                             listed(depth))};
  }
  return *std::min_element(both.begin(), both.end(), [](const CameraMode& a, const CameraMode& b) {
    return distance_from_usual(a) < distance_from_usual(b);
  });
}

}  // namespace ydd
