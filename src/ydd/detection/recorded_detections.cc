// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/recorded_detections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ydd/base/files.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest_px = 1e5;

/// A record that lacks something; turned into an Error with the line in front of it.
struct Malformed {
  std::string message;
};

std::string quoted(const std::string& text) { return json_text(Json(text)); }

std::string to_json(const RecordedDetection& d) {
  std::string out = fmt::format("{{\"cls\": {}", quoted(d.detection.class_name));
  if (!d.name.empty()) out += fmt::format(", \"name\": {}", quoted(d.name));
  if (d.id) out += fmt::format(", \"id\": {}", *d.id);
  if (d.dynamic) out += fmt::format(", \"dynamic\": {}", *d.dynamic);
  const Box& b = d.detection.box;
  out += fmt::format(", \"score\": {}, \"box\": [{}, {}, {}, {}]", d.detection.score, b.x0, b.y0,
                     b.x1, b.y1);
  if (!d.detection.sure) out += ", \"sure\": false";
  if (d.pixels) out += fmt::format(", \"pixels\": {}", *d.pixels);
  if (d.moved_in_sequence) out += fmt::format(", \"moved_in_sequence\": {}", *d.moved_in_sequence);
  return out + "}";
}

const Json& member(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw Malformed{fmt::format("'{}' is missing", key)};
  return *found;
}

template <class T>
std::optional<T> optional_member(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return std::nullopt;
  if constexpr (std::is_same_v<T, std::int64_t>) {
    if (!found->is_number_integer()) {
      throw Malformed{fmt::format("'{}' must be a whole number", key)};
    }
  }
  return found->get<T>();
}

Timestamp parse_stamp(const Json& value) {
  // A number keeps only what a double holds (0.2 us today); text keeps every digit.
  const std::string text =
      value.is_number() ? fmt::format("{:.9f}", value.get<double>()) : value.get<std::string>();
  const std::optional<Timestamp> stamp = parse_timestamp(text);
  if (!stamp) throw Malformed{fmt::format("'timestamp' is '{}' but must be seconds", text)};
  return *stamp;
}

Box parse_box(const Json& value) {
  if (!value.is_array() || value.size() != 4) {
    throw Malformed{"'box' must be four numbers [x0, y0, x1, y1]"};
  }
  std::array<float, 4> c{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double coordinate = value[i].get<double>();
    if (!(std::abs(coordinate) <= kFarthest_px)) {
      throw Malformed{fmt::format("'box' holds {}, which cannot be a pixel", coordinate)};
    }
    c[i] = static_cast<float>(coordinate);
  }
  const Box box{c[0], c[1], c[2], c[3]};
  if (box.x1 < box.x0 || box.y1 < box.y0) {
    throw Malformed{fmt::format("'box' [{}, {}, {}, {}] must have x0 <= x1 and y0 <= y1", box.x0,
                                box.y0, box.x1, box.y1)};
  }
  return box;
}

RecordedDetection parse_detection(const Json& object) {
  RecordedDetection out;
  out.detection.class_name = member(object, "cls").get<std::string>();
  if (out.detection.class_name.empty()) throw Malformed{"'cls' must not be empty"};
  out.detection.score = optional_member<float>(object, "score").value_or(1.0F);
  if (!(out.detection.score >= 0.0F && out.detection.score <= 1.0F)) {
    throw Malformed{fmt::format("'score' is {} but must be in [0, 1]", out.detection.score)};
  }
  out.detection.box = parse_box(member(object, "box"));
  out.detection.sure = optional_member<bool>(object, "sure").value_or(true);
  out.name = optional_member<std::string>(object, "name").value_or("");
  out.id = optional_member<std::int64_t>(object, "id");
  out.dynamic = optional_member<bool>(object, "dynamic");
  out.moved_in_sequence = optional_member<bool>(object, "moved_in_sequence");
  out.pixels = optional_member<std::int64_t>(object, "pixels");
  return out;
}

RecordedFrame parse_frame(const Json& object) {
  if (!object.is_object()) throw Malformed{"each line must be one JSON object"};
  RecordedFrame out;
  out.stamp = parse_stamp(member(object, "timestamp"));
  out.index = optional_member<std::int64_t>(object, "frame");
  out.file = optional_member<std::string>(object, "file").value_or("");
  const Json& detections = member(object, "detections");
  if (!detections.is_array()) throw Malformed{"'detections' must be a list"};
  for (const Json& d : detections) {
    if (!d.is_object()) throw Malformed{"'detections' must hold objects"};
    out.detections.push_back(parse_detection(d));
  }
  return out;
}

/// The first box when all lie within the first pixel and not one is of whole numbers: they are
/// fractions of the picture, as trainers write them.
const Box* fraction_box(const std::vector<RecordedFrame>& frames) {
  const Box* first = nullptr;
  for (const RecordedFrame& frame : frames) {
    for (const RecordedDetection& d : frame.detections) {
      const Box& b = d.detection.box;
      if (!lies_in_first_pixel(b)) return nullptr;
      if (first == nullptr && !has_whole_sides(b)) first = &b;
    }
  }
  return first;
}

/// The stamp that two frames share, if any. `frames` in the order of time.
std::optional<Timestamp> duplicate_stamp(const std::vector<RecordedFrame>& frames) {
  const auto found = std::adjacent_find(
      frames.begin(), frames.end(),
      [](const RecordedFrame& a, const RecordedFrame& b) { return a.stamp == b.stamp; });
  if (found == frames.end()) return std::nullopt;
  return found->stamp;
}

}  // namespace

std::string to_json_line(const RecordedFrame& frame) {
  std::string out = fmt::format("{{\"timestamp\": \"{}\"", format_timestamp(frame.stamp));
  if (frame.index) out += fmt::format(", \"frame\": {}", *frame.index);
  if (!frame.file.empty()) out += fmt::format(", \"file\": {}", quoted(frame.file));
  out += ", \"detections\": [";
  for (std::size_t i = 0; i < frame.detections.size(); ++i) {
    if (i > 0) out += ", ";
    out += to_json(frame.detections[i]);
  }
  return out + "]}";
}

Result<RecordedFrame> parse_recorded_frame(std::string_view line, std::string_view source) {
  const Result<Json> json = parse_json(line, source);
  if (!json) return json.error();
  try {
    return parse_frame(*json);
  } catch (const Malformed& e) {
    return Error{fmt::format("{}: {}", source, e.message)};
  } catch (const Json::exception& e) {
    // "[json.exception.type_error.302] type must be string, but is number": the tail is readable.
    const std::string_view what = e.what();
    const std::size_t bracket = what.find("] ");
    return Error{fmt::format("{}: a value has the wrong type: {}", source,
                             bracket == std::string_view::npos ? what : what.substr(bracket + 2))};
  }
}

Result<void> write_recorded_detections(const std::filesystem::path& file,
                                       std::span<const RecordedFrame> frames) {
  std::string content;
  for (const RecordedFrame& frame : frames) content += to_json_line(frame) + "\n";
  return write_file_atomically(file, content);
}

Result<DetectionRecording> DetectionRecording::read(const std::filesystem::path& file) {
  const Result<std::string> content = read_file(file);
  if (!content) return content.error();
  std::vector<RecordedFrame> frames;
  std::map<Timestamp, int> line_of;
  std::string_view rest = *content;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view text = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const std::string source = fmt::format("{}:{}", file.string(), line);
    Result<RecordedFrame> frame = parse_recorded_frame(text, source);
    if (!frame) return frame.error();
    const auto [first, is_new] = line_of.emplace(frame->stamp, line);
    if (!is_new) {
      return Error{fmt::format("{}: timestamp {} was recorded in line {} already", source,
                               format_timestamp(frame->stamp), first->second)};
    }
    frames.push_back(std::move(frame).value());
  }
  if (frames.empty()) {
    return Error{
        fmt::format("{}: holds no frames; 'ydd-slam detect' writes such a file", file.string())};
  }
  if (const Box* const box = fraction_box(frames)) {
    return Error{fmt::format(
        "{}: all boxes lie between 0 and 1, as [{}, {}, {}, {}]: fractions of the picture; give "
        "pixels (x times its width, y times its height)",
        file.string(), box->x0, box->y0, box->x1, box->y1)};
  }
  return DetectionRecording(std::move(frames));
}

std::vector<std::string> DetectionRecording::class_names() const {
  std::set<std::string> names;
  for (const RecordedFrame& frame : frames_) {
    for (const RecordedDetection& d : frame.detections) names.insert(d.detection.class_name);
  }
  return {names.begin(), names.end()};
}

DetectionRecording::DetectionRecording(std::vector<RecordedFrame> frames)
    : frames_(std::move(frames)) {
  std::stable_sort(
      frames_.begin(), frames_.end(),
      [](const RecordedFrame& a, const RecordedFrame& b) { return a.stamp < b.stamp; });
  if (const auto stamp = duplicate_stamp(frames_)) {
    throw std::logic_error("DetectionRecording: two frames at " + format_timestamp(*stamp));
  }
}

const RecordedFrame* DetectionRecording::find(Timestamp stamp, double tolerance_s) const {
  const auto after =
      std::lower_bound(frames_.begin(), frames_.end(), stamp,
                       [](const RecordedFrame& frame, Timestamp s) { return frame.stamp < s; });
  const RecordedFrame* best = nullptr;
  double best_distance_s = tolerance_s;
  const auto consider = [&](const RecordedFrame& frame) {
    const double distance_s = std::abs(seconds_between(stamp, frame.stamp));
    if (distance_s > best_distance_s || (best != nullptr && distance_s == best_distance_s)) return;
    best = &frame;
    best_distance_s = distance_s;
  };
  if (after != frames_.begin()) consider(*std::prev(after));
  if (after != frames_.end()) consider(*after);
  return best;
}

const RecordedFrame* DetectionRecording::find_index(std::int64_t index) const {
  const auto found = std::find_if(frames_.begin(), frames_.end(),
                                  [&](const RecordedFrame& f) { return f.index == index; });
  return found == frames_.end() ? nullptr : &*found;
}

RecordedDetector::RecordedDetector(DetectionRecording recording, std::string name,
                                   RecordedDetectorOptions options)
    : recording_(std::move(recording)), name_(std::move(name)), options_(options) {}

Result<Detections> RecordedDetector::detect(const RgbdFrame& frame) {
  const RecordedFrame* recorded = recording_.find(frame.stamp, options_.tolerance_s);
  if (recorded == nullptr) {
    if (options_.missing_is_empty) return Detections{};
    return Error{fmt::format(
        "{}: no detections for frame {} at {} (tolerance {} s); record the sequence with "
        "'ydd-slam detect'",
        name_, frame.index, format_timestamp(frame.stamp), options_.tolerance_s)};
  }
  const auto size = [](int colour, int grey) { return static_cast<float>(colour ? colour : grey); };
  const float width_px = size(frame.colour.width(), frame.grey.width());
  const float height_px = size(frame.colour.height(), frame.grey.height());
  Detections out;
  out.reserve(recorded->detections.size());
  for (const RecordedDetection& d : recorded->detections) {
    const Box& b = d.detection.box;
    if (reaches_far_beyond(b, width_px, height_px)) {
      return Error{
          fmt::format("{}: box [{}, {}, {}, {}] of '{}' at {} reaches far beyond the picture of {} "
                      "x {}; was it "
                      "recorded with pictures of another size?",
                      name_, b.x0, b.y0, b.x1, b.y1, d.detection.class_name,
                      format_timestamp(frame.stamp), width_px, height_px)};
    }
    out.push_back(d.detection);
  }
  return sorted_by_score(clipped(std::move(out), width_px, height_px));
}

}  // namespace ydd
