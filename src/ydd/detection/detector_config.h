// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ydd/base/options.h"
#include "ydd/base/result.h"
#include "ydd/detection/combined_detector.h"
#include "ydd/detection/detector.h"
#include "ydd/detection/object_catalogue.h"
#include "ydd/inference/network.h"

namespace ydd {

/// In which order and range a network wants its picture; auto: as its kind was published.
enum class ChannelOrder { automatic, rgb, bgr };
constexpr std::array<std::string_view, 3> choices_of(ChannelOrder) {
  return {"auto", "rgb", "bgr"};
}
/// What the network takes for a channel: as its kind was published, 0 to 1, or 0 to 255.
enum class PixelValues { automatic, unit, byte };
constexpr std::array<std::string_view, 3> choices_of(PixelValues) {
  return {"auto", "unit", "byte"};
}

/// One network of a detector file.
struct NetworkConfig {
  std::string name;  ///< key in `networks`

  std::string model;           ///< ONNX file
  std::string class_table;     ///< YAML file, key `classes`
  std::string kind = "auto";   ///< of YoloKind, or auto
  InferenceOptions inference;  ///< which library runs it, on what
  int input_width_px = 640, input_height_px = 480;
  ChannelOrder channel_order = ChannelOrder::automatic;
  PixelValues values = PixelValues::automatic;
  double score_threshold = 0.3;
  double nms_iou = 0.45;

  std::map<std::string, std::string> rename;       ///< class of the table -> class of detections
  std::map<std::string, double> class_thresholds;  ///< by class of the table
  std::map<std::string, double> sure_thresholds;   ///< likewise; a class without one is always sure
  std::vector<std::string> keep;                   ///< classes of the table; empty: all

  void describe(OptionTable& table);
};

/// A detector file (configs/detector/*.yaml):
///
///     networks:
///       objects:                         # any name; --set networks.objects.input.width=320
///         model: yolov5n_coco_anysize.onnx
///         classes: coco_classes.yaml
///         rename: {tv: monitor}
///         class_thresholds: {person: 0.25}
///         sure_thresholds: {person: 0.7} # weaker persons cost points, but nobody is told of them
///         keep: [person, chair]
///         ranges: [1, 22.7, 17.6]        # for precision int8, see InferenceOptions
///     merge: {hand_reach_heads: 4}
///
/// Paths are relative to the file; a model is also looked for in the folder `models` and in the
/// folder that the environment variable YDD_MODELS names.
struct DetectorConfig {
  std::filesystem::path file;  ///< where it was read from
  std::string models;
  std::vector<NetworkConfig> networks;  ///< asked in this order, at least one
  MergeOptions merge;

  void describe(OptionTable& table);
};

/// Reads a detector file. `overrides` are "key=value" from the command line; the name of a network
/// may be `*` there, for all of them: "networks.*.input.width=320". Errors name file and line.
Result<DetectorConfig> read_detector_config(const std::filesystem::path& file,
                                            std::span<const std::string> overrides = {});

/// The configuration in force, in the form of the file.
std::string to_yaml(DetectorConfig config);

/// Loads and tries all networks. The failure is one line that names the file at fault: a model that
/// is missing, truncated or of another kind, a class table that does not fit it, or one of whose
/// classes (after renaming) `catalogue` knows none.
Result<std::unique_ptr<Detector>> make_detector(const DetectorConfig& config,
                                                const ObjectCatalogue& catalogue);

/// Both in one.
Result<std::unique_ptr<Detector>> make_detector(
    const std::filesystem::path& file, std::span<const std::string> overrides = {},
    const ObjectCatalogue& catalogue = ObjectCatalogue::defaults());

}  // namespace ydd
