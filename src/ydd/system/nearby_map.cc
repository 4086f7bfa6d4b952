// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/nearby_map.h"

#include <algorithm>
#include <utility>

#include "ydd/place/place_query.h"

namespace ydd {
namespace {

constexpr std::size_t kPerPlace = 6;       // candidates, as the tracker asks for them
constexpr std::size_t kAroundPlace = 90;   // what relocalisation looks at, and its neighbours
constexpr std::size_t kAroundNewest = 32;  // the tracker tries the newest keyframe first

}  // namespace

Result<std::unique_ptr<NearbyMap>> NearbyMap::open(StoredMap map, const NearbyOptions& options) {
  Result<WordIndex> index = map.word_index(options.most_postings);
  if (!index) return index.error();
  std::unique_ptr<NearbyMap> nearby(new NearbyMap(std::move(map), std::move(*index), options));
  const KeyFrameId newest = nearby->map_.newest_keyframe();
  auto around =
      nearby->map_.neighbourhood({&newest, 1}, std::min(kAroundNewest, options.keyframes / 8 + 1));
  if (!around) return around.error();
  nearby->newest_ = std::move(*around);
  if (const Result<void> loaded = nearby->load(nearby->newest_); !loaded) return loaded.error();
  if (options.in_background) nearby->thread_ = std::jthread([raw = nearby.get()] { raw->run(); });
  return nearby;
}

NearbyMap::NearbyMap(StoredMap map, WordIndex index, const NearbyOptions& options)
    : map_(std::move(map)), index_(std::move(index)), options_(options) {}

NearbyMap::~NearbyMap() { tasks_.close(); }

void NearbyMap::follow(KeyFrameId reference) {
  if (reference == followed_) return;
  followed_ = reference;
  ask({reference, nullptr});
}

void NearbyMap::look_for(std::shared_ptr<const BagOfWords> words) {
  followed_ = {};
  ask({{}, std::move(words)});
}

void NearbyMap::ask(Task task) {
  if (options_.in_background) {
    tasks_.push_over(std::move(task));  // where the camera was before matters no more
    return;
  }
  const Result<void> done = guarded("", [&] { return work(task); });
  if (!done) failure_.set(done.error());
}

Result<bool> NearbyMap::submit(KeyFrameCandidate) {
  if (const Result<void> failed = failure_.get(); !failed) return failed.error();
  return false;
}

Result<void> NearbyMap::finish(Ending) {
  tasks_.close();
  if (thread_.joinable()) thread_.join();
  return failure_.get();
}

void NearbyMap::run() noexcept {
  const Result<void> done = guarded("", [&]() -> Result<void> {
    while (const auto task = tasks_.pop()) {
      if (const Result<void> worked = work(*task); !worked) return worked;
    }
    return {};
  });
  if (!done) failure_.set(done.error());
  tasks_.close();
}

Result<void> NearbyMap::work(const Task& task) {
  ++tasks_done_;
  auto wanted = task.words ? places_like(*task.words) : around(task.reference);
  if (!wanted) return wanted.error();
  bool all = true;
  for (const KeyFrameId id : *wanted) {
    const auto found = last_wanted_.find(id);
    all = all && found != last_wanted_.end();
    if (found != last_wanted_.end()) found->second = tasks_done_;
  }
  if (all) return {};
  if (!task.words) {  // the camera nears what is not there: as far as there is room, and at once
    wanted = map_.neighbourhood({&task.reference, 1}, 2 * options_.keyframes / 3);
    if (!wanted) return wanted.error();
  }
  return load(*wanted);
}

Result<std::vector<KeyFrameId>> NearbyMap::around(KeyFrameId reference) {
  return map_.neighbourhood({&reference, 1}, options_.keyframes / 3);
}

Result<std::vector<KeyFrameId>> NearbyMap::places_like(const BagOfWords& words) {
  const auto candidates = query_index(
      index_, words, [](KeyFrameId) { return true; },
      [&](const WordIndex::Entry& entry) { return map_.words(entry.keyframe); },
      kPerPlace * options_.places);
  const auto places = distinct_places(candidates, options_.places,
                                      [&](KeyFrameId id) { return map_.neighbours(id); });
  // First what tells places apart, then as much around each as there is room for.
  std::vector<KeyFrameId> out;
  for (const PlaceCandidate& c : candidates) out.push_back(c.keyframe);
  if (out.size() > options_.keyframes) out.resize(options_.keyframes);
  if (places.empty()) return out;
  const std::size_t room = (options_.keyframes - out.size()) / places.size();
  for (const PlaceCandidate& place : places) {
    const auto near = map_.neighbourhood({&place.keyframe, 1}, std::min(kAroundPlace, room));
    if (!near) return near.error();
    out.insert(out.end(), near->begin(), near->end());
  }
  return out;
}

Result<void> NearbyMap::load(const std::vector<KeyFrameId>& wanted) {
  for (const KeyFrameId id : wanted) last_wanted_[id] = tasks_done_;
  for (const KeyFrameId id : newest_) last_wanted_[id] = tasks_done_;
  if (last_wanted_.size() > options_.keyframes) {
    std::vector<std::pair<std::int64_t, KeyFrameId>> oldest;
    for (const auto& [id, task] : last_wanted_) {
      if (task != tasks_done_) oldest.emplace_back(task, id);
    }
    std::sort(oldest.begin(), oldest.end());
    const std::size_t too_many = last_wanted_.size() - options_.keyframes;
    oldest.resize(std::min(oldest.size(), too_many));
    for (const auto& [task, id] : oldest) last_wanted_.erase(id);
  }
  std::set<KeyFrameId> keyframes;
  for (const auto& [id, task] : last_wanted_) keyframes.insert(id);
  auto part = map_.part(keyframes);
  if (!part) return part.error();
  atlas_.set(std::move(*part));
  return {};
}

}  // namespace ydd
