// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

/// What can be told of a map file before SQLite touches it. Inside the room only.
namespace ydd::map_format {

/// @throws Fault with one clear reason when the file is missing, foreign, of a newer version or cut
/// short.
void check_header(const std::filesystem::path& file);

/// If a save was killed half-way and nobody is writing now, lets SQLite roll it back. @throws Fault
void recover(const std::filesystem::path& file);

}  // namespace ydd::map_format
