// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/yolo_detector.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "ydd/detection/boxes.h"

namespace ydd {
namespace {

YoloShape shape_of(const YoloSettings& settings) {
  return {static_cast<int>(settings.classes.size()), settings.input_width_px,
          settings.input_height_px};
}

/// YOLOX was published with blue-green-red bytes, the others with red-green-blue in [0, 1].
InputFormat format_of(const YoloSettings& settings, YoloKind kind) {
  const bool is_yolox = kind == YoloKind::yolox_heads;
  InputFormat format;
  format.width_px = settings.input_width_px;
  format.height_px = settings.input_height_px;
  format.rgb = settings.rgb.value_or(!is_yolox);
  format.value_scale = settings.value_scale.value_or(is_yolox ? 1.0F : 1.0F / 255);
  return format;
}

Result<YoloKind> probe(InferenceSession& session, const YoloSettings& settings) {
  const YoloShape shape = shape_of(settings);
  constexpr float kGrey = 0.5F;
  const std::vector<float> grey(std::size_t{3} * shape.width_px * shape.height_px, kGrey);
  const auto outputs = session.run({{1, 3, shape.height_px, shape.width_px}, grey});
  if (!outputs) {
    return Error{fmt::format(
        "{} (batch, channels, height, width); a network that was exported for one size needs just "
        "that as input.width and input.height",
        outputs.error().message)};
  }
  if (!settings.kind) return recognise_yolo(*outputs, shape);
  if (auto fits = check_outputs(*settings.kind, *outputs, shape); !fits) return fits.error();
  return *settings.kind;
}

float least_threshold(const std::vector<YoloClass>& classes) {
  float least = std::numeric_limits<float>::infinity();
  for (const YoloClass& c : classes) {
    if (!c.name.empty()) least = std::min(least, c.score_threshold);
  }
  return least;
}

}  // namespace

Result<std::unique_ptr<YoloDetector>> YoloDetector::make(std::unique_ptr<InferenceSession> session,
                                                         const YoloSettings& settings) {
  constexpr int kMultiple = 32;  // the coarsest stride
  if (!session || settings.classes.empty() || settings.input_width_px <= 0 ||
      settings.input_height_px <= 0 || settings.input_width_px % kMultiple != 0 ||
      settings.input_height_px % kMultiple != 0) {
    throw std::logic_error("YoloDetector: no session, no classes or an impossible input size");
  }
  const Result<YoloKind> kind = probe(*session, settings);
  if (!kind) return kind.error();
  return std::unique_ptr<YoloDetector>(new YoloDetector(std::move(session), settings, *kind));
}

YoloDetector::YoloDetector(std::unique_ptr<InferenceSession> session, const YoloSettings& settings,
                           YoloKind kind)
    : session_(std::move(session)),
      settings_(settings),
      kind_(kind),
      shape_(shape_of(settings)),
      letterboxer_(format_of(settings, kind)) {}

Result<Detections> YoloDetector::detect(const RgbdFrame& frame) {
  const ColourImage& image = frame.colour;
  if (image.empty()) {
    return Error{fmt::format("frame {} has no colour picture to detect objects in", frame.index)};
  }
  const auto outputs = session_->run(letterboxer_.prepare(image));
  if (!outputs) {
    return Error{fmt::format("frame {}: the network {}", frame.index, outputs.error().message)};
  }
  const Letterbox place =
      letterbox_for(image.width(), image.height(), shape_.width_px, shape_.height_px);
  Detections found;
  for (const Candidate& c :
       decode_yolo(kind_, *outputs, shape_, least_threshold(settings_.classes))) {
    if (c.class_index >= shape_.class_count) {
      return Error{fmt::format(
          "frame {}: the network found its class {} (counted from 0), but its class table has {}",
          frame.index, c.class_index, shape_.class_count)};
    }
    const YoloClass& its_class = settings_.classes[static_cast<std::size_t>(c.class_index)];
    if (its_class.name.empty() || c.score < its_class.score_threshold) continue;
    found.push_back({its_class.name, c.score, to_image(c.box_input, place)});
    found.back().sure = c.score >= its_class.sure_threshold;
  }
  // Suppression before clipping: boxes that leave the picture keep their true overlap.
  return clipped(suppress_non_maxima(std::move(found), settings_.nms_iou),
                 static_cast<float>(image.width()), static_cast<float>(image.height()));
}

}  // namespace ydd
