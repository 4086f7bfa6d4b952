// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/fresh_folder.h"

#include <unistd.h>

#include <system_error>

#include <fmt/format.h>

namespace ydd {
namespace {

namespace fs = std::filesystem;

void remove_quietly(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace

FreshFolder::FreshFolder(const fs::path& target)
    : target_(target), path_(target.has_filename() ? target : target.parent_path()) {  // "out/"
  path_ += fmt::format(".{}.part", ::getpid());
  remove_quietly(path_);
}

FreshFolder::~FreshFolder() { remove_quietly(path_); }

Result<void> FreshFolder::place() const {
  std::error_code failure;
  fs::rename(path_, target_, failure);
  if (!failure) return {};
  return Error{fmt::format("{}: cannot be named {}: {}", path_.string(), target_.string(),
                           failure.message())};
}

}  // namespace ydd
