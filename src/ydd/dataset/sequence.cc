// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/sequence.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ydd/dataset/association.h"
#include "ydd/dataset/depth_offset.h"
#include "ydd/image/decode.h"

namespace ydd {
namespace {

namespace fs = std::filesystem;

std::vector<Timestamp> stream_stamps(const std::vector<PictureEntry>& pictures) {
  std::vector<Timestamp> stamps;
  stamps.reserve(pictures.size());
  for (const PictureEntry& picture : pictures) stamps.push_back(picture.stamp);
  return stamps;
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

Result<double> find_depth_offset_s(const Recording& recording) {
  const PictureStore& pictures = *recording.pictures;
  const auto read_grey = [&](std::size_t i) -> Result<GreyImage> {
    const Result<ColourPicture> picture = pictures.colour(i);
    if (!picture) return picture.error();
    const Result<ColourImage> image = picture->decode();
    if (!image) return image.error();
    return to_grey(*image);
  };
  const auto read_depth = [&](std::size_t i) -> Result<RawDepthImage> {
    const Result<DepthPicture> picture = pictures.depth(i);
    if (!picture) return picture.error();
    return picture->counts();
  };
  return estimate_depth_offset_s(stream_stamps(recording.colour), stream_stamps(recording.depth),
                                 {read_grey, read_depth});
}

struct Paired {
  std::vector<SequenceEntry> entries;
  std::optional<Pairing> pairing;
};

SequenceEntry entry_of(const Recording& recording, const IndexPair& pair,
                       std::int64_t depth_offset_ns) {
  const auto& [stamp, colour] = recording.colour[pair.a];
  const auto& [depth_stamp, depth] = recording.depth[pair.b];
  return {stamp, {depth_stamp.ns + depth_offset_ns}, pair.a, pair.b, colour, depth};
}

Result<Paired> pair_by_time(const Recording& recording, const SequenceOptions& options) {
  const std::string place = recording.place.string();
  const Result<std::optional<double>> given_s = parse_depth_offset(options.depth_offset);
  if (!given_s) return given_s.error();
  const Result<double> offset_s =
      *given_s ? Result<double>(**given_s) : find_depth_offset_s(recording);
  if (!offset_s) return Error{fmt::format("{}: {}", place, offset_s.error().message)};
  const std::int64_t offset_ns = std::llround(*offset_s * 1e9);
  const std::vector<Timestamp> colour = stream_stamps(recording.colour);
  std::vector<Timestamp> shifted = stream_stamps(recording.depth);
  for (Timestamp& stamp : shifted) stamp.ns += offset_ns;
  const double tolerance_s = options.max_difference_s;
  const std::vector<IndexPair> pairs = associate(colour, shifted, tolerance_s);
  if (pairs.empty()) {
    return Error{fmt::format(
        "{}: no colour image within {} s of a depth image (the closest two are {:.6f} s apart); "
        "check their stamps, or give --depth-offset or --max-difference",
        place, tolerance_s, smallest_difference_s(colour, shifted))};
  }
  Paired out;
  for (const IndexPair& pair : pairs) out.entries.push_back(entry_of(recording, pair, offset_ns));
  out.pairing = judge_pairing(colour, shifted, pairs, tolerance_s, *offset_s);
  return out;
}

Paired pair_as_told(const Recording& recording) {
  Paired out;
  for (const IndexPair& pair : *recording.pairs) {
    out.entries.push_back(entry_of(recording, pair, 0));
  }
  return out;
}

/// Leaves out what the options do not want.
Result<void> select(std::vector<SequenceEntry>& entries, const SequenceOptions& options,
                    const fs::path& place) {
  if (options.first_frame > 0) {
    if (static_cast<std::size_t>(options.first_frame) >= entries.size()) {
      return Error{fmt::format("{}: has {} frames, none of them is number {}", place.string(),
                               entries.size(), options.first_frame)};
    }
    entries.erase(entries.begin(), entries.begin() + options.first_frame);
  }
  const auto most = static_cast<std::size_t>(std::max(0, options.max_frames));
  if (most > 0 && entries.size() > most) {
    entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(most), entries.end());
  }
  return {};
}

Error size_error(const std::string& name, std::size_t frame, int width, int height,
                 const std::string& expected) {
  return Error{fmt::format("{}: frame {} is {}x{} but {}", name, frame, width, height, expected)};
}

Error gone(const Recording& recording) {
  return Error{fmt::format("{}: what a camera gave is not kept", recording.place.string())};
}

}  // namespace

std::string Recording::name() const {
  if (live) return source;
  std::error_code failure;
  const fs::path resolved = fs::weakly_canonical(place, failure);
  const fs::path last = resolved.has_filename() ? resolved : resolved.parent_path();
  return (fs::is_directory(last, failure) ? last.filename() : last.stem()).string();
}

void SequenceOptions::describe(OptionTable& table) {
  table.add("max_difference_s", max_difference_s, {1e-6, 10.0}, "s",
            "a colour and a depth image farther apart in time are no pair");
  table.add("associations", associations, {},
            "file with 'time colour time depth' lines to use instead of pairing by time");
  table.add("depth_offset", depth_offset, {},
            "seconds to add to the stamps of depth images before pairing by time; auto: found by "
            "laying edges of depth over the colour images");
  table.add("depth_shift", depth_shift, {},
            "how far depth lies to the right of colour and below it, RIGHT,DOWN in px; it is moved "
            "back. auto: found where edges of depth fit the colour images far better elsewhere");
  table.add("first_frame", first_frame, {0, 1'000'000'000}, "frames",
            "leave out so many frames at the beginning");
  table.add("max_frames", max_frames, {0, 1'000'000'000}, "frames",
            "stop after so many frames; 0: at the end");
  table.add("source", source, {},
            "layout of the recording (run --help lists them); empty: told by what lies there");
  table.add("topic_colour", topic_colour, {},
            "topic of a bag with the colour pictures; empty: told by encodings and names");
  table.add("topic_depth", topic_depth, {},
            "topic of a bag with depth, registered to colour; empty: told by encodings and names");
  table.add("topic_camera_info", topic_camera_info, {},
            "topic of a bag with the camera of colour; empty: the one beside it");
  table.add("camera_mode", camera_mode, {},
            "mode of a camera, such as 640x480@30 (ydd-slam cameras lists them); empty: chosen");
}

Result<Sequence> Sequence::of(Recording recording, const SequenceOptions& options) {
  if (recording.live) {
    Sequence sequence;
    sequence.recording_ = std::move(recording);
    sequence.options_ = options;
    // Nothing was seen yet that could tell it.
    const bool given = options.depth_shift != "auto";
    const Result<DepthShift> shift =
        given ? sequence.find_depth_shift(options.depth_shift) : Result(DepthShift());
    if (!shift) return shift.error();
    sequence.depth_shift_ = *shift;
    return sequence;
  }
  Result<Paired> paired =
      recording.pairs ? Result(pair_as_told(recording)) : pair_by_time(recording, options);
  if (!paired) return paired.error();
  Sequence sequence;
  sequence.recording_ = std::move(recording);
  sequence.entries_ = std::move(paired->entries);
  sequence.pairing_ = paired->pairing;
  sequence.options_ = options;
  // Of the whole recording, so that a part of it is read as all of it is.
  const Result<DepthShift> shift = sequence.find_depth_shift(options.depth_shift);
  if (!shift) return shift.error();
  sequence.depth_shift_ = *shift;
  if (auto r = select(sequence.entries_, options, sequence.place()); !r) return r.error();
  return sequence;
}

Result<DepthShift> Sequence::find_depth_shift(const std::string& asked) const {
  if (asked == "auto") {
    if (recording_.depth_is_laid) return DepthShift();
    return estimate_depth_shift(size(), [this](std::size_t i) -> Result<LaidPair> {
      const Result<ColourImage> colour = read_colour(i);
      if (!colour) return colour.error();
      Result<RawDepthImage> depth = read_depth_counts(i);
      if (!depth) return depth.error();
      return LaidPair{to_grey(*colour), *std::move(depth)};
    });
  }
  const Result<DepthShift> shift = parse_depth_shift(asked);
  if (shift) return *shift;
  return Error{"sequence.depth_shift (--depth-shift): " + shift.error().message + ", or 'auto'"};
}

Result<RgbdFrame> Sequence::read(std::size_t i, const Camera& camera) const {
  const SequenceEntry& e = entries_.at(i);
  const Result<ColourPicture> c = recording_.pictures->colour(e.colour);
  if (!c) return c.error();
  const Result<DepthPicture> d = recording_.pictures->depth(e.depth);
  if (!d) return d.error();
  if (d->width_px != c->width_px || d->height_px != c->height_px) {
    return size_error(d->name, i, d->width_px, d->height_px,
                      fmt::format("its colour image is {}x{}; depth must be registered to colour",
                                  c->width_px, c->height_px));
  }
  if (c->width_px != camera.width_px || c->height_px != camera.height_px) {
    return size_error(c->name, i, c->width_px, c->height_px,
                      fmt::format("camera '{}' is {}x{}; give the right one with --camera",
                                  camera.name, camera.width_px, camera.height_px));
  }
  Result<ColourImage> colour = c->decode();
  if (!colour) return colour.error();
  Result<DepthImage> depth_m = d->metres(camera);
  if (!depth_m) return depth_m.error();
  if (!depth_shift_.none()) *depth_m = laid_over(*depth_m, depth_shift_);
  GreyImage grey = to_grey(*colour);
  return RgbdFrame{static_cast<std::int64_t>(i), e.stamp, std::move(grey), *std::move(colour),
                   *std::move(depth_m)};
}

Result<ColourImage> Sequence::read_colour(std::size_t i) const {
  if (is_live()) return gone(recording_);
  const Result<ColourPicture> picture = recording_.pictures->colour(entries_.at(i).colour);
  if (!picture) return picture.error();
  return picture->decode();
}

Result<RawDepthImage> Sequence::read_depth_counts(std::size_t i) const {
  if (is_live()) return gone(recording_);
  const Result<DepthPicture> picture = recording_.pictures->depth(entries_.at(i).depth);
  if (!picture) return picture.error();
  return picture->counts();
}

}  // namespace ydd
