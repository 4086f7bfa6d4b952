// SPDX-License-Identifier: Apache-2.0
#include "ydd/detection/detector_config.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ydd/base/yaml_reader.h"
#include "ydd/detection/yolo_decode.h"

namespace ydd {
namespace {

std::vector<std::string> kind_choices() {
  std::vector<std::string> choices = yolo_kind_names();
  choices.insert(choices.begin(), "auto");
  return choices;
}

Result<void> read_renames(NetworkConfig& network, const YAML::Node& node, const std::string& file) {
  if (!node.IsMap()) return Error{yaml_line(file, node) + ": 'rename' must be {from: to, ...}"};
  for (const auto& entry : node) {
    if (!entry.second.IsScalar() || entry.second.Scalar().empty()) {
      return Error{yaml_line(file, entry.first) + ": 'rename' must be {from: to, ...}"};
    }
    network.rename[entry.first.Scalar()] = entry.second.Scalar();
  }
  return {};
}

Result<void> read_thresholds(std::map<std::string, double>& thresholds, const std::string& key,
                             const YAML::Node& node, const std::string& file) {
  const auto failure = [&](const YAML::Node& at) {
    return Error{fmt::format("{}: '{}' must be {{class: score in [0.01, 1], ...}}",
                             yaml_line(file, at), key)};
  };
  if (!node.IsMap()) return failure(node);
  for (const auto& entry : node) {
    double threshold = 0;
    if (!YAML::convert<double>::decode(entry.second, threshold) ||
        !(threshold >= 0.01 && threshold <= 1.0)) {
      return failure(entry.first);
    }
    thresholds[entry.first.Scalar()] = threshold;
  }
  return {};
}

Result<void> read_keep(NetworkConfig& network, const YAML::Node& node, const std::string& file) {
  if (!node.IsSequence()) return Error{yaml_line(file, node) + ": 'keep' must be [class, ...]"};
  for (const YAML::Node& name : node) {
    if (!name.IsScalar()) return Error{yaml_line(file, name) + ": 'keep' must be [class, ...]"};
    network.keep.push_back(name.Scalar());
  }
  return {};
}

Result<void> read_ranges(NetworkConfig& network, const YAML::Node& node, const std::string& file) {
  const auto failure = [&](const YAML::Node& at) {
    return Error{yaml_line(file, at) + ": 'ranges' must be [number above 0, ...]"};
  };
  if (!node.IsSequence()) return failure(node);
  for (const YAML::Node& entry : node) {
    float range = 0;
    if (!YAML::convert<float>::decode(entry, range) || !std::isfinite(range) || range <= 0) {
      return failure(entry);
    }
    network.inference.ranges.push_back(range);
  }
  return {};
}

/// Sets the scalars below `node`; nested maps become dotted keys.
Result<void> set_scalars(OptionTable& table, const std::string& key, const YAML::Node& node,
                         const std::string& source_file) {
  const std::string source = yaml_line(source_file, node);
  if (node.IsScalar()) return table.set(key, node.Scalar(), source);
  if (!node.IsMap())
    return Error{fmt::format("{}: '{}' must be a single value", source, on_one_line(key))};
  for (const auto& entry : node) {
    const std::string inner = key + "." + entry.first.Scalar();
    if (auto set = set_scalars(table, inner, entry.second, source_file); !set) return set;
  }
  return {};
}

Result<void> read_network(NetworkConfig& network, OptionTable& table, const YAML::Node& node,
                          const std::string& file) {
  if (!node.IsMap()) {
    return Error{fmt::format("{}: network '{}' must hold 'model:' and 'classes:'",
                             yaml_line(file, node), on_one_line(network.name))};
  }
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    Result<void> read;
    if (key == "rename") {
      read = read_renames(network, entry.second, file);
    } else if (key == "class_thresholds") {
      read = read_thresholds(network.class_thresholds, key, entry.second, file);
    } else if (key == "sure_thresholds") {
      read = read_thresholds(network.sure_thresholds, key, entry.second, file);
    } else if (key == "keep") {
      read = read_keep(network, entry.second, file);
    } else if (key == "ranges") {
      read = read_ranges(network, entry.second, file);
    } else {
      read =
          set_scalars(table, fmt::format("networks.{}.{}", network.name, key), entry.second, file);
    }
    if (!read) return read;
  }
  return {};
}

Result<YAML::Node> networks_of(const YAML::Node& root, const std::string& file) {
  const Error missing{file + ": must hold 'networks: {NAME: {model: ..., classes: ...}}'"};
  if (!root.IsMap()) return missing;
  YAML::Node networks = root["networks"];
  if (!networks || !networks.IsMap() || networks.size() == 0) return missing;
  return networks;
}

Result<void> apply(OptionTable& table, const DetectorConfig& config,
                   const std::string& assignment) {
  constexpr std::string_view kEvery = "networks.*.";
  const std::string source = "--set";
  if (!assignment.starts_with(kEvery)) return table.set_assignment(assignment, source);
  for (const NetworkConfig& network : config.networks) {
    const std::string one =
        fmt::format("networks.{}.{}", network.name, assignment.substr(kEvery.size()));
    if (auto set = table.set_assignment(one, source); !set) return set;
  }
  return {};
}

Result<void> require_all(const DetectorConfig& config) {
  const std::string file = config.file.string();
  for (const NetworkConfig& n : config.networks) {
    const auto failure = [&](std::string_view what) {
      return Error{fmt::format("{}: networks.{}.{}", file, on_one_line(n.name), what)};
    };
    if (n.model.empty()) return failure("model is missing; name an ONNX file");
    if (n.class_table.empty()) return failure("classes is missing; name a class table");
    for (const auto& [side, size_px] :
         {std::pair{"width", n.input_width_px}, std::pair{"height", n.input_height_px}}) {
      if (size_px % 32 == 0) continue;
      return failure(fmt::format("input.{} is {} but must be a multiple of 32", side, size_px));
    }
  }
  return {};
}

Result<DetectorConfig> parse_config(const YAML::Node& root, const std::filesystem::path& path,
                                    std::span<const std::string> overrides) {
  const std::string file = path.string();
  DetectorConfig config;
  config.file = path;
  const auto networks = networks_of(root, file);
  if (!networks) return networks.error();
  for (const auto& entry : *networks) {
    config.networks.emplace_back();
    config.networks.back().name = entry.first.Scalar();
  }
  OptionTable table;  // points into config.networks, which stays as it is from here on
  config.describe(table);
  std::size_t index = 0;
  for (const auto& entry : *networks) {
    NetworkConfig& network = config.networks[index++];
    if (auto read = read_network(network, table, entry.second, file); !read) return read.error();
  }
  for (const auto& entry : root) {
    const std::string key = entry.first.Scalar();
    if (key == "networks") continue;
    if (auto set = set_scalars(table, key, entry.second, file); !set) return set.error();
  }
  for (const std::string& assignment : overrides) {
    if (auto set = apply(table, config, assignment); !set) return set.error();
  }
  if (auto complete = require_all(config); !complete) return complete.error();
  return config;
}

/// "    rename: {tv: monitor}\n", or nothing.
template <class Entries, class Emit>
std::string list_line(const char* key, const Entries& entries, Emit emit) {
  if (entries.empty()) return "";
  YAML::Emitter out;
  out << YAML::Flow;
  emit(out);
  return fmt::format("    {}: {}\n", key, out.c_str());
}

std::string lists_to_yaml(const NetworkConfig& n) {
  const auto map = [](const auto& entries) {
    return [&entries](YAML::Emitter& out) {
      out << YAML::BeginMap;
      for (const auto& [key, value] : entries) out << YAML::Key << key << YAML::Value << value;
      out << YAML::EndMap;
    };
  };
  return list_line("rename", n.rename, map(n.rename)) +
         list_line("class_thresholds", n.class_thresholds, map(n.class_thresholds)) +
         list_line("sure_thresholds", n.sure_thresholds, map(n.sure_thresholds)) +
         list_line("keep", n.keep, [&](YAML::Emitter& out) { out << n.keep; }) +
         list_line("ranges", n.inference.ranges,
                   [&](YAML::Emitter& out) { out << n.inference.ranges; });
}

}  // namespace

void NetworkConfig::describe(OptionTable& t) {
  const Range size{32, 4096};
  t.add("model", model, {}, "ONNX file");
  t.add("classes", class_table, {}, "YAML file with the class names in the order of the outputs");
  t.add("kind", kind, kind_choices(), "layout of the outputs; auto: recognised from their shapes");
  inference.describe(t);
  t.add("input.width", input_width_px, size, "px", "the picture is scaled into it; multiple of 32");
  t.add("input.height", input_height_px, size, "px", "likewise");
  t.add("input.channels", channel_order, "auto: as the kind was published (yolox bgr, others rgb)");
  t.add("input.values", values,
        "unit: 0 to 1, byte: 0 to 255; auto: as the kind was published (yolox byte, others unit)");
  t.add("score_threshold", score_threshold, {0.01, 1}, "", "weaker detections are dropped");
  t.add("nms_iou", nms_iou, {0, 1}, "",
        "of two boxes of a class with more overlap the weaker is dropped");
}

void DetectorConfig::describe(OptionTable& table) {
  table.add("models", models, {}, "folder to look for models in, relative to this file");
  for (NetworkConfig& network : networks) table.group("networks." + network.name, network);
  table.group("merge", merge);
}

Result<DetectorConfig> read_detector_config(const std::filesystem::path& file,
                                            std::span<const std::string> overrides) {
  const Result<YAML::Node> root = read_yaml(file);
  if (!root) return root.error();
  return parse_config(*root, file, overrides);
}

std::string to_yaml(DetectorConfig config) {
  std::string out;
  OptionTable head;
  head.add("models", config.models, {}, "folder to look for models in, relative to this file");
  out += head.to_yaml() + "networks:\n";
  for (NetworkConfig& network : config.networks) {
    OptionTable table;
    network.describe(table);
    out += fmt::format("  {}:\n", network.name);
    const std::string lines = table.to_yaml();
    for (std::string_view rest = lines; !rest.empty();) {
      const std::size_t end = rest.find('\n') + 1;
      out += fmt::format("    {}", rest.substr(0, end));
      rest.remove_prefix(end);
    }
    out += lists_to_yaml(network);
  }
  OptionTable tail;
  tail.group("merge", config.merge);
  return out + tail.to_yaml();
}

}  // namespace ydd
