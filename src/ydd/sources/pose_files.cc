// SPDX-License-Identifier: Apache-2.0
#include "ydd/sources/pose_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "ydd/dataset/text_table.h"

namespace ydd::sources {
namespace {

namespace fs = std::filesystem;

Result<std::vector<double>> row_numbers(const fs::path& file, const TextRow& row) {
  std::vector<double> numbers;
  for (const std::string& field : row.fields) {
    double number = 0;
    const char* const begin = field.data() + (field.starts_with('+') ? 1 : 0);
    const char* const end = field.data() + field.size();
    const auto [stop, code] = std::from_chars(begin, end, number);
    if (code != std::errc() || stop != end) {
      return row_error(file, row, fmt::format("'{}' is not a number", field));
    }
    numbers.push_back(number);
  }
  return numbers;
}

Result<StampedPoses> read_pose_files(const fs::path& folder,
                                     const std::vector<std::pair<Timestamp, fs::path>>& files) {
  StampedPoses poses;
  for (const auto& [stamp, file] : files) {
    if (!fs::exists(file)) continue;
    const Result<Eigen::Matrix4d> matrix = read_matrix_file(file);
    if (!matrix) return matrix.error();
    const Result<std::optional<SE3>> pose = motion_of(*matrix, file.string());
    if (!pose) return pose.error();
    if (*pose) poses.push_back({stamp, **pose});
  }
  if (poses.empty()) return Error{fmt::format("{}: holds no pose", folder.string())};
  return poses;
}

Result<StampedPoses> read_pose_log(const fs::path& file, const std::vector<Timestamp>& stamps) {
  constexpr std::size_t kLines = 5;  // of a pose
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  const auto& rows = table->rows;
  StampedPoses poses;
  for (std::size_t i = 0; i + kLines <= rows.size(); i += kLines) {
    const Result<std::vector<double>> head = row_numbers(file, rows[i]);
    if (!head) return head.error();
    const double frame = head->front();
    if (head->size() != 3 || !(frame >= 0) || frame >= static_cast<double>(stamps.size())) {
      return row_error(file, rows[i],
                       fmt::format("expected 'frame frame next', the frame below {}, found {}",
                                   stamps.size(), quoted(rows[i])));
    }
    Eigen::Matrix4d matrix;
    for (int r = 0; r < 4; ++r) {
      const TextRow& row = rows[i + 1 + static_cast<std::size_t>(r)];
      const Result<std::vector<double>> numbers = row_numbers(file, row);
      if (!numbers) return numbers.error();
      if (numbers->size() != 4) {
        return row_error(file, row, "expected four numbers, found " + quoted(row));
      }
      for (int c = 0; c < 4; ++c) matrix(r, c) = (*numbers)[static_cast<std::size_t>(c)];
    }
    const auto pose = motion_of(matrix, fmt::format("{}:{}", file.string(), rows[i].line));
    if (!pose) return pose.error();
    const Timestamp stamp = stamps[static_cast<std::size_t>(frame)];
    if (!poses.empty() && stamp <= poses.back().stamp) {
      return row_error(file, rows[i], "its frame is not later than the one before");
    }
    if (*pose) poses.push_back({stamp, **pose});
  }
  if (rows.size() % kLines != 0) {
    return row_error(file, rows.back(), "the last pose is cut off: a pose takes five lines");
  }
  if (poses.empty()) return Error{fmt::format("{}: holds no pose", file.string())};
  return poses;
}

}  // namespace

Result<Eigen::Matrix4d> read_matrix_file(const fs::path& file) {
  const Result<TextTable> table = read_text_table(file);
  if (!table) return table.error();
  std::vector<double> numbers;
  for (const TextRow& row : table->rows) {
    const Result<std::vector<double>> more = row_numbers(file, row);
    if (!more) return more.error();
    numbers.insert(numbers.end(), more->begin(), more->end());
  }
  if (numbers.size() != 16) {
    return Error{fmt::format("{}: expected the 16 numbers of a matrix, found {}", file.string(),
                             numbers.size())};
  }
  return Eigen::Matrix4d(
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data()));
}

Result<std::optional<SE3>> motion_of(const Eigen::Matrix4d& matrix, const std::string& where) {
  if (!matrix.allFinite()) return std::optional<SE3>();
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  constexpr double kRounding = 0.01;
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kRounding) || R.determinant() < 0) {
    return Error{
        fmt::format("{}: the matrix is no pose (its rotation is off by {:.3g})", where, off)};
  }
  return std::optional(SE3(R, matrix.topRightCorner<3, 1>()));
}

GroundTruth truth_of_files(const fs::path& folder,
                           std::vector<std::pair<Timestamp, fs::path>> files) {
  return {folder, false,
          [folder, files = std::move(files)] { return read_pose_files(folder, files); }};
}

GroundTruth truth_of_log(const fs::path& file, std::vector<Timestamp> stamps) {
  return {file, false, [file, stamps = std::move(stamps)] { return read_pose_log(file, stamps); }};
}

}  // namespace ydd::sources
