// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <yaml-cpp/yaml.h>

#include "ydd/base/one_line.h"
#include "ydd/base/result.h"

namespace ydd {

/// The one way to read YAML: a file may come from anybody. Refused with one line "source:line:
/// reason" are
///
/// - text of more than 4 MiB, or with a zero byte;
/// - nesting of more than 32 levels, an alias inside of what it names, and aliases that make more
///   than 100,000 values of the text;
/// - more than one document;
/// - a key that stands twice in one map with different values (see check_keys_differ).
///
/// A file that starts with "%YAML:1.0" is read in OpenCV's dialect, in which "key:value" needs no
/// blank. Text without a document is a null node.
enum class Keys { must_differ, may_contradict };
Result<YAML::Node> parse_yaml(const std::string& text, const std::string& source,
                              Keys keys = Keys::must_differ);

/// The same of a regular file: a folder, pipe or device is refused before it is opened.
Result<YAML::Node> read_yaml(const std::filesystem::path& file, Keys keys = Keys::must_differ);

/// Fails with both lines where a key stands twice in one map of `node` with different values; the
/// same value twice passes. For who reads with Keys::may_contradict, to say something better first.
Result<void> check_keys_differ(const YAML::Node& node, const std::string& source);

/// "source:line" of `node`, for an error.
std::string yaml_line(const std::string& source, const YAML::Node& node);

}  // namespace ydd
