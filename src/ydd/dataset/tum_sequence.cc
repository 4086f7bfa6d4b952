// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/tum_sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "ydd/dataset/association.h"
#include "ydd/dataset/text_table.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

struct StampedFiles {
  std::vector<Timestamp> stamps;
  std::vector<fs::path> files;
};

/// rgb.txt or depth.txt.
Result<StampedFiles> read_list(const fs::path& folder, const std::string& name) {
  const fs::path list = folder / name;
  if (!fs::exists(list)) {
    return Error{fmt::format(
        "{}: has no {}; a sequence is a folder with rgb.txt and depth.txt (TUM RGB-D layout)",
        folder.string(), name)};
  }
  const Result<TextTable> table = read_text_table(list);
  if (!table) return table.error();
  StampedFiles result;
  for (const TextRow& row : table->rows) {
    if (row.fields.size() != 2) {
      return row_error(list, row, "expected 'timestamp file', found " + quoted(row));
    }
    const auto stamp =
        row_stamp(list, *table, row, result.stamps.empty() ? nullptr : &result.stamps.back());
    if (!stamp) return stamp.error();
    result.stamps.push_back(*stamp);
    result.files.push_back(folder / row.fields[1]);
  }
  if (result.files.empty()) return Error{fmt::format("{}: lists no image", list.string())};
  return result;
}

double smallest_difference_s(const std::vector<Timestamp>& a, const std::vector<Timestamp>& b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Timestamp stamp : a) {
    smallest = std::min(smallest, std::abs(seconds_between(stamp, b[nearest_index(b, stamp)])));
  }
  return smallest;
}

Result<std::vector<SequenceEntry>> pair_by_time(const fs::path& folder, double max_difference_s) {
  const Result<StampedFiles> colour = read_list(folder, "rgb.txt");
  if (!colour) return colour.error();
  const Result<StampedFiles> depth = read_list(folder, "depth.txt");
  if (!depth) return depth.error();
  std::vector<SequenceEntry> entries;
  for (const auto& [c, d] : associate(colour->stamps, depth->stamps, max_difference_s)) {
    entries.push_back({colour->stamps[c], depth->stamps[d], colour->files[c], depth->files[d]});
  }
  if (entries.empty()) {
    return Error{fmt::format(
        "{}: no colour image within {} s of a depth image (the closest two are {:.6f} s apart); "
        "check the stamps in rgb.txt and depth.txt or raise the tolerance",
        folder.string(), max_difference_s, smallest_difference_s(colour->stamps, depth->stamps))};
  }
  return entries;
}

Result<std::vector<SequenceEntry>> read_associations(const fs::path& folder, const fs::path& file) {
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  std::vector<SequenceEntry> entries;
  for (const TextRow& row : table->rows) {
    if (row.fields.size() != 4) {
      return row_error(file, row, "expected 'timestamp file timestamp file', found " + quoted(row));
    }
    const auto stamp =
        row_stamp(file, *table, row, entries.empty() ? nullptr : &entries.back().stamp);
    if (!stamp) return stamp.error();
    const auto depth_stamp = field_stamp(file, *table, row, 2);
    if (!depth_stamp) return depth_stamp.error();
    entries.push_back({*stamp, *depth_stamp, folder / row.fields[1], folder / row.fields[3]});
  }
  if (entries.empty()) return Error{fmt::format("{}: lists no image", file.string())};
  return entries;
}

Error size_error(const fs::path& file, std::size_t frame, int width, int height,
                 const std::string& expected) {
  return Error{
      fmt::format("{}: frame {} is {}x{} but {}", file.string(), frame, width, height, expected)};
}

}  // namespace

void SequenceOptions::describe(OptionTable& table) {
  table.add("max_difference", max_difference_s, {1e-6, 10.0}, "s",
            "a colour and a depth image farther apart in time are no pair");
  table.add("associations", associations, {},
            "file with 'time colour time depth' lines to use instead of pairing by time");
  table.add("first_frame", first_frame, {0, 1'000'000'000}, "frames",
            "leave out so many frames at the beginning");
  table.add("max_frames", max_frames, {0, 1'000'000'000}, "frames",
            "stop after so many frames; 0: at the end");
}

Result<Sequence> Sequence::open(const fs::path& folder, const SequenceOptions& options) {
  if (!fs::exists(folder)) return Error{fmt::format("{}: no such folder", folder.string())};
  if (!fs::is_directory(folder)) {
    return Error{fmt::format("{}: is not a folder; give the one that holds rgb.txt and depth.txt",
                             folder.string())};
  }
  auto entries = options.associations.empty() ? pair_by_time(folder, options.max_difference_s)
                                              : read_associations(folder, options.associations);
  if (!entries) return entries.error();
  Sequence sequence;
  sequence.folder_ = folder;
  sequence.entries_ = *std::move(entries);
  if (options.first_frame > 0) {
    if (static_cast<std::size_t>(options.first_frame) >= sequence.size()) {
      return Error{fmt::format("{}: has {} frames, none of them is number {}", folder.string(),
                               sequence.size(), options.first_frame)};
    }
    sequence.entries_.erase(sequence.entries_.begin(),
                            sequence.entries_.begin() + options.first_frame);
  }
  const auto most = static_cast<std::size_t>(std::max(0, options.max_frames));
  if (most > 0 && sequence.size() > most) {
    sequence.entries_.erase(sequence.entries_.begin() + static_cast<std::ptrdiff_t>(most),
                            sequence.entries_.end());
  }
  const fs::path truth = folder / "groundtruth.txt";
  if (fs::exists(truth)) sequence.groundtruth_file_ = truth;
  return sequence;
}

std::string Sequence::name() const {
  std::error_code failure;
  const fs::path resolved = fs::weakly_canonical(folder_, failure);
  return resolved.has_filename() ? resolved.filename().string()
                                 : resolved.parent_path().filename().string();
}

Result<RgbdFrame> Sequence::read(std::size_t i, const Camera& camera) const {
  const SequenceEntry& e = entries_.at(i);
  Result<ColourImage> colour = load_colour(e.colour_file);
  if (!colour) return colour.error();
  Result<DepthImage> depth_m = load_depth(e.depth_file, camera);
  if (!depth_m) return depth_m.error();
  if (depth_m->width() != colour->width() || depth_m->height() != colour->height()) {
    return size_error(e.depth_file, i, depth_m->width(), depth_m->height(),
                      fmt::format("its colour image is {}x{}; depth must be registered to colour",
                                  colour->width(), colour->height()));
  }
  if (colour->width() != camera.width_px || colour->height() != camera.height_px) {
    return size_error(e.colour_file, i, colour->width(), colour->height(),
                      fmt::format("camera '{}' is {}x{}; give the right one with --camera",
                                  camera.name, camera.width_px, camera.height_px));
  }
  GreyImage grey = to_grey(*colour);
  return RgbdFrame{static_cast<std::int64_t>(i), e.stamp, std::move(grey), *std::move(colour),
                   *std::move(depth_m)};
}

}  // namespace ydd
