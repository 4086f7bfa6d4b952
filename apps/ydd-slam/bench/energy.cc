// SPDX-License-Identifier: Apache-2.0
#include "bench/energy.h"

#include <fstream>
#include <string>

namespace ydd::app {
namespace {

namespace fs = std::filesystem;

std::optional<double> number_in(const fs::path& file) {
  std::ifstream stream(file);
  double value = 0;
  if (!(stream >> value)) return std::nullopt;
  return value;
}

}  // namespace

EnergyMeter::EnergyMeter() {
  std::error_code error;
  for (const fs::directory_entry& zone : fs::directory_iterator("/sys/class/powercap", error)) {
    const std::string name = zone.path().filename().string();
    // "intel-rapl:0" is a package; "intel-rapl:0:0" is a part of it.
    if (name.find(':') == std::string::npos || name.find(':') != name.rfind(':')) continue;
    const auto start = number_in(zone.path() / "energy_uj");
    const auto range = number_in(zone.path() / "max_energy_range_uj");
    if (start && range) counters_.push_back({zone.path() / "energy_uj", *start, *range});
  }
}

std::optional<double> EnergyMeter::joules() const {
  if (counters_.empty()) return std::nullopt;
  double sum_uj = 0;
  for (const Counter& counter : counters_) {
    const auto now = number_in(counter.file);
    if (!now) return std::nullopt;
    const double used = *now - counter.start_uj;
    sum_uj += used < 0 ? used + counter.range_uj : used;
  }
  return 1e-6 * sum_uj;
}

}  // namespace ydd::app
