// SPDX-License-Identifier: Apache-2.0
#include "ydd/paper/paper_sequences.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

#include <fmt/format.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 6;

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Folders that hold a sequence, whatever their name. Nothing is looked for inside of one.
void gather(const fs::path& folder, int depth, std::vector<fs::path>& out) {
  std::error_code failure;
  if (fs::exists(folder / "rgb.txt", failure)) {
    out.push_back(folder);
    return;
  }
  if (depth == kDeepest) return;
  fs::directory_iterator entries(folder, fs::directory_options::skip_permission_denied, failure);
  for (; !failure && entries != fs::directory_iterator(); entries.increment(failure)) {
    std::error_code unknown;
    if (entries->is_directory(unknown)) gather(entries->path(), depth + 1, out);
  }
}

/// As the user calls it: a link has its own name.
std::string name_of(const fs::path& folder) {
  std::error_code failure;
  const fs::path whole = fs::absolute(folder, failure).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace

const std::vector<std::string>& article_sequences() {
  static const std::vector<std::string> names{"fr3_walking_xyz", "fr3_walking_rpy",
                                              "fr3_walking_halfsphere", "fr3_walking_static",
                                              "fr3_sitting_static"};
  return names;
}

std::optional<double> published_duration_s(std::string_view name) {
  // Of the benchmark's download page, in the order of the names.
  constexpr double kDurations_s[] = {28.83, 30.61, 35.81, 24.83, 23.63};
  const auto& names = article_sequences();
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) return std::nullopt;
  return kDurations_s[at - names.begin()];
}

std::optional<std::string> sequence_name(std::string_view name) {
  // Longer names are nobody's, and a backtracking matcher calls itself for each letter.
  if (name.size() > 200) return std::nullopt;
  const std::string text = lower(name);
  if (text.find("validation") != std::string::npos) return std::nullopt;
  static const std::regex tum(
      "(?:freiburg|fr)3_(w|walk|walking|s|sit|sitting)_(xyz|rpy|halfsphere|half|static)(?![a-z])");
  std::smatch match;
  if (std::regex_search(text, match, tum)) {
    const std::string path = match.str(2) == "half" ? "halfsphere" : match.str(2);
    return fmt::format("fr3_{}_{}", match.str(1).front() == 'w' ? "walking" : "sitting", path);
  }
  const std::size_t bonn = text.find("bonn_");
  if (bonn != std::string::npos && text.size() > bonn + 5) return text.substr(bonn);
  return std::nullopt;
}

Result<FoundSequences> find_paper_sequences(const fs::path& data) {
  std::error_code failure;
  if (!fs::is_directory(data, failure)) {
    return Error{fmt::format("{}: no folder that can be read", data.string())};
  }
  std::vector<fs::path> folders;
  gather(data, 0, folders);
  std::sort(folders.begin(), folders.end());
  FoundSequences found;
  std::map<std::string, fs::path> by_name;
  for (const fs::path& folder : folders) {
    const auto name = sequence_name(name_of(folder));
    if (name && !by_name.emplace(*name, folder).second) found.duplicates.push_back(folder);
  }
  for (const std::string& name : article_sequences()) {
    if (!by_name.contains(name)) found.missing.push_back(name);
  }
  const auto add = [&](auto belongs) {
    for (const auto& [name, folder] : by_name) {
      if (belongs(name)) found.sequences.push_back({name, folder, false});
    }
  };
  for (const std::string& name : article_sequences()) {
    add([&](const std::string& other) { return other == name; });
  }
  const auto is_article = [](const std::string& name) {
    const auto& names = article_sequences();
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  add([&](const std::string& name) { return name.starts_with("fr3") && !is_article(name); });
  add([&](const std::string& name) { return name.starts_with("bonn"); });
  return found;
}

}  // namespace ydd
