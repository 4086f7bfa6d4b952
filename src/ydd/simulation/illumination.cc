// SPDX-License-Identifier: Apache-2.0
#include "ydd/simulation/illumination.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ydd/simulation/random.h"

namespace ydd::sim {
namespace {

constexpr double kBlend_s = 1.5;  // from one light to the next: clouds, and people at switches

enum class Hour { day, evening, lamps };

/// One light that stays as it is.
struct Mood {
  SourceLight sources;
  double exposure = 1.0;  ///< what the automatic of the camera gets wrong, a factor
};

/// What shines at an hour, a little different each time.
Mood mood_of(Hour hour, Random random) {
  const auto shine = [&](double level, double temperature_k) -> Eigen::Array3f {
    const double varied_k = temperature_k * random.uniform(0.92, 1.08);
    return static_cast<float>(level * random.uniform(0.75, 1.25)) * colour_of_temperature(varied_k);
  };
  Mood mood;
  const auto set = [&](LightSource source, double level, double temperature_k) {
    mood.sources[static_cast<std::size_t>(source)] = shine(level, temperature_k);
  };
  mood.sources[static_cast<std::size_t>(LightSource::itself)] = Eigen::Array3f::Ones();
  switch (hour) {
    case Hour::day:
      set(LightSource::sky, 0.45, 6500);
      set(LightSource::ceiling, 0.0, 4000);
      set(LightSource::window, 1.0, 6500);
      set(LightSource::sun, random.chance(0.6) ? 0.9 : 0.0, 5300);
      set(LightSource::desk, 0.0, 2700);
      break;
    case Hour::evening:
      set(LightSource::sky, 0.25, 3300);
      set(LightSource::ceiling, 0.9, 3200);
      set(LightSource::window, 0.03, 9000);
      set(LightSource::sun, 0.0, 5300);
      set(LightSource::desk, 0.25, 2700);
      break;
    case Hour::lamps:
      set(LightSource::sky, 0.14, 2900);
      set(LightSource::ceiling, 0.0, 3200);
      set(LightSource::window, 0.01, 9000);
      set(LightSource::sun, 0.0, 5300);
      set(LightSource::desk, 1.0, 2700);
      break;
  }
  mood.exposure = random.uniform(0.85, 1.15);
  return mood;
}

Mood blended(const Mood& from, const Mood& to, double part) {
  Mood out;
  const double smooth = part * part * (3.0 - 2.0 * part);
  const auto p = static_cast<float>(smooth);
  for (std::size_t i = 0; i < out.sources.size(); ++i) {
    out.sources[i] = (1.0F - p) * from.sources[i] + p * to.sources[i];
  }
  out.exposure = std::lerp(from.exposure, to.exposure, smooth);
  return out;
}

/// The n-th of an endless row of lights, no hour twice in succession.
Mood nth_mood(std::uint64_t seed, int n) {
  const auto start = static_cast<int>(mix_bits(seed, 17) % 3);
  const int stride = (mix_bits(seed, 18) & 1U) != 0 ? 1 : 2;
  const auto hour = static_cast<Hour>((start + n * stride) % 3);
  return mood_of(hour, Random(mix_bits(seed, 100 + static_cast<std::uint64_t>(n))));
}

/// Where the sun stands beyond a window in the west: -x is out of the window.
Vector3 sun_direction(Random random) {
  const double azimuth_rad = random.uniform(-0.9, 0.9);
  const double height_rad = random.uniform(0.25, 0.7);
  return {static_cast<float>(-std::cos(azimuth_rad) * std::cos(height_rad)),
          static_cast<float>(std::sin(azimuth_rad) * std::cos(height_rad)),
          static_cast<float>(std::sin(height_rad))};
}

}  // namespace

Eigen::Array3f colour_of_temperature(double temperature_k) {
  constexpr double kWhite_k = 5500.0;
  constexpr double kSecondConstant_m_k = 1.4388e-2;  // of radiation
  constexpr std::array<double, 3> kLength_m = {465e-9, 550e-9, 610e-9};
  Eigen::Array3d colour;
  for (int i = 0; i < 3; ++i) {
    const double at = kSecondConstant_m_k / kLength_m[static_cast<std::size_t>(i)];
    colour[i] = std::expm1(at / kWhite_k) / std::expm1(at / temperature_k);
  }
  return (colour / colour[1]).cast<float>();
}

std::optional<LightChanges> make_light_changes(const WorldOptions& options) {
  if (options.light == LightKind::steady) return std::nullopt;
  const std::uint64_t seed = mix_bits(static_cast<std::uint64_t>(options.light_seed), 2013);
  LightChanges changes;
  changes.to_sun = sun_direction(Random(mix_bits(seed, 1)));
  if (options.light != LightKind::changing) {
    const auto hour = static_cast<Hour>(static_cast<int>(options.light) - 1);
    const Mood mood = mood_of(hour, Random(mix_bits(seed, 2)));
    changes.at = [mood](double) { return LightNow{mood.sources, mood.exposure}; };
    return changes;
  }
  changes.at = [seed, every_s = options.light_change_s](double time_s) {
    const double t = std::max(time_s, 0.0) / every_s;
    const int n = static_cast<int>(t);
    const double left_s = (1.0 - (t - n)) * every_s;
    const double blend_s = std::min(kBlend_s, 0.5 * every_s);
    Mood mood = nth_mood(seed, n);
    if (left_s < blend_s) mood = blended(mood, nth_mood(seed, n + 1), 1.0 - left_s / blend_s);
    return LightNow{mood.sources, mood.exposure};
  };
  return changes;
}

Eigen::Array3f automatic_gain(const std::vector<Eigen::Array3f>& colours, double exposure) {
  constexpr double kMean = 105.0;  // of a picture that is well exposed
  constexpr double kTrust = 0.8;   // how far it goes there
  constexpr double kBalance = 0.5;
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const Eigen::Array3f& c : colours) sum += c.min(255.0F).cast<double>();
  const Eigen::Array3d mean =
      (sum / static_cast<double>(std::max<std::size_t>(colours.size(), 1))).max(1.0);
  const double grey = mean.mean();
  const double level = std::clamp(std::pow(kMean / grey, kTrust), 0.4, 4.0);
  return (exposure * level * (grey / mean).pow(kBalance)).cast<float>();
}

}  // namespace ydd::sim
