// SPDX-License-Identifier: Apache-2.0
// Written from the published equations (see each decoder); no line comes from a YOLO project.
#include "ydd/detection/yolo_decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ydd {
namespace {

struct NamedKind {
  YoloKind kind;
  std::string_view name;
};
constexpr std::array<NamedKind, 6> kKinds = {{{YoloKind::yolov5, "yolov5"},
                                              {YoloKind::yolov5_heads, "yolov5_heads"},
                                              {YoloKind::yolov5_logits, "yolov5_logits"},
                                              {YoloKind::yolox_heads, "yolox_heads"},
                                              {YoloKind::yolov8, "yolov8"},
                                              {YoloKind::end_to_end, "end_to_end"}}};

constexpr std::array<int, 3> kStrides = {8, 16, 32};
constexpr int kAnchorsPerCell = 3;

struct Anchor {
  float width_px, height_px;
};
/// Of the published YOLOv5 COCO weights, by stride.
constexpr std::array<std::array<Anchor, kAnchorsPerCell>, 3> kYolov5Anchors = {
    {{{{10, 13}, {16, 30}, {33, 23}}},
     {{{30, 61}, {62, 45}, {59, 119}}},
     {{{116, 90}, {156, 198}, {373, 326}}}}};

/// Box, objectness, classes.
std::size_t row_size(const YoloShape& shape) {
  return std::size_t{5} + static_cast<std::size_t>(shape.class_count);
}

int cell_count(const YoloShape& shape) {
  int cells = 0;
  for (const int s : kStrides) cells += (shape.width_px / s) * (shape.height_px / s);
  return cells;
}

std::vector<int> head_shape(const YoloShape& shape, int stride, int channels) {
  return {1, channels, shape.height_px / stride, shape.width_px / stride};
}

/// A size that any number fits.
constexpr int kAnySize = -1;
/// Corners, score, class.
constexpr int kEndToEndRow = 6;

/// What `kind` must give: one shape, or one per stride.
std::vector<std::vector<int>> expected_shapes(YoloKind kind, const YoloShape& shape) {
  const int cells = cell_count(shape);
  const int row = 5 + shape.class_count;
  switch (kind) {
    case YoloKind::yolov5:
      return {{1, kAnchorsPerCell * cells, row}};
    case YoloKind::yolov8:
      return {{1, 4 + shape.class_count, cells}};
    case YoloKind::end_to_end:
      return {{1, kAnySize, kEndToEndRow}};
    case YoloKind::yolov5_heads:
    case YoloKind::yolov5_logits:
    case YoloKind::yolox_heads:
      break;
  }
  const int channels = kind == YoloKind::yolox_heads ? row : kAnchorsPerCell * row;
  std::vector<std::vector<int>> shapes;
  shapes.reserve(kStrides.size());
  for (const int s : kStrides) shapes.push_back(head_shape(shape, s, channels));
  return shapes;
}

const Tensor* find_shape(std::span<const Tensor> outputs, const std::vector<int>& shape) {
  const auto fits = [&](const Tensor& t) {
    return std::equal(t.shape.begin(), t.shape.end(), shape.begin(), shape.end(),
                      [](int is, int wanted) { return is == wanted || wanted == kAnySize; });
  };
  const auto found = std::find_if(outputs.begin(), outputs.end(), fits);
  return found == outputs.end() ? nullptr : &*found;
}

std::string format_shapes(const std::vector<std::vector<int>>& shapes) {
  std::vector<std::string> texts;
  texts.reserve(shapes.size());
  for (const auto& shape : shapes) texts.push_back(format_shape(shape));
  return fmt::format("{}", fmt::join(texts, " "));
}

std::string describe(std::span<const Tensor> outputs, const YoloShape& shape) {
  std::vector<std::vector<int>> shapes;
  shapes.reserve(outputs.size());
  for (const Tensor& t : outputs) shapes.push_back(t.shape);
  return fmt::format("gives {} for {} classes at {} x {}", format_shapes(shapes), shape.class_count,
                     shape.width_px, shape.height_px);
}

/// The outputs that `kind` reads, by rising stride. Nothing when one is absent.
std::optional<std::vector<const Tensor*>> select_outputs(YoloKind kind,
                                                         std::span<const Tensor> outputs,
                                                         const YoloShape& shape) {
  std::vector<const Tensor*> selected;
  for (const auto& expected : expected_shapes(kind, shape)) {
    const Tensor* found = find_shape(outputs, expected);
    if (found == nullptr) return std::nullopt;
    selected.push_back(found);
  }
  return selected;
}

struct KindAndClasses {
  YoloKind kind;
  int class_count;
};

/// For the error message: would another class table fit?
std::optional<KindAndClasses> recognise_other_class_count(std::span<const Tensor> outputs,
                                                          const YoloShape& shape) {
  for (const Tensor& output : outputs) {
    for (const int size : output.shape) {
      // 255 channels are rather 3 anchors of 80 classes than one of 250: the heads in this order.
      const std::array<KindAndClasses, 4> guesses = {{{YoloKind::yolov5, size - 5},
                                                      {YoloKind::yolov8, size - 4},
                                                      {YoloKind::yolov5_heads, size / 3 - 5},
                                                      {YoloKind::yolox_heads, size - 5}}};
      for (const KindAndClasses& guess : guesses) {
        const YoloShape other{guess.class_count, shape.width_px, shape.height_px};
        if (guess.class_count > 0 && select_outputs(guess.kind, outputs, other)) return guess;
      }
    }
  }
  return std::nullopt;
}

/// Mask prototypes beside the boxes: [1, M, H/4, W/4] with M coefficients in each box's row.
const Tensor* find_mask_prototypes(std::span<const Tensor> outputs, const YoloShape& shape) {
  constexpr int kMaskStride = 4;
  const auto found = std::find_if(outputs.begin(), outputs.end(), [&](const Tensor& t) {
    return t.shape.size() == 4 && t.shape[2] == shape.height_px / kMaskStride &&
           t.shape[3] == shape.width_px / kMaskStride;
  });
  return found == outputs.end() ? nullptr : &*found;
}

bool all_probabilities(std::span<const Tensor* const> heads) {
  return std::all_of(heads.begin(), heads.end(), [](const Tensor* head) {
    return std::all_of(head->values.begin(), head->values.end(),
                       [](float v) { return v >= 0.0F && v <= 1.0F; });
  });
}

float sigmoid(float v) { return 1.0F / (1.0F + std::exp(-v)); }
float logit(float p) { return std::log(p / (1.0F - p)); }

Box centred(float cx, float cy, float width, float height) {
  return {cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2};
}

bool is_finite(const Box& b) {
  return std::isfinite(b.x0) && std::isfinite(b.y0) && std::isfinite(b.x1) && std::isfinite(b.y1);
}

/// One stride's output: where the value of a channel in a cell is.
class Head {
 public:
  explicit Head(const Tensor& tensor)
      : values_(tensor.values.data()),
        cells_(std::size_t(tensor.shape[2]) * tensor.shape[3]),
        columns_(tensor.shape[3]),
        cell_step_(tensor.channels_last ? std::size_t(tensor.shape[1]) : 1),
        channel_step_(tensor.channels_last ? 1 : cells_) {}

  std::size_t cells() const { return cells_; }
  int columns() const { return columns_; }
  std::size_t channel_step() const { return channel_step_; }
  const float* at(std::size_t channel, std::size_t cell) const {
    return values_ + channel * channel_step_ + cell * cell_step_;
  }

 private:
  const float* values_;
  std::size_t cells_;
  int columns_;
  std::size_t cell_step_, channel_step_;
};

/// Column and row of the cell with this number.
struct Cell {
  Cell(std::size_t number, int grid_width) {
    const int i = static_cast<int>(number);
    const int row = i / grid_width;
    gx = static_cast<float>(i - row * grid_width);
    gy = static_cast<float>(row);
  }
  float gx = 0, gy = 0;
};

struct BestClass {
  int index = 0;
  float value = 0;
};

/// The first of the largest of `count` values that lie `step` apart.
BestClass best_class(const float* values, int count, std::size_t step) {
  BestClass best{0, values[0]};
  for (int c = 1; c < count; ++c) {
    const float v = values[static_cast<std::size_t>(c) * step];
    if (v > best.value) best = {c, v};
  }
  return best;
}

/// Collects candidates that reach the threshold.
class Collector {
 public:
  explicit Collector(float score_threshold) : threshold_(score_threshold) {}
  bool reaches(float score) const { return score >= threshold_; }  // false for NaN
  void add(const Box& box, int class_index, float score) {
    if (!reaches(score) || !is_finite(box)) return;
    candidates_.push_back({box, class_index, std::min(score, 1.0F)});
  }
  std::vector<Candidate> take() { return std::move(candidates_); }

 private:
  float threshold_;
  std::vector<Candidate> candidates_;
};

/// Rows `cx cy w h objectness class...` in input pixels.
void decode_rows(const Tensor& output, const YoloShape& shape, Collector& out) {
  const std::size_t size = row_size(shape);
  for (std::size_t at = 0; at + size <= output.values.size(); at += size) {
    const float* row = output.values.data() + at;
    if (!out.reaches(row[4])) continue;  // the score can only be smaller
    const BestClass best = best_class(row + 5, shape.class_count, 1);
    out.add(centred(row[0], row[1], row[2], row[3]), best.index, row[4] * best.value);
  }
}

/// Columns `cx cy w h class...` in input pixels, one plane per line: there is no objectness.
void decode_columns(const Tensor& output, const YoloShape& shape, Collector& out) {
  const auto count = static_cast<std::size_t>(output.shape[2]);
  const float* box = output.values.data();
  const float* classes = box + 4 * count;
  std::vector<float> best(classes, classes + count);
  for (int c = 1; c < shape.class_count; ++c) {
    const float* plane = classes + static_cast<std::size_t>(c) * count;
    for (std::size_t i = 0; i < count; ++i) best[i] = std::max(best[i], plane[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!out.reaches(best[i])) continue;
    const BestClass winner = best_class(classes + i, shape.class_count, count);
    out.add(centred(box[i], box[count + i], box[2 * count + i], box[3 * count + i]), winner.index,
            winner.value);
  }
}

/// Rows `x0 y0 x1 y1 score class` in input pixels; what is left over is filled with zeros.
void decode_end_to_end(const Tensor& output, Collector& out) {
  for (std::size_t at = 0; at + kEndToEndRow <= output.values.size(); at += kEndToEndRow) {
    const float* row = output.values.data() + at;
    constexpr float kMostClasses = 65536;
    if (!(row[5] >= 0 && row[5] < kMostClasses)) continue;
    out.add({row[0], row[1], row[2], row[3]}, static_cast<int>(std::lround(row[5])), row[4]);
  }
}

/// One stride of YOLOv5 (v6 of the network), for the cell (gx, gy) and anchor (aw, ah):
///   cx = (2 t0 - 0.5 + gx) s    cy = (2 t1 - 0.5 + gy) s    w = (2 t2)^2 aw    h = (2 t3)^2 ah
/// with t already through the sigmoid; score = objectness t4 * best class.
void decode_yolov5_head(const Head& head, const YoloShape& shape, std::size_t level, bool logits,
                        Collector& out, float score_threshold) {
  const auto stride = static_cast<float>(kStrides[level]);
  const std::size_t step = head.channel_step();
  const auto probability = [&](float t) { return logits ? sigmoid(t) : t; };
  // Comparing the raw value spares the exponential for nearly all cells. The margin covers the
  // rounding of logit(); add() applies the exact threshold.
  const float least_objectness =
      logits ? logit(std::clamp(score_threshold, 1e-6F, 1.0F - 1e-6F)) - 1e-3F : score_threshold;
  for (std::size_t a = 0; a < kAnchorsPerCell; ++a) {
    const Anchor& anchor = kYolov5Anchors[level][a];
    for (std::size_t i = 0; i < head.cells(); ++i) {
      const float* t = head.at(a * row_size(shape), i);
      if (!(t[4 * step] >= least_objectness)) continue;
      const BestClass best = best_class(t + 5 * step, shape.class_count, step);
      const Cell cell(i, head.columns());
      const float w = 2.0F * probability(t[2 * step]);
      const float h = 2.0F * probability(t[3 * step]);
      out.add(centred((2.0F * probability(t[0]) - 0.5F + cell.gx) * stride,
                      (2.0F * probability(t[step]) - 0.5F + cell.gy) * stride,
                      w * w * anchor.width_px, h * h * anchor.height_px),
              best.index, probability(t[4 * step]) * probability(best.value));
    }
  }
}

/// One stride of YOLOX (Ge et al. 2021, anchor free), for the cell (gx, gy):
///   cx = (t0 + gx) s    cy = (t1 + gy) s    w = exp(t2) s    h = exp(t3) s
/// score = objectness t4 * best class, both through the sigmoid in the graph.
void decode_yolox_head(const Head& head, const YoloShape& shape, std::size_t level,
                       Collector& out) {
  const auto stride = static_cast<float>(kStrides[level]);
  const std::size_t step = head.channel_step();
  for (std::size_t i = 0; i < head.cells(); ++i) {
    const float* t = head.at(0, i);
    const float objectness = t[4 * step];
    if (!out.reaches(objectness)) continue;
    const BestClass best = best_class(t + 5 * step, shape.class_count, step);
    const Cell cell(i, head.columns());
    out.add(centred((t[0] + cell.gx) * stride, (t[step] + cell.gy) * stride,
                    std::exp(t[2 * step]) * stride, std::exp(t[3 * step]) * stride),
            best.index, objectness * best.value);
  }
}

}  // namespace

std::string_view to_string(YoloKind kind) {
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& k) { return k.kind == kind; });
  if (found == kKinds.end()) throw std::logic_error("to_string: not a YoloKind");
  return found->name;
}

std::optional<YoloKind> parse_yolo_kind(std::string_view text) {
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& k) { return k.name == text; });
  if (found == kKinds.end()) return std::nullopt;
  return found->kind;
}

std::vector<std::string> yolo_kind_names() {
  std::vector<std::string> names;
  names.reserve(kKinds.size());
  for (const NamedKind& k : kKinds) names.emplace_back(k.name);
  return names;
}

Result<YoloKind> recognise_yolo(std::span<const Tensor> outputs, const YoloShape& shape) {
  for (const YoloKind kind : {YoloKind::yolov5, YoloKind::yolov8, YoloKind::yolox_heads}) {
    if (select_outputs(kind, outputs, shape)) return kind;
  }
  if (const auto heads = select_outputs(YoloKind::yolov5_heads, outputs, shape)) {
    return all_probabilities(*heads) ? YoloKind::yolov5_heads : YoloKind::yolov5_logits;
  }
  if (const Tensor* masks = find_mask_prototypes(outputs, shape)) {
    return Error{fmt::format(
        "is a segmentation network (it gives mask prototypes {} beside its boxes); export the "
        "detection network instead",
        format_shape(masks->shape))};
  }
  if (const auto other = recognise_other_class_count(outputs, shape)) {
    return Error{fmt::format("is a {} network of {} classes, but its class table has {}",
                             to_string(other->kind), other->class_count, shape.class_count)};
  }
  // Last: any number of rows fits, and so would a yolov5 network of one class.
  if (select_outputs(YoloKind::end_to_end, outputs, shape)) return YoloKind::end_to_end;
  return Error{fmt::format("{}: not a known kind of YOLO network; known are {}",
                           describe(outputs, shape), fmt::join(yolo_kind_names(), ", "))};
}

Result<void> check_outputs(YoloKind kind, std::span<const Tensor> outputs, const YoloShape& shape) {
  if (select_outputs(kind, outputs, shape)) return {};
  return Error{fmt::format("{}, but '{}' needs {}", describe(outputs, shape), to_string(kind),
                           format_shapes(expected_shapes(kind, shape)))};
}

std::vector<Candidate> decode_yolo(YoloKind kind, std::span<const Tensor> outputs,
                                   const YoloShape& shape, float score_threshold) {
  const auto selected = select_outputs(kind, outputs, shape);
  if (!selected) throw std::logic_error("decode_yolo: outputs of another kind");
  Collector out(score_threshold);
  for (std::size_t level = 0; level < selected->size(); ++level) {
    const Tensor& output = *(*selected)[level];
    switch (kind) {
      case YoloKind::yolov5:
        decode_rows(output, shape, out);
        break;
      case YoloKind::yolov8:
        decode_columns(output, shape, out);
        break;
      case YoloKind::end_to_end:
        decode_end_to_end(output, out);
        break;
      case YoloKind::yolov5_heads:
      case YoloKind::yolov5_logits:
        decode_yolov5_head(Head(output), shape, level, kind == YoloKind::yolov5_logits, out,
                           score_threshold);
        break;
      case YoloKind::yolox_heads:
        decode_yolox_head(Head(output), shape, level, out);
        break;
    }
  }
  return out.take();
}

}  // namespace ydd
