// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/detection/detection.h"
#include "ydd/inference/network.h"

namespace ydd {

/// How a YOLO network lays out its boxes. C classes, input H x W, strides s = 8, 16, 32.
enum class YoloKind {
  yolov5,         ///< decoded in the graph: [1, N, 5 + C], N = 3 sum HW/s^2
  yolov5_heads,   ///< per stride [1, 3 (5 + C), H/s, W/s] after the sigmoid
  yolov5_logits,  ///< the same before the sigmoid
  yolox_heads,    ///< per stride [1, 5 + C, H/s, W/s], sigmoid done for objectness and classes
  yolov8,         ///< decoded in the graph: [1, 4 + C, N], N = sum HW/s^2
  end_to_end,     ///< decoded and suppressed in the graph: [1, N, 6], x0 y0 x1 y1 score class
};

/// "yolov5", "yolov5_heads", ... as in configurations.
std::string_view to_string(YoloKind kind);
std::optional<YoloKind> parse_yolo_kind(std::string_view text);
/// All kinds as text.
std::vector<std::string> yolo_kind_names();

/// What is known about a network besides its outputs.
struct YoloShape {
  int class_count = 0;
  int width_px = 0, height_px = 0;  ///< of the input, multiples of 32
};

/// The kind that fits the shapes of `outputs` (a network's answer to any input); values outside
/// [0, 1] tell logits from probabilities. Where a network gives its decoded boxes beside its raw
/// heads, the decoded ones count. The failure lists the shapes, or says how many classes would fit,
/// or that it is a segmentation network.
Result<YoloKind> recognise_yolo(std::span<const Tensor> outputs, const YoloShape& shape);

/// Whether `outputs` can be decoded as `kind`; the failure lists the shapes and what was expected.
Result<void> check_outputs(YoloKind kind, std::span<const Tensor> outputs, const YoloShape& shape);

/// A box with its best class, before non-maximum suppression.
struct Candidate {
  Box box_input;        ///< pixels of the network's input
  int class_index = 0;  ///< end_to_end: as the network says, which may know more classes
  float score = 0;      ///< objectness times class (yolov8: class), in [0, 1]
};

/// All boxes with a score of at least `score_threshold`, in the order of the outputs; a box that is
/// not finite is left out. Raw YOLOv5 heads are decoded with the anchors of the COCO weights.
/// @throws std::logic_error when check_outputs() would fail.
std::vector<Candidate> decode_yolo(YoloKind kind, std::span<const Tensor> outputs,
                                   const YoloShape& shape, float score_threshold);

}  // namespace ydd
