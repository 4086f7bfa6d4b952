// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/timing.h"

#include <ctime>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ydd {
namespace {

std::int64_t read_clock_ns(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

/// Linear interpolation between the two nearest ranks of a sorted series.
double quantile(const std::vector<double>& sorted, double q) {
  const double rank = q * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(rank));
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (rank - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

std::int64_t wall_clock_ns() { return read_clock_ns(CLOCK_MONOTONIC); }
std::int64_t thread_cpu_ns() { return read_clock_ns(CLOCK_THREAD_CPUTIME_ID); }

StageTimer::StageTimer(StageTimes& times, std::string stage)
    : times_(&times),
      stage_(std::move(stage)),
      wall_start_ns_(wall_clock_ns()),
      cpu_start_ns_(thread_cpu_ns()) {}

StageTimer::~StageTimer() {
  try {
    stop();
  } catch (...) {  // no memory for it: a time is lost, not the run
  }
}

void StageTimer::stop() {
  if (!times_) return;
  times_->push_back({stage_, static_cast<double>(wall_clock_ns() - wall_start_ns_) * 1e-6,
                     static_cast<double>(thread_cpu_ns() - cpu_start_ns_) * 1e-6});
  times_ = nullptr;
}

SeriesStatistics statistics_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  SeriesStatistics s;
  s.count = values.size();
  s.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(s.count);
  s.median = quantile(values, 0.5);
  s.p05 = quantile(values, 0.05);
  s.p95 = quantile(values, 0.95);
  s.p99 = quantile(values, 0.99);
  s.min = values.front();
  s.max = values.back();
  return s;
}

}  // namespace ydd
