// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include "command_line.h"

/// Pages in a real browser: Chromium without a window.
namespace ydd::e2e {

/// The browser: what YDD_CHROMIUM names, else one from PATH. Nothing where there is none, and for
/// sanitized tests, whose subject is not the browser.
inline std::optional<fs::path> chromium() {
  if (kSanitized) return std::nullopt;
  if (const char* const named = std::getenv("YDD_CHROMIUM")) return fs::path(named);
  const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find(':', start), path.size());
    const fs::path folder = path.substr(start, end - start);
    for (const char* const name : {"chromium", "chromium-browser", "google-chrome"}) {
      if (::access((folder / name).c_str(), X_OK) == 0) return folder / name;
    }
    start = end + 1;
  }
  return std::nullopt;
}

/// The document after its scripts have worked for a while: HTML on standard output, what scripts
/// complained about on standard error.
inline Outcome dump_dom(const std::string& url, const std::string& window_size = "1280,900") {
  const TemporaryFolder profile;
  return run_program({chromium().value().string(), "--headless", "--no-sandbox", "--disable-gpu",
                      "--disable-quic", "--no-first-run", "--disable-background-networking",
                      "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
                      "--enable-logging=stderr", "--user-data-dir=" + profile.path().string(),
                      "--window-size=" + window_size, "--virtual-time-budget=8000", "--dump-dom",
                      url});
}

}  // namespace ydd::e2e

/// For the beginning of a test.
#define YDD_NEEDS_CHROMIUM()                                                                       \
  if (!::ydd::e2e::chromium()) {                                                                   \
    GTEST_SKIP() << "no Chromium here: install the package chromium, or name one in YDD_CHROMIUM"; \
  }                                                                                                \
  static_assert(true)
