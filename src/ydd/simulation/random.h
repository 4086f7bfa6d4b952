// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace ydd::sim {

/// Scrambles 64 bits (the finaliser of SplitMix64, Steele et al. 2014): a hash of counters.
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

/// Hash of two values; order matters.
inline std::uint64_t mix_bits(std::uint64_t a, std::uint64_t b) {
  return mix_bits(mix_bits(a) ^ (b * 0xD6E8FEB86659FD93ULL));
}

/// Uniform in [0, 1) from the upper bits of a hash.
inline float unit_float(std::uint64_t bits) {
  return static_cast<float>(bits >> 40U) * (1.0F / 16777216.0F);
}

/// Zero mean, unit variance, nearly normal: the sum of four uniforms (Irwin-Hall), bounded by
/// 3.46. One multiplication instead of a logarithm: sensor noise needs a million a frame.
inline float quick_normal(std::uint64_t bits) {
  const auto part = [bits](unsigned shift) {
    return static_cast<float>((bits >> shift) & 0xFFFFU) * (1.0F / 65536.0F);
  };
  constexpr float kSqrt3 = 1.7320508F;
  return (part(0) + part(16) + part(32) + part(48) - 1.99997F) * kSqrt3;
}

/// A small generator whose sequence is the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix_bits(seed)) {}

  std::uint64_t bits() { return mix_bits(state_++); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  float uniform_f(float low, float high) {
    return low + (high - low) * static_cast<float>(uniform());
  }
  /// In [low, high], both included.
  int integer(int low, int high) {
    return low + static_cast<int>(uniform() * static_cast<double>(high - low + 1));
  }
  bool chance(double probability) { return uniform() < probability; }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// An independent generator; the same `stream` gives the same one as long as this generator has
  /// not advanced.
  Random fork(std::uint64_t stream) const { return Random(mix_bits(state_, stream)); }

 private:
  std::uint64_t state_;
};

}  // namespace ydd::sim
