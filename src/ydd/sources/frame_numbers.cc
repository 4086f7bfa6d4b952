// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/frame_numbers.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/log.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

/// Nanoseconds of `count` units, unless they are later than any stamp.
std::optional<Timestamp> stamp_of(std::int64_t count, std::int64_t unit_ns) {
  if (count > kLatestStamp_s * (kSecond_ns / unit_ns)) return std::nullopt;
  return Timestamp{count * unit_ns};
}

/// What the name of a frame says; nothing: it is not one.
std::optional<NumberedFile> read_name(std::string_view name) {
  NumberedFile out;
  if (const std::size_t dash = name.find('-'); dash != std::string_view::npos) {
    const auto number = whole_number(name.substr(0, dash));
    const auto micros = whole_number(name.substr(dash + 1));
    if (!number || !micros) return std::nullopt;
    out.number = *number;
    out.stamp = stamp_of(*micros, 1000);
    return out.stamp ? std::optional(out) : std::nullopt;
  }
  if (name.find('.') != std::string_view::npos) {
    const bool plain = name.find_first_not_of("0123456789.") == std::string_view::npos;
    out.stamp = plain ? parse_timestamp(name) : std::nullopt;
    return out.stamp ? std::optional(out) : std::nullopt;
  }
  const auto number = whole_number(name);
  if (!number) return std::nullopt;
  out.number = *number;
  for (const auto& [digits, unit_ns] :
       {std::pair<std::size_t, std::int64_t>{13, 1'000'000}, {16, 1000}, {19, 1}}) {
    const bool is_time = name.size() == digits && name.front() != '0';
    if (is_time) out.stamp = stamp_of(*number, unit_ns);
  }
  const bool is_number = *number < 1'000'000'000;
  return is_number || out.stamp ? std::optional(out) : std::nullopt;
}

bool is_before(const NumberedFile& a, const NumberedFile& b) {
  return a.stamp && b.stamp && *a.stamp != *b.stamp ? *a.stamp < *b.stamp : a.number < b.number;
}

bool all_have_stamps(const std::vector<NumberedFile>& files) {
  return std::all_of(files.begin(), files.end(), [](const auto& f) { return f.stamp.has_value(); });
}

std::vector<PictureEntry> entries_of(const std::vector<NumberedFile>& files, bool by_time) {
  std::vector<PictureEntry> out;
  for (const NumberedFile& file : files) {
    out.push_back({by_time ? *file.stamp : frame_stamp(file.number), file.file.string()});
  }
  return out;
}

}  // namespace

Timestamp frame_stamp(std::int64_t number) { return {(number * kSecond_ns + 15) / 30}; }

void tell_frame_rate(const fs::path& place) {
  log::info("{}: says no times; frames are taken to be 1/30 s apart, by their numbers",
            place.string());
}

Result<std::vector<NumberedFile>> numbered_files(const fs::path& folder, std::string_view prefix,
                                                 const std::vector<std::string_view>& endings) {
  std::vector<NumberedFile> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    const auto ending = std::find_if(endings.begin(), endings.end(),
                                     [&](std::string_view e) { return name.ends_with(e); });
    if (ending == endings.end() || !name.starts_with(prefix) ||
        name.size() <= prefix.size() + ending->size()) {
      continue;
    }
    const std::string_view stem =
        std::string_view(name).substr(prefix.size(), name.size() - prefix.size() - ending->size());
    auto file = read_name(stem);
    if (!file) continue;
    file->file = entry.path();
    files.push_back(*std::move(file));
  }
  if (failure) return Error{fmt::format("{}: {}", folder.string(), failure.message())};
  if (files.empty()) {
    return Error{fmt::format("{}: holds no picture named '{}NUMBER{}'", folder.string(), prefix,
                             endings.front())};
  }
  const bool by_time = all_have_stamps(files);
  if (!by_time) {
    for (NumberedFile& file : files) file.stamp.reset();
  }
  std::sort(files.begin(), files.end(), is_before);
  const auto twice = std::adjacent_find(
      files.begin(), files.end(), [](const auto& a, const auto& b) { return !is_before(a, b); });
  if (twice != files.end()) {
    return Error{fmt::format("{}: is the same frame as {}", std::next(twice)->file.string(),
                             twice->file.filename().string())};
  }
  return files;
}

Result<Recording> recording_of(const fs::path& place, const std::vector<NumberedFile>& colour,
                               const std::vector<NumberedFile>& depth) {
  const bool by_time = all_have_stamps(colour) && all_have_stamps(depth);
  Recording out;
  out.colour = entries_of(colour, by_time);
  out.depth = entries_of(depth, by_time);
  if (by_time) return out;
  out.pairs.emplace();
  std::map<std::int64_t, std::size_t> depth_of;
  for (std::size_t i = 0; i < depth.size(); ++i) depth_of[depth[i].number] = i;
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const auto partner = depth_of.find(colour[i].number);
    if (partner != depth_of.end()) out.pairs->push_back({i, partner->second});
  }
  if (out.pairs->empty()) {
    return Error{fmt::format(
        "{}: no colour picture has the number of a depth picture ({} and {}, for example)",
        place.string(), colour.front().file.filename().string(),
        depth.front().file.filename().string())};
  }
  if (const std::size_t alone = colour.size() - out.pairs->size(); alone > 0) {
    log::warning(
        "{}: {} of {} colour pictures have no depth picture of their number, and are left out",
        place.string(), alone, colour.size());
  }
  tell_frame_rate(place);
  return out;
}

}  // namespace ydd::sources
