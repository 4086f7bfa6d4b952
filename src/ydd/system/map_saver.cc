// SPDX-License-Identifier: Apache-2.0
#include "ydd/system/map_saver.h"

#include <algorithm>
#include <utility>

#include "ydd/base/guard.h"
#include "ydd/base/log.h"

namespace ydd {
namespace {

constexpr double kRestPerWork = 10.0;

}  // namespace

MapSaver::MapSaver(MapWriter writer, double every_s)
    : file_(writer.file()),
      every_s_(every_s),
      writer_(std::move(writer)),
      last_start_ns_(wall_clock_ns()),
      thread_([this] { run(); }) {}

MapSaver::~MapSaver() { tasks_.close(); }

void MapSaver::offer(const std::shared_ptr<const Atlas>& atlas) {
  const std::int64_t now_ns = wall_clock_ns();
  const double rest_s = std::max(every_s_, kRestPerWork * last_s_.load());
  const bool due = every_s_ > 0 && static_cast<double>(now_ns - last_start_ns_) * 1e-9 >= rest_s;
  if (atlas->keyframes().empty()) return;  // nothing that a file should be made for
  if (!due || busy_.load() || atlas->revision() == handed_over_) return;
  last_start_ns_ = now_ns;
  handed_over_ = atlas->revision();
  busy_.store(true);
  if (!tasks_.try_push({atlas, false})) busy_.store(false);
}

Result<void> MapSaver::save(std::shared_ptr<const Atlas> atlas) {
  handed_over_ = atlas->revision();
  tasks_.push({std::move(atlas), true});
  if (auto answer = answers_.pop()) return *std::move(answer);
  return Error{file_.string() + ": the thread that saves the map has ended"};
}

StageTimes MapSaver::times() {
  busy_.wait(true);
  return times_;
}

void MapSaver::run() noexcept {
  (void)guarded("", [&]() -> Result<void> {
    work_off();
    return {};
  });
  tasks_.close();  // nobody waits for a thread that has ended
  answers_.close();
  busy_.store(false);
  busy_.notify_all();
}

void MapSaver::work_off() {
  while (auto task = tasks_.pop()) {
    Result<void> saved = guarded(file_.native(), [&] { return work(task->atlas); });
    if (!saved && !task->answered) {
      log::warning("{}; the map goes on, the file holds an earlier state", saved.error().message);
    }
    const bool answered = task->answered;
    task.reset();  // lets go of the snapshot
    busy_.store(false);
    busy_.notify_all();
    if (answered) answers_.push(std::move(saved));
  }
}

Result<void> MapSaver::work(const std::shared_ptr<const Atlas>& atlas) {
  StageTimes times;
  StageTimer timer(times, "save");
  const Result<MapSave> saved = writer_.save(atlas);
  timer.stop();
  last_s_.store(times.front().wall_ms * 1e-3);
  if (!saved) return saved.error();
  times.front().stage = saved->whole ? "save_whole" : "save_changes";
  times_.push_back(times.front());
  return {};
}

}  // namespace ydd
