// SPDX-License-Identifier: Apache-2.0
#include "run/run_folder.h"

#include <unistd.h>

#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

void point_latest_at(const fs::path& folder) {
  // By rename, so that there is never no link; a failure costs only the convenience.
  std::error_code ignored;
  const fs::path link = folder.parent_path() / "latest";
  const fs::path fresh = folder.parent_path() / fmt::format(".latest.{}", ::getpid());
  fs::remove(fresh, ignored);
  fs::create_directory_symlink(folder.filename(), fresh, ignored);
  fs::rename(fresh, link, ignored);
}

/// Two runs may start within one second.
fs::path free_name(const fs::path& wanted) {
  fs::path name = wanted;
  for (int i = 2; fs::exists(name); ++i) name = fmt::format("{}-{}", wanted.string(), i);
  return name;
}

}  // namespace

NewFolders::~NewFolders() {
  std::error_code ignored;  // what somebody has put something into stays
  std::for_each(made_.rbegin(), made_.rend(), [&](const fs::path& p) { fs::remove(p, ignored); });
}

Result<void> NewFolders::make(const fs::path& folder) {
  fs::path so_far;
  std::error_code error;
  for (const fs::path& part : folder) {
    so_far /= part;
    if (fs::create_directory(so_far, error)) made_.push_back(so_far);
    if (error) break;
  }
  if (!error && fs::is_directory(folder, error)) return {};
  return Error{fmt::format("{}: the folder for results cannot be created: {}", folder.string(),
                           error.message())};
}

Result<RunFolder> RunFolder::make(const std::string& out, const std::string& sequence) {
  RunFolder folder;
  folder.named_ = !out.empty();
  folder.path_ =
      folder.named_ ? fs::path(out)
                    : free_name(fs::path("runs") / fmt::format("{}-{:%Y%m%d-%H%M%S}", sequence,
                                                               fmt::localtime(std::time(nullptr))));
  if (auto r = folder.new_folders_.make(folder.path_); !r) return r.error();
  return folder;
}

void RunFolder::keep() {
  new_folders_.keep();
  if (!named_) point_latest_at(path_);
}

}  // namespace ydd::app
