// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"
#include "ydd/geometry/se3.h"

/// Poses and intrinsics as matrices in text files.
namespace ydd::sources {

/// 16 numbers, row by row; also infinite ones.
Result<Eigen::Matrix4d> read_matrix_file(const std::filesystem::path& file);

/// Nothing where a number is not finite, which is how a pose that is unknown is written. Fails
/// unless it is a rotation, within 0.01, and a translation. `where` starts the error.
Result<std::optional<SE3>> motion_of(const Eigen::Matrix4d& matrix, const std::string& where);

/// A file for each frame: its stamp and its file with T_world_camera. Unknown poses and files that
/// are missing are left out.
GroundTruth truth_of_files(const std::filesystem::path& folder,
                           std::vector<std::pair<Timestamp, std::filesystem::path>> files);

/// Open3D's and Redwood's trajectory.log: a line "i i i+1" and four of T_world_camera for each
/// frame; i counts `stamps` from 0.
GroundTruth truth_of_log(const std::filesystem::path& file, std::vector<Timestamp> stamps);

}  // namespace ydd::sources
