// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/picture_lists.h"

#include <utility>

#include <fmt/format.h>

#include "ydd/dataset/text_table.h"
#include "ydd/dataset/trajectory.h"

namespace ydd::sources {

namespace fs = std::filesystem;

Result<std::vector<PictureEntry>> read_picture_list(const fs::path& folder, const std::string& name,
                                                    const std::string& hint) {
  const fs::path list = folder / name;
  if (!fs::exists(list))
    return Error{fmt::format("{}: has no {}; {}", folder.string(), name, hint)};
  const Result<TextTable> table = read_text_table(list);
  if (!table) return table.error();
  std::vector<PictureEntry> result;
  for (const TextRow& row : table->rows) {
    if (row.fields.size() != 2) {
      return row_error(list, row, "expected 'timestamp file', found " + quoted(row));
    }
    const auto stamp =
        row_stamp(list, *table, row, result.empty() ? nullptr : &result.back().stamp);
    if (!stamp) return stamp.error();
    result.push_back({*stamp, (folder / row.fields[1]).string()});
  }
  if (result.empty()) return Error{fmt::format("{}: lists no image", list.string())};
  return result;
}

Result<Recording> read_associations(const fs::path& folder, const fs::path& file,
                                    FirstPicture first) {
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  const std::size_t colour = first == FirstPicture::colour ? 0 : 2, depth = 2 - colour;
  Recording out;
  out.pairs.emplace();
  for (const TextRow& row : table->rows) {
    if (row.fields.size() != 4) {
      return row_error(file, row, "expected 'timestamp file timestamp file', found " + quoted(row));
    }
    const auto stamp = row_stamp(file, *table, row,
                                 out.colour.empty() ? nullptr : &out.colour.back().stamp, colour);
    if (!stamp) return stamp.error();
    const auto depth_stamp = field_stamp(file, *table, row, depth);
    if (!depth_stamp) return depth_stamp.error();
    out.pairs->push_back({out.colour.size(), out.depth.size()});
    out.colour.push_back({*stamp, (folder / row.fields[colour + 1]).string()});
    out.depth.push_back({*depth_stamp, (folder / row.fields[depth + 1]).string()});
  }
  if (out.colour.empty()) return Error{fmt::format("{}: lists no image", file.string())};
  return out;
}

std::optional<GroundTruth> tum_groundtruth(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  return GroundTruth{file, true, [file] { return read_tum_trajectory(file); }};
}

}  // namespace ydd::sources
