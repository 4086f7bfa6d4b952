// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace ydd::app {

/// Energy of the processor packages since construction, from the kernel's power-capping interface
/// (RAPL counters), where the machine has one that may be read.
class EnergyMeter {
 public:
  EnergyMeter();
  /// Nothing where no counter can be read.
  std::optional<double> joules() const;

 private:
  struct Counter {
    std::filesystem::path file;
    double start_uj = 0;
    double range_uj = 0;  ///< it starts again from 0 there
  };
  std::vector<Counter> counters_;
};

}  // namespace ydd::app
