// SPDX-License-Identifier: Apache-2.0
#include "run_folder.h"

#include <unistd.h>

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

}  // namespace

Result<fs::path> make_run_folder(const std::string& out, const std::string& sequence) {
  const bool named = !out.empty();
  const fs::path folder = named
                              ? fs::path(out)
                              : fs::path("runs") / fmt::format("{}-{:%Y%m%d-%H%M%S}", sequence,
                                                               fmt::localtime(std::time(nullptr)));
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    return Error{fmt::format("{}: the folder for results cannot be created: {}", folder.string(),
                             error.message())};
  }
  if (!named) point_latest_at(folder);
  return folder;
}

}  // namespace ydd::app
