// SPDX-License-Identifier: Apache-2.0
// From a detector's configuration to a detector: files are found, read and tried here.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/log.h"
#include "ydd/base/yaml_reader.h"
#include "ydd/detection/class_table.h"
#include "ydd/detection/detector_config.h"
#include "ydd/detection/person_check.h"
#include "ydd/detection/yolo_detector.h"

namespace ydd {
namespace {

using std::filesystem::path;

/// Where a model may lie, best first.
std::vector<path> places_of(const path& model, const DetectorConfig& config) {
  if (model.is_absolute()) return {model};
  const path folder = config.file.parent_path();
  std::vector<path> places = {folder / model};
  if (!config.models.empty()) places.push_back(folder / config.models / model);
  if (const char* models = std::getenv("YDD_MODELS")) places.push_back(path(models) / model);
  return places;
}

Result<path> find_model(const NetworkConfig& network, const DetectorConfig& config) {
  const std::vector<path> places = places_of(network.model, config);
  const auto found = std::find_if(places.begin(), places.end(), [](const path& place) {
    return std::filesystem::is_regular_file(place);
  });
  if (found != places.end()) return *found;
  std::vector<std::string> texts;
  texts.reserve(places.size());
  for (const path& place : places) texts.push_back(place.string());
  return Error{fmt::format(
      "{}: networks.{}.model: there is no file {}; set the environment variable YDD_MODELS to the "
      "folder that holds it",
      config.file.string(), on_one_line(network.name), fmt::join(texts, " or "))};
}

/// A class that the configuration names must be one that the table has.
Result<void> check_named_classes(const NetworkConfig& network,
                                 const std::vector<std::string>& table, const std::string& file) {
  const auto check = [&](const char* key, const std::string& name) -> Result<void> {
    if (std::find(table.begin(), table.end(), name) != table.end()) return {};
    return Error{fmt::format("{}: networks.{}.{} names '{}', which is not in the class table {}",
                             file, on_one_line(network.name), key, on_one_line(name),
                             network.class_table)};
  };
  for (const auto& [from, to] : network.rename) {
    if (auto known = check("rename", from); !known) return known;
  }
  for (const auto& [key, thresholds] : {std::pair{"class_thresholds", &network.class_thresholds},
                                        std::pair{"sure_thresholds", &network.sure_thresholds}}) {
    for (const auto& [name, threshold] : *thresholds) {
      if (auto known = check(key, name); !known) return known;
    }
  }
  for (const std::string& name : network.keep) {
    if (auto known = check("keep", name); !known) return known;
  }
  return {};
}

std::vector<YoloClass> classes_of(const NetworkConfig& network,
                                  const std::vector<std::string>& table,
                                  const ObjectCatalogue& catalogue) {
  const auto& keep = network.keep;
  std::vector<YoloClass> classes;
  for (const std::string& name : table) {
    YoloClass entry;
    const bool wanted = keep.empty() || std::find(keep.begin(), keep.end(), name) != keep.end();
    const auto renamed = network.rename.find(name);
    if (wanted) {
      entry.name =
          name_in_rules(renamed == network.rename.end() ? name : renamed->second, catalogue);
    }
    const auto threshold_of = [&](const std::map<std::string, double>& own, double otherwise) {
      const auto found = own.find(name);
      return static_cast<float>(found == own.end() ? otherwise : found->second);
    };
    entry.score_threshold = threshold_of(network.class_thresholds, network.score_threshold);
    entry.sure_threshold = threshold_of(network.sure_thresholds, 0);
    classes.push_back(std::move(entry));
  }
  return classes;
}

Result<std::vector<YoloClass>> read_classes(const NetworkConfig& network,
                                            const DetectorConfig& config,
                                            const ObjectCatalogue& catalogue) {
  const path file = config.file.parent_path() / network.class_table;
  const auto table = read_class_table(file);
  if (!table) return table.error();
  if (auto named = check_named_classes(network, *table, config.file.string()); !named) {
    return named.error();
  }
  std::vector<YoloClass> classes = classes_of(network, *table, catalogue);
  const bool any_known = std::any_of(classes.begin(), classes.end(),
                                     [&](const YoloClass& c) { return catalogue.knows(c.name); });
  if (!any_known) {
    return Error{fmt::format(
        "{}: none of its {} classes ('{}', ...) is in the object catalogue; rename them in {} or "
        "add them to the catalogue",
        file.string(), table->size(), on_one_line(table->front()), config.file.string())};
  }
  return classes;
}

YoloSettings settings_of(const NetworkConfig& network, std::vector<YoloClass> classes) {
  YoloSettings settings;
  settings.classes = std::move(classes);
  settings.kind = parse_yolo_kind(network.kind);  // nothing for "auto"
  settings.input_width_px = network.input_width_px;
  settings.input_height_px = network.input_height_px;
  if (network.channel_order != ChannelOrder::automatic) {
    settings.rgb = network.channel_order == ChannelOrder::rgb;
  }
  if (network.values != PixelValues::automatic) {
    settings.value_scale = network.values == PixelValues::unit ? 1.0F / 255 : 1.0F;
  }
  settings.nms_iou = static_cast<float>(network.nms_iou);
  return settings;
}

Result<std::unique_ptr<Detector>> make_one(const NetworkConfig& network,
                                           const DetectorConfig& config,
                                           std::vector<YoloClass> classes) {
  const auto model = find_model(network, config);
  if (!model) return model.error();
  InferenceOptions inference = network.inference;
  inference.input_width_px = network.input_width_px;
  inference.input_height_px = network.input_height_px;
  auto session = load_network(*model, inference);
  if (!session) return session.error();
  auto detector =
      YoloDetector::make(std::move(session).value(), settings_of(network, std::move(classes)));
  if (!detector) {
    return Error{fmt::format("{}: {}", model->string(), detector.error().message)};
  }
  return std::unique_ptr<Detector>(std::move(detector).value());
}

}  // namespace

Result<std::unique_ptr<Detector>> make_detector(const DetectorConfig& config,
                                                const ObjectCatalogue& catalogue) {
  std::vector<std::unique_ptr<Detector>> detectors;
  std::vector<std::string> names;
  for (const NetworkConfig& network : config.networks) {
    auto classes = read_classes(network, config, catalogue);
    if (!classes) return classes.error();
    for (const YoloClass& entry : *classes) names.push_back(entry.name);
    auto detector = make_one(network, config, std::move(classes).value());
    if (!detector) return detector.error();
    detectors.push_back(std::move(detector).value());
  }
  if (const auto nobody = nobody_warning(names, catalogue, config.file.string())) {
    log::warning("{}", *nobody);
  }
  return std::unique_ptr<Detector>(
      std::make_unique<CombinedDetector>(std::move(detectors), config.merge));
}

Result<std::unique_ptr<Detector>> make_detector(const path& file,
                                                std::span<const std::string> overrides,
                                                const ObjectCatalogue& catalogue) {
  const auto config = read_detector_config(file, overrides);
  if (!config) return config.error();
  return make_detector(*config, catalogue);
}

}  // namespace ydd
