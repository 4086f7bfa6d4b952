// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"

namespace ydd {

/// A sequence to measure on.
struct PaperSequence {
  std::string name;  ///< "fr3_walking_xyz", "bonn_crowd", or what the user calls it
  std::filesystem::path folder;
  bool own = false;  ///< a recording of the user's, not of a public data set
};

/// What lies below a folder.
struct FoundSequences {
  std::vector<PaperSequence> sequences;           ///< by name: those of TUM, then those of Bonn
  std::vector<std::string> missing;               ///< of the article's five
  std::vector<std::filesystem::path> duplicates;  ///< of a name that was found before
};

/// The five sequences of the article, in its order.
const std::vector<std::string>& article_sequences();

/// How long TUM says a sequence of the article is, in seconds: a recording of that name that is
/// much shorter is a clip of it.
std::optional<double> published_duration_s(std::string_view name);

/// The sequence that a folder or file name tells, however it is written:
/// "rgbd_dataset_freiburg3_walking_xyz", "fr3_w_xyz" and "tum_fr3_walking_xyz" are
/// "fr3_walking_xyz", "rgbd_bonn_crowd" is "bonn_crowd". Nothing for others, and for TUM's
/// validation recordings, which have no ground truth.
std::optional<std::string> sequence_name(std::string_view name);

/// Looks for folders with `rgb.txt` and such a name, at most six levels down. Failure: `data`
/// cannot be read, or holds no such folder.
Result<FoundSequences> find_paper_sequences(const std::filesystem::path& data);

}  // namespace ydd
