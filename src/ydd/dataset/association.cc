// SPDX-License-Identifier: Apache-2.0
#include "ydd/dataset/association.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <tuple>

namespace ydd {
namespace {

struct Candidate {
  std::int64_t difference_ns = 0;
  IndexPair pair;
};

void require_increasing(std::span<const Timestamp> stamps) {
  const auto bad = std::adjacent_find(stamps.begin(), stamps.end(), std::greater_equal<>());
  if (bad != stamps.end()) throw std::logic_error("associate: stamps are not strictly increasing");
}

std::vector<Candidate> candidates(std::span<const Timestamp> a, std::span<const Timestamp> b,
                                  std::int64_t max_difference_ns) {
  std::vector<Candidate> found;
  std::size_t first = 0;  // of b that is not too early for a[i]; only ever moves on
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (first < b.size() && b[first].ns <= a[i].ns - max_difference_ns) ++first;
    for (std::size_t j = first; j < b.size() && b[j].ns < a[i].ns + max_difference_ns; ++j) {
      found.push_back({std::abs(b[j].ns - a[i].ns), {i, j}});
    }
  }
  return found;
}

}  // namespace

std::vector<IndexPair> associate(std::span<const Timestamp> a, std::span<const Timestamp> b,
                                 double max_difference_s) {
  require_increasing(a);
  require_increasing(b);
  std::vector<Candidate> found = candidates(a, b, std::llround(max_difference_s * 1e9));
  std::sort(found.begin(), found.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.difference_ns, x.pair.a, x.pair.b) <
           std::tie(y.difference_ns, y.pair.a, y.pair.b);
  });
  std::vector<bool> a_taken(a.size());
  std::vector<bool> b_taken(b.size());
  std::vector<IndexPair> pairs;
  for (const Candidate& candidate : found) {
    if (a_taken[candidate.pair.a] || b_taken[candidate.pair.b]) continue;
    a_taken[candidate.pair.a] = true;
    b_taken[candidate.pair.b] = true;
    pairs.push_back(candidate.pair);
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const IndexPair& x, const IndexPair& y) { return x.a < y.a; });
  return pairs;
}

std::size_t nearest_index(std::span<const Timestamp> stamps, Timestamp stamp) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (after == stamps.begin()) return 0;
  const auto index = static_cast<std::size_t>(after - stamps.begin());
  if (after == stamps.end()) return index - 1;
  return stamps[index].ns - stamp.ns < stamp.ns - stamps[index - 1].ns ? index : index - 1;
}

}  // namespace ydd
