// SPDX-License-Identifier: Apache-2.0
// What recognising a place costs as the map grows: bag of words of a picture, comparison of two,
// and a query among N keyframes (synthetic: every keyframe draws its words at random, with the
// number of words that a frame of 1000 points has).
#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "ydd/place/place_query.h"

namespace ydd {
namespace {

constexpr int kWords = 10000;
constexpr int kWordsOfAFrame = 700;

BagOfWords random_words(std::mt19937& random) {
  std::vector<std::uint16_t> all(kWords);
  for (int i = 0; i < kWords; ++i) all[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(i);
  BagOfWords bag;
  std::sample(all.begin(), all.end(), std::back_inserter(bag.words), kWordsOfAFrame, random);
  bag.weights.assign(bag.words.size(), 1.0F / kWordsOfAFrame);
  return bag;
}

void WordsOfAFrame(benchmark::State& state) {
  std::mt19937_64 random(1);
  std::vector<Descriptor> descriptors(1000);
  for (Descriptor& d : descriptors) {
    for (auto& part : d) part = static_cast<std::remove_reference_t<decltype(part)>>(random());
  }
  for (auto _ : state) benchmark::DoNotOptimize(bag_of_words(builtin_vocabulary(), descriptors));
}

/// By the index, or by comparing with every keyframe.
void Query(benchmark::State& state, bool exhaustive) {
  std::mt19937 random(1);
  Camera camera;
  Atlas atlas(camera, PyramidScales::make(8, 1.2));
  const MapId map = atlas.new_map();
  const auto nothing_seen = std::make_shared<const Features>();
  for (int i = 0; i < state.range(0); ++i) {
    KeyFrame keyframe;
    keyframe.map = map;
    keyframe.shared_features = nothing_seen;
    keyframe.words = std::make_shared<const BagOfWords>(random_words(random));
    atlas.add_keyframe(std::move(keyframe));
  }
  const BagOfWords query = random_words(random);
  for (auto _ : state) {
    const auto anybody = [](KeyFrameId) { return true; };
    const auto found = exhaustive ? query_places_exhaustively(atlas, query, anybody, 24)
                                  : query_places(atlas, query, anybody, 24);
    benchmark::DoNotOptimize(found.data());
  }
  state.counters["kB_a_keyframe"] =
      static_cast<double>(kWordsOfAFrame * (sizeof(std::uint16_t) + sizeof(float))) / 1024.0;
}

BENCHMARK(WordsOfAFrame)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Query, index, false)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(50000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Query, exhaustive, true)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(50000)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ydd

BENCHMARK_MAIN();
