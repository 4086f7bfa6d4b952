// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/dataset/recording.h"
#include "ydd/dataset/sequence.h"

/// Recordings of every kind that is known: what lies at a path tells which one it is, or
/// SequenceOptions::source names it. A source is one file here that makes a `Recording`.
namespace ydd {

/// What SequenceOptions::source may be.
std::vector<std::string> source_names();

/// For a user who chooses: a line "name  what it looks like" for each source.
std::string source_table();

/// Finds the pictures of the recording at `path`, its camera and its truth. No picture is decoded.
/// What names a camera that is plugged in starts it (Recording::live).
/// One line says why not: nothing there, no source that knows it, a list that is damaged.
Result<Recording> open_recording(const std::filesystem::path& path,
                                 const SequenceOptions& options = {});

/// The same, with colour and depth paired. A camera is refused: it is no recording yet.
Result<Sequence> open_sequence(const std::filesystem::path& path,
                               const SequenceOptions& options = {});

}  // namespace ydd
