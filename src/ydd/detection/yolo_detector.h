// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ydd/detection/detector.h"
#include "ydd/detection/letterbox.h"
#include "ydd/detection/yolo_decode.h"
#include "ydd/inference/network.h"

namespace ydd {

/// One class of a network, in the order of its outputs.
struct YoloClass {
  std::string name;              ///< as detections carry it; empty: ignored
  float score_threshold = 0.3F;  ///< weaker detections are dropped
  float sure_threshold = 0;      ///< weaker ones are not sure
};

/// What a network of this kind is told.
struct YoloSettings {
  std::vector<YoloClass> classes;
  std::optional<YoloKind> kind;                     ///< none: recognised from the outputs
  int input_width_px = 640, input_height_px = 480;  ///< multiples of 32
  std::optional<bool> rgb;           ///< order of channels; none: as the kind was published
  std::optional<float> value_scale;  ///< from 0..255; none: as the kind was published
  float nms_iou = 0.45F;             ///< class-wise non-maximum suppression above this overlap
};

/// A YOLO network: letterbox, network, decoding, class-wise suppression.
class YoloDetector : public Detector {
 public:
  /// Runs `session` once on a grey picture, so that a network which does not fit is found here and
  /// not at the first frame. The failure does not name the model. @throws std::logic_error without
  /// classes or with a size that is not a multiple of 32.
  static Result<std::unique_ptr<YoloDetector>> make(std::unique_ptr<InferenceSession> session,
                                                    const YoloSettings& settings);

  Result<Detections> detect(const RgbdFrame& frame) override;
  std::string device() const override { return session_->device(); }

  YoloKind kind() const { return kind_; }

 private:
  YoloDetector(std::unique_ptr<InferenceSession> session, const YoloSettings& settings,
               YoloKind kind);

  std::unique_ptr<InferenceSession> session_;
  YoloSettings settings_;
  YoloKind kind_;
  YoloShape shape_;
  Letterboxer letterboxer_;
};

}  // namespace ydd
