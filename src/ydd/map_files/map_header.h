// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "ydd/map_files/map_key.h"

/// What can be told of a map file before SQLite touches it. Inside the room only.
namespace ydd::map_format {

/// @throws Fault with one clear reason when the file is missing, foreign, of a newer version or cut
/// short; Refused when it is encrypted and there is no key, or the other way round. Of an encrypted
/// one all else is told when it is opened.
void check_header(const std::filesystem::path& file, const MapKey& key = {});

/// If a save was killed half-way and nobody is writing now, lets SQLite roll it back. @throws Fault
void recover(const std::filesystem::path& file, const MapKey& key = {});

/// What is said of a file of such a version.
std::string newer_version(std::int64_t version);

}  // namespace ydd::map_format
