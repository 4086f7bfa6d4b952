// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/camera_forms.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ydd/base/yaml_reader.h"

namespace ydd {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kKnownForms =
    "ydd-slam's own (width, height, fx, fy, cx, cy, depth_scale), settings of ORB-SLAM2, "
    "ORB-SLAM3, OpenVSLAM and stella_vslam, calibrations of ROS (camera_info), OpenCV "
    "(camera_matrix), kalibr and camodocal, NICE-SLAM, intrinsics of Open3D and RealSense";
constexpr const char* kOurLens =
    "only a pinhole camera with k1, k2, p1, p2, k3 is computed with; undistort the pictures and "
    "give the camera of the undistorted ones";

/// A scalar or list of the file; maps have become dotted keys.
struct Entry {
  std::string key;
  Names texts;  ///< one, or the scalars of a list
  bool is_list = false;
  std::string source;  ///< "file:line"
};
using Entries = std::vector<Entry>;

void append_scalars(const YAML::Node& node, Names& texts) {
  if (node.IsScalar()) texts.push_back(node.Scalar());
  if (!node.IsSequence()) return;
  for (const YAML::Node& inner : node) append_scalars(inner, texts);
}

void append_entries(const YAML::Node& map, const std::string& prefix, const std::string& file,
                    Entries& entries) {
  for (const auto& pair : map) {
    if (!pair.first.IsScalar()) continue;
    const std::string key = prefix + pair.first.Scalar();
    if (pair.second.IsMap()) {
      append_entries(pair.second, key + ".", file, entries);
      continue;
    }
    Entry entry{key, {}, !pair.second.IsScalar(), yaml_line(file, pair.first)};
    append_scalars(pair.second, entry.texts);
    entries.push_back(std::move(entry));
  }
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, ec] = std::from_chars(begin, text.data() + text.size(), value);
  if (ec != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "Kannala-Brandt 8" and "kannala_brandt8" are one name.
std::string squeezed(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u)) out += static_cast<char>(std::tolower(u));
  }
  return out;
}

/// One file under examination.
class Form {
 public:
  Form(std::string file, Entries entries) : file_(std::move(file)), entries_(std::move(entries)) {}

  const Entry* find(std::string_view key) const {
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& entry) { return entry.key == key; });
    return found == entries_.end() ? nullptr : &*found;
  }
  const Entry* find_any(const Names& keys) const {
    for (const std::string& key : keys) {
      if (const Entry* entry = find(key)) return entry;
    }
    return nullptr;
  }
  const Entries& entries() const { return entries_; }
  const std::string& file() const { return file_; }
  /// Goes on with the entries below `prefix`, which it takes off, and those below nothing.
  void enter(const std::string& prefix) {
    Entries inner;
    for (const Entry& entry : entries_) {
      const bool is_below = entry.key.starts_with(prefix);
      if (!is_below && entry.key.find('.') != std::string::npos) continue;
      inner.push_back(entry);
      if (is_below) inner.back().key.erase(0, prefix.size());
    }
    entries_ = std::move(inner);
  }

 private:
  std::string file_;
  Entries entries_;
};

/// Our key and what a form calls it, the first found counts.
struct Key {
  const char* ours;
  Names theirs;
  bool is_required = false;
};

Error missing(const Form& form, const Key& key, const char* who, const Names& required) {
  if (std::string_view(key.ours) == "depth_scale") {
    return Error{
        fmt::format("{}: '{}' is missing, the depth image's value of one metre (1000 for "
                    "millimetres); add it if this is {}",
                    form.file(), key.theirs.front(), who)};
  }
  return Error{fmt::format("{}: '{}' is missing; {} needs {}", form.file(), key.theirs.front(), who,
                           fmt::join(required, ", "))};
}

Result<GivenCamera> values_of(const Form& form, const std::vector<Key>& keys, const char* who) {
  GivenCamera camera;
  Names required;
  for (const Key& key : keys) {
    if (key.is_required) required.push_back(key.theirs.front());
  }
  for (const Key& key : keys) {
    const Entry* entry = form.find_any(key.theirs);
    if (entry == nullptr && key.is_required) {
      return missing(form, key, who, required);
    }
    if (entry == nullptr) continue;
    if (entry->is_list) {
      return Error{fmt::format("{}: '{}' must be a single value", entry->source, entry->key)};
    }
    auto& values = std::string_view(key.ours) == "bf" ? camera.bf_px_m : camera.values;
    values.push_back({key.ours, entry->key, entry->texts.front(), entry->source});
  }
  return camera;
}

// --- lenses ------------------------------------------------------------------------------------

/// Names of what we compute with, squeezed; "" and "none" for no distortion. A rational lens is one
/// of them when its k4 to k6 are zero.
constexpr std::array<std::string_view, 14> kPinholes = {"",
                                                        "pinhole",
                                                        "rectified",
                                                        "perspective",
                                                        "plumbbob",
                                                        "radtan",
                                                        "none",
                                                        "opencv",
                                                        "radialtangential",
                                                        "rationalpolynomial",
                                                        "rational",
                                                        "brownconrady",
                                                        "distortionbrownconrady",
                                                        "distortionnone"};

bool is_lens_key(const std::string& key) {
  static const Names kKeys = {"Camera.type",        "Camera.model", "camera_type", "camera_model",
                              "distortion_model",   "model_type",   "model",       "type",
                              "Camera.camera_model"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

bool all_zero(const Entry* coefficients) {
  return coefficients == nullptr ||
         std::all_of(coefficients->texts.begin(), coefficients->texts.end(),
                     [](const std::string& text) { return number(text) == 0.0; });
}

Result<void> check_lens_names(const Form& form) {
  for (const Entry& entry : form.entries()) {
    if (!is_lens_key(entry.key) || entry.is_list) continue;
    const std::string name = squeezed(entry.texts.front());
    // RealSense calls its lenses so also where it has removed their distortion.
    const bool is_inverse = name.ends_with("inversebrownconrady");
    const bool is_modified = name.ends_with("modifiedbrownconrady");
    if ((is_inverse || is_modified) && all_zero(form.find("coeffs"))) continue;
    if (std::find(kPinholes.begin(), kPinholes.end(), name) != kPinholes.end()) continue;
    return Error{fmt::format("{}: '{}' is '{}', another lens: {}", entry.source, entry.key,
                             on_one_line(entry.texts.front()), kOurLens)};
  }
  return {};
}

/// The terms that OpenCV's larger models add to ours: k4 to k6 of the rational one, thin prism and
/// tilt. Zeros pass.
Result<void> check_no_more_terms(const Form& form) {
  static const Names kTerms = {"k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"};
  static const Names kPrefixes = {"", "Camera.", "Camera1.", "distortion_parameters."};
  for (const std::string& prefix : kPrefixes) {
    for (const std::string& term : kTerms) {
      const Entry* entry = form.find(prefix + term);
      if (entry == nullptr || entry->is_list) continue;
      const auto value = number(entry->texts.front());
      if (value == 0.0) continue;
      return Error{fmt::format("{}: '{}' is '{}' but can only be 0: {}", entry->source, entry->key,
                               on_one_line(entry->texts.front()), kOurLens)};
    }
  }
  return {};
}

/// Coefficients in OpenCV's order.
Result<void> add_coefficients(const Entry* entry, GivenCamera& camera) {
  static const Names kOrder = {"k1", "k2", "p1", "p2", "k3"};
  if (entry == nullptr) return {};
  for (std::size_t i = 0; i < entry->texts.size(); ++i) {
    const std::string name = fmt::format("{}[{}]", entry->key, i);
    if (i < kOrder.size()) {
      camera.values.push_back({kOrder[i], name, entry->texts[i], entry->source});
    } else if (number(entry->texts[i]) != 0.0) {
      return Error{
          fmt::format("{}: '{}' has {} coefficients, of which the {}th is '{}' but can "
                      "only be 0: {}",
                      entry->source, entry->key, entry->texts.size(), i + 1,
                      on_one_line(entry->texts[i]), kOurLens)};
    }
  }
  return {};
}

// --- forms with a key for each value ------------------------------------------------------------

std::vector<Key> with_lens(std::vector<Key> keys, const std::string& prefix) {
  for (const char* const name : {"fx", "fy", "cx", "cy"}) {
    keys.insert(keys.begin(), {name, {prefix + name}, true});
  }
  std::reverse(keys.begin(), keys.begin() + 4);
  for (const char* const name : {"k1", "k2", "p1", "p2", "k3"}) {
    keys.push_back({name, {prefix + name}});
  }
  return keys;
}

/// The two generations of ORB-SLAM's settings differ in their keys: "Camera.fx" with "Camera.bf"
/// and "DepthMapFactor", and (File.version 1.0) "Camera1.fx" with "Stereo.b" and
/// "RGBD.DepthMapFactor"; files with a mixture are about.
Result<GivenCamera> read_orbslam(const Form& form, bool is_new) {
  const Names depth = is_new ? Names{"RGBD.DepthMapFactor", "DepthMapFactor"}
                             : Names{"DepthMapFactor", "RGBD.DepthMapFactor"};
  return values_of(form,
                   with_lens({{"width", {"Camera.width"}, true},
                              {"height", {"Camera.height"}, true},
                              {"depth_scale", depth, true},
                              {"fps", {"Camera.fps"}},
                              {"baseline", {"Stereo.b"}},
                              {"bf", {"Camera.bf"}}},
                             is_new ? "Camera1." : "Camera."),
                   "an RGB-D camera in a settings file of ORB-SLAM");
}

Result<GivenCamera> read_stella(const Form& form) {
  return values_of(form,
                   with_lens({{"width", {"Camera.cols"}, true},
                              {"height", {"Camera.rows"}, true},
                              {"depth_scale",
                               {"Preprocessing.depthmap_factor", "Tracking.depthmap_factor",
                                "depthmap_factor", "Camera.depthmap_factor"},
                               true},
                              {"fps", {"Camera.fps"}},
                              {"bf", {"Camera.focal_x_baseline"}}},
                             "Camera."),
                   "an RGB-D camera in a settings file of stella_vslam");
}

/// What the calibrations of others do not say, and a user adds.
const std::vector<Key> kAdded = {{"depth_scale", {"depth_scale"}, true},
                                 {"min_depth", {"min_depth"}},
                                 {"max_depth", {"max_depth"}},
                                 {"baseline", {"baseline"}},
                                 {"fps", {"fps"}}};

std::vector<Key> with_added(std::vector<Key> keys) {
  keys.insert(keys.end(), kAdded.begin(), kAdded.end());
  return keys;
}

Result<GivenCamera> read_camodocal(const Form& form) {
  std::vector<Key> keys =
      with_added({{"width", {"image_width"}, true}, {"height", {"image_height"}, true}});
  for (const char* const name : {"fx", "fy", "cx", "cy"}) {
    keys.push_back({name, {std::string("projection_parameters.") + name}, true});
  }
  for (const char* const name : {"k1", "k2", "p1", "p2", "k3"}) {
    keys.push_back({name, {std::string("distortion_parameters.") + name}});
  }
  return values_of(form, keys, "a camera of camodocal");
}

/// NICE-SLAM and its relatives: "cam: {H, W, fx, fy, cx, cy, png_depth_scale}".
Result<GivenCamera> read_niceslam(const Form& form) {
  auto camera = values_of(form,
                          {{"width", {"cam.W"}, true},
                           {"height", {"cam.H"}, true},
                           {"fx", {"cam.fx"}, true},
                           {"fy", {"cam.fy"}, true},
                           {"cx", {"cam.cx"}, true},
                           {"cy", {"cam.cy"}, true},
                           {"depth_scale", {"cam.png_depth_scale"}, true}},
                          "a camera of NICE-SLAM");
  if (!camera) return camera;
  if (auto r = add_coefficients(form.find("cam.distortion"), *camera); !r) return r.error();
  return camera;
}

Result<GivenCamera> read_realsense(const Form& form) {
  auto camera = values_of(form,
                          with_added({{"width", {"width"}, true},
                                      {"height", {"height"}, true},
                                      {"fx", {"fx"}, true},
                                      {"fy", {"fy"}, true},
                                      {"cx", {"ppx"}, true},
                                      {"cy", {"ppy"}, true}}),
                          "RealSense intrinsics");
  if (!camera) return camera;
  if (auto r = add_coefficients(form.find("coeffs"), *camera); !r) return r.error();
  return camera;
}

/// Strict: a key that is not ours is a slip of the pen.
Result<GivenCamera> read_own(const Form& form) {
  GivenCamera camera;
  static const Names kRequired = {"width", "height", "fx", "fy", "cx", "cy"};
  for (const std::string& key : kRequired) {
    if (form.find(key) != nullptr) continue;
    return Error{fmt::format("{}: '{}' is missing; a camera needs {}", form.file(), key,
                             fmt::join(kRequired, ", "))};
  }
  for (const Entry& entry : form.entries()) {
    if (entry.is_list) {
      return Error{fmt::format("{}: '{}' must be a single value", entry.source, entry.key)};
    }
    // Lenses and further terms that are named and harmless have been looked at already.
    static const Names kZeros = {"k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"};
    if (is_lens_key(entry.key)) continue;
    if (std::find(kZeros.begin(), kZeros.end(), entry.key) != kZeros.end()) continue;
    camera.values.push_back({entry.key, entry.key, entry.texts.front(), entry.source});
  }
  return camera;
}

// --- forms with a matrix or a list ---------------------------------------------------------------

const Names kMatrixKeys = {"camera_matrix.data",
                           "camera_matrix",
                           "Camera_Matrix.data",
                           "cameraMatrix.data",
                           "cameraMatrix",
                           "K.data",
                           "K",
                           "k",
                           "intrinsic_matrix",
                           "Camera_Matrix",
                           "intrinsic.intrinsic_matrix"};
const Names kCoefficientKeys = {"distortion_coefficients.data",
                                "distortion_coefficients",
                                "distortion_coefficents.data",
                                "Distortion_Coefficients.data",
                                "distortionCoefficients.data",
                                "distCoeffs.data",
                                "dist_coeffs.data",
                                "dist_coeff.data",
                                "dist_coeffs",
                                "dist_coeff",
                                "D.data",
                                "D",
                                "d"};

/// [fx 0 cx; 0 fy cy; 0 0 1] by rows, or as Open3D has it by columns: the zeros tell which.
Result<GivenCamera> read_matrix(const Form& form) {
  auto camera = values_of(
      form,
      with_added({{"width", {"image_width", "width", "image_Width", "imageWidth"}, true},
                  {"height", {"image_height", "height", "image_Height", "imageHeight"}, true}}),
      "a calibration of the colour camera");
  if (!camera) return camera;
  const Entry& matrix = *form.find_any(kMatrixKeys);
  std::vector<double> m;
  for (const std::string& text : matrix.texts) m.push_back(number(text).value_or(-1));
  const auto is_zero = [&](std::initializer_list<std::size_t> places) {
    return std::all_of(places.begin(), places.end(), [&](std::size_t i) { return m[i] == 0; });
  };
  const bool is_whole = m.size() == 9 && m[8] == 1;
  const bool by_rows = is_whole && is_zero({1, 3, 6, 7});
  if (!is_whole || (!by_rows && !is_zero({1, 2, 3, 5}))) {
    return Error{fmt::format("{}: '{}' must be the nine numbers [fx, 0, cx, 0, fy, cy, 0, 0, 1]",
                             matrix.source, matrix.key)};
  }
  const std::size_t cx = by_rows ? 2 : 6;
  const std::size_t cy = by_rows ? 5 : 7;
  for (const auto& [ours, place] :
       {std::pair<const char*, std::size_t>{"fx", 0}, {"fy", 4}, {"cx", cx}, {"cy", cy}}) {
    camera->values.push_back(
        {ours, fmt::format("{}[{}]", matrix.key, place), matrix.texts[place], matrix.source});
  }
  if (auto r = add_coefficients(form.find_any(kCoefficientKeys), *camera); !r) return r.error();
  return camera;
}

/// kalibr's camchain of one camera, and EuRoC's sensor.yaml.
Result<GivenCamera> read_lists(const Form& form) {
  auto camera = values_of(form, kAdded, "a calibration of the colour camera");
  if (!camera) return camera;
  const auto add = [&](const char* list, const Names& ours) -> Result<void> {
    const Entry* entry = form.find(list);
    if (entry == nullptr || entry->texts.size() != ours.size()) {
      return Error{fmt::format("{}: '{}' must be [{}]", entry ? entry->source : form.file(), list,
                               fmt::join(ours, ", "))};
    }
    for (std::size_t i = 0; i < ours.size(); ++i) {
      camera->values.push_back(
          {ours[i], fmt::format("{}[{}]", list, i), entry->texts[i], entry->source});
    }
    return {};
  };
  if (auto r = add("intrinsics", {"fx", "fy", "cx", "cy"}); !r) return r.error();
  if (auto r = add("resolution", {"width", "height"}); !r) return r.error();
  const Entry* coefficients = form.find_any({"distortion_coeffs", "distortion_coefficients"});
  if (auto r = add_coefficients(coefficients, *camera); !r) return r.error();
  return camera;
}

/// The names of kalibr's cameras: "cam0" where "cam0.intrinsics" stands.
Names cameras_of_chain(const Form& form) {
  Names cameras;
  for (const Entry& entry : form.entries()) {
    const std::size_t dot = entry.key.find('.');
    if (dot == std::string::npos || entry.key.substr(dot) != ".intrinsics") continue;
    cameras.push_back(entry.key.substr(0, dot));
  }
  return cameras;
}

bool has_below(const Form& form, const std::string& prefix) {
  for (const char* const name : {"fx", "fy", "cx", "cy"}) {
    if (form.find(prefix + name) != nullptr) return true;
  }
  return false;
}

Result<GivenCamera> read_form(const Form& form) {
  if (has_below(form, "Camera1.")) return read_orbslam(form, true);
  if (has_below(form, "Camera.")) {
    const bool is_stella = form.find_any({"Camera.cols", "Camera.rows", "Camera.setup",
                                          "Camera.focal_x_baseline"}) != nullptr;
    return is_stella ? read_stella(form) : read_orbslam(form, false);
  }
  if (has_below(form, "projection_parameters.")) return read_camodocal(form);
  if (has_below(form, "cam.")) return read_niceslam(form);
  if (form.find_any(kMatrixKeys) != nullptr) return read_matrix(form);
  if (form.find("intrinsics") != nullptr) return read_lists(form);
  if (form.find_any({"ppx", "ppy"}) != nullptr) return read_realsense(form);
  if (has_below(form, "") || form.find_any({"width", "height", "depth_scale"}) != nullptr) {
    return read_own(form);
  }
  return Error{fmt::format("{}: not a form of camera file that is known; known are {}", form.file(),
                           kKnownForms)};
}

}  // namespace

Result<GivenCamera> read_camera_form(const std::filesystem::path& file,
                                     std::optional<double> depth_scale) {
  const Result<YAML::Node> root = read_yaml(file, Keys::may_contradict);
  if (!root) return root.error();
  if (!root->IsMap()) return Error{fmt::format("{}: must hold 'key: value' lines", file.string())};
  Entries entries;
  append_entries(*root, "", file.string(), entries);
  if (depth_scale && !(*root)["depth_scale"]) {
    entries.push_back({"depth_scale", {fmt::format("{}", *depth_scale)}, false, file.string()});
  }
  Form form(file.string(), std::move(entries));
  if (const Names cameras = cameras_of_chain(form); cameras.size() == 1) {
    form.enter(cameras.front() + ".");
  } else if (cameras.size() > 1) {
    return Error{fmt::format("{}: holds the cameras {}; keep the one of the colour pictures",
                             file.string(), fmt::join(cameras, ", "))};
  }
  if (auto r = check_lens_names(form); !r) return r.error();
  if (auto r = check_no_more_terms(form); !r) return r.error();
  // A value that is missing explains why another stands twice.
  Result<GivenCamera> camera = read_form(form);
  if (auto r = check_keys_differ(*root, file.string()); camera && !r) return r.error();
  return camera;
}

}  // namespace ydd
