// SPDX-License-Identifier: Apache-2.0
//
// Cameras through OpenNI2 as recordings that are not there yet: "openni2", or "openni2:URI".
#include <string>
#include <utility>

#include "ydd/cameras/openni2.h"
#include "ydd/sources/layout.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOpenNi2 = "openni2";

bool names_openni2(const fs::path& path) {
  const std::string name = path.string();
  std::error_code failure;
  return (name == kOpenNi2 && !fs::exists(path, failure)) || name.starts_with("openni2:");
}

/// With --source openni2 the URI may stand alone.
std::string uri_of(const fs::path& path) {
  const std::string name = path.string();
  if (name == kOpenNi2) return "";
  return name.starts_with("openni2:") ? name.substr(kOpenNi2.size() + 1) : name;
}

Result<Recording> open_openni2(const fs::path& path, const SequenceOptions& options) {
  if (!options.associations.empty() || options.depth_offset != "0") {
    return Error{
        "openni2: a camera's pictures are paired as they come: leave out --associations and "
        "--depth-offset"};
  }
  Result<OpenedCamera> camera =
      open_openni2_camera(uri_of(path), options.camera_mode, options.max_difference_s);
  if (!camera) return camera.error();
  Recording recording;
  recording.live = std::move(camera->stream);
  if (camera->camera) recording.depth_scale = camera->camera->depth_scale;
  recording.camera = std::move(camera->camera);
  return recording;
}

}  // namespace

Layout openni2_layout() {
  return {"openni2", "camera through OpenNI2: 'openni2' or 'openni2:URI' (ydd-slam cameras)",
          names_openni2, open_openni2, true};
}

}  // namespace ydd::sources
