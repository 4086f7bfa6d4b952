// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"
#include "ydd/dataset/sequence.h"

/// What a source is to the table in source.cc, and those that there are. Inside this room only.
namespace ydd::sources {

/// A kind of recording.
struct Layout {
  const char* name;  ///< what --source takes
  const char* what;  ///< how one looks, for help and errors
  /// Whether `path` looks like one: by names alone, without reading a picture.
  bool (*recognises)(const std::filesystem::path& path);
  Result<Recording> (*open)(const std::filesystem::path& path, const SequenceOptions& options);
  bool is_camera = false;  ///< then `path` is no path, but names one of these cameras
};

Layout tum_layout();        ///< rgb.txt and depth.txt; tum_folder.cc
Layout icl_layout();        ///< icl_folder.cc
Layout openloris_layout();  ///< openloris_folder.cc
Layout seven_scenes_layout();
Layout scannet_layout();
Layout open3d_layout();     ///< picture_folders.cc
Layout realsense_layout();  ///< picture_folders.cc

Layout sens_layout();  ///< sens_file.cc
Layout bag_layout();   ///< bag_source.cc

Layout openni2_layout();  ///< openni2_source.cc

/// Whether the name is there, as whatever kind.
bool has(const std::filesystem::path& folder, const char* name);

}  // namespace ydd::sources
