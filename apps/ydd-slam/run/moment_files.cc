// SPDX-License-Identifier: Apache-2.0
#include "run/moment_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/files.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFolder = "moments";
constexpr const char* kList = "moments.json";

/// The entries of the list that name a file beside it.
std::vector<Json> listed(const fs::path& folder) {
  const auto text = read_file(folder / kList);
  const Result<Json> read = text ? parse_json(*text, kList) : Json();
  const Json json = read ? *read : Json();
  std::vector<Json> out;
  if (!json.is_array()) return out;
  for (const Json& entry : json) {
    if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) continue;
    const fs::path file = entry["file"].get<std::string>();
    if (file == file.filename()) out.push_back(entry);
  }
  return out;
}

void remove_old(const fs::path& folder) {
  std::error_code ignored;
  for (const Json& entry : listed(folder)) {
    fs::remove(folder / entry["file"].get<std::string>(), ignored);
  }
  fs::remove(folder / kList, ignored);
  fs::remove(folder, ignored);  // only if nothing else is in it
}

}  // namespace

Result<void> write_moments(const fs::path& run, const std::vector<FrameMoment>& moments) {
  const fs::path folder = run / kFolder;
  remove_old(folder);
  if (moments.empty()) return {};
  std::error_code error;
  fs::create_directories(folder, error);
  Json list = Json::array();
  for (const FrameMoment& m : moments) {
    const std::string name = fmt::format("{:06d}-{}.jpg", m.frame, m.kind);
    if (auto r = write_file_atomically(folder / name, m.moment.jpeg); !r) return r;
    list.push_back({{"frame", m.frame},
                    {"kind", m.kind},
                    {"caption", m.moment.caption},
                    {"wide", m.moment.wide},
                    {"file", name}});
  }
  return write_file_atomically(folder / kList, json_text(list, 1) + "\n");
}

std::vector<KeyMoment> read_moments(const fs::path& run) {
  const fs::path folder = run / kFolder;
  std::vector<KeyMoment> out;
  for (const Json& entry : listed(folder)) {
    Result<std::string> jpeg = read_file(folder / entry["file"].get<std::string>());
    if (!jpeg) continue;
    const bool wide = entry.contains("wide") && entry["wide"] == true;
    const Json caption = entry.value("caption", Json(""));
    out.push_back({caption.is_string() ? caption.get<std::string>() : "", *std::move(jpeg), wide});
  }
  return out;
}

}  // namespace ydd::app
