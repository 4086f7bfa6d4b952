// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/tum_sequence.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ydd/dataset/association.h"
#include "ydd/dataset/depth_offset.h"
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

/// Seconds, or nothing for "auto".
Result<std::optional<double>> parse_depth_offset(const std::string& text) {
  if (text == "auto") return std::optional<double>();
  constexpr double kMost_s = 1e6;
  double seconds = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seconds);
  if (error == std::errc() && stop == end && std::abs(seconds) <= kMost_s) {
    return std::optional(seconds);
  }
  return Error{fmt::format(
      "sequence.depth_offset (--depth-offset): expected seconds (at most {:g}) or 'auto', found "
      "'{}'",
      kMost_s, text)};
}

Result<double> find_depth_offset_s(const StampedFiles& colour, const StampedFiles& depth) {
  const auto read_grey = [&](std::size_t i) -> Result<GreyImage> {
    const Result<ColourImage> image = load_colour(colour.files[i]);
    if (!image) return image.error();
    return to_grey(*image);
  };
  const auto read_depth = [&](std::size_t i) { return load_raw_depth(depth.files[i]); };
  return estimate_depth_offset_s(colour.stamps, depth.stamps, {read_grey, read_depth});
}

struct Paired {
  std::vector<SequenceEntry> entries;
  std::optional<Pairing> pairing;
};

Result<Paired> pair_by_time(const fs::path& folder, const SequenceOptions& options) {
  const Result<std::optional<double>> given_s = parse_depth_offset(options.depth_offset);
  if (!given_s) return given_s.error();
  const Result<StampedFiles> colour = read_list(folder, "rgb.txt");
  if (!colour) return colour.error();
  const Result<StampedFiles> depth = read_list(folder, "depth.txt");
  if (!depth) return depth.error();
  const Result<double> offset_s =
      *given_s ? Result<double>(**given_s) : find_depth_offset_s(*colour, *depth);
  if (!offset_s) return Error{fmt::format("{}: {}", folder.string(), offset_s.error().message)};
  std::vector<Timestamp> shifted = depth->stamps;
  for (Timestamp& stamp : shifted) stamp.ns += std::llround(*offset_s * 1e9);
  const double tolerance_s = options.max_difference_s;
  const std::vector<IndexPair> pairs = associate(colour->stamps, shifted, tolerance_s);
  if (pairs.empty()) {
    return Error{fmt::format(
        "{}: no colour image within {} s of a depth image (the closest two are {:.6f} s apart); "
        "check the stamps in rgb.txt and depth.txt, or give --depth-offset or --max-difference",
        folder.string(), tolerance_s, smallest_difference_s(colour->stamps, shifted))};
  }
  Paired out;
  for (const auto& [c, d] : pairs) {
    out.entries.push_back({colour->stamps[c], shifted[d], colour->files[c], depth->files[d]});
  }
  out.pairing = judge_pairing(colour->stamps, shifted, pairs, tolerance_s, *offset_s);
  return out;
}

Result<Paired> read_associations(const fs::path& folder, const fs::path& file) {
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
  return Paired{std::move(entries), std::nullopt};
}

Error size_error(const fs::path& file, std::size_t frame, int width, int height,
                 const std::string& expected) {
  return Error{
      fmt::format("{}: frame {} is {}x{} but {}", file.string(), frame, width, height, expected)};
}

}  // namespace

void SequenceOptions::describe(OptionTable& table) {
  table.add("max_difference_s", max_difference_s, {1e-6, 10.0}, "s",
            "a colour and a depth image farther apart in time are no pair");
  table.add("associations", associations, {},
            "file with 'time colour time depth' lines to use instead of pairing by time");
  table.add("depth_offset", depth_offset, {},
            "seconds to add to the stamps of depth images before pairing by time; auto: found by "
            "laying edges of depth over the colour images");
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
  Result<Paired> paired = options.associations.empty()
                              ? pair_by_time(folder, options)
                              : read_associations(folder, options.associations);
  if (!paired) return paired.error();
  Sequence sequence;
  sequence.folder_ = folder;
  sequence.entries_ = std::move(paired->entries);
  sequence.pairing_ = paired->pairing;
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
  const Result<ImageFile> colour_file = open_colour(e.colour_file);
  if (!colour_file) return colour_file.error();
  const Result<ImageFile> depth_file = open_depth(e.depth_file);
  if (!depth_file) return depth_file.error();
  const ImageHeader& c = colour_file->header;
  const ImageHeader& d = depth_file->header;
  if (d.width_px != c.width_px || d.height_px != c.height_px) {
    return size_error(e.depth_file, i, d.width_px, d.height_px,
                      fmt::format("its colour image is {}x{}; depth must be registered to colour",
                                  c.width_px, c.height_px));
  }
  if (c.width_px != camera.width_px || c.height_px != camera.height_px) {
    return size_error(e.colour_file, i, c.width_px, c.height_px,
                      fmt::format("camera '{}' is {}x{}; give the right one with --camera",
                                  camera.name, camera.width_px, camera.height_px));
  }
  Result<ColourImage> colour = decode_colour(*colour_file);
  if (!colour) return colour.error();
  Result<DepthImage> depth_m = decode_depth(*depth_file, camera);
  if (!depth_m) return depth_m.error();
  GreyImage grey = to_grey(*colour);
  return RgbdFrame{static_cast<std::int64_t>(i), e.stamp, std::move(grey), *std::move(colour),
                   *std::move(depth_m)};
}

}  // namespace ydd
