// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <thread>

#include "ydd/base/channel.h"
#include "ydd/base/timing.h"
#include "ydd/map_files/map_file.h"

namespace ydd {

/// Saves snapshots of the map to a file in a thread of its own: neither tracking nor mapping waits
/// for the disk. At most one save is under way. What a save throws is its failure.
///
/// Thread: one caller.
class MapSaver {
 public:
  /// `every_s` 0: only when asked by `save`.
  MapSaver(MapWriter writer, double every_s);
  ~MapSaver();
  MapSaver(const MapSaver&) = delete;
  MapSaver& operator=(const MapSaver&) = delete;

  /// Hands the map over if it is time: `every_s` since the last save began, and ten times as long
  /// as that took, so that large maps on slow disks do not keep it busy. Nothing is done while a
  /// save is under way or when the map has not changed. Never waits; a failure is logged.
  void offer(const std::shared_ptr<const Atlas>& atlas);

  /// Saves now and waits for it.
  Result<void> save(std::shared_ptr<const Atlas> atlas);

  const std::filesystem::path& file() const { return file_; }
  /// Of all saves: "save_whole" or "save_changes". Complete when no save is under way.
  StageTimes times();

 private:
  struct Task {
    std::shared_ptr<const Atlas> atlas;
    bool answered = false;  ///< somebody waits for the result
  };
  void run() noexcept;
  void work_off();
  Result<void> work(const std::shared_ptr<const Atlas>& atlas);

  const std::filesystem::path file_;
  const double every_s_;
  MapWriter writer_;  // of thread_
  StageTimes times_;  // likewise; read while idle
  std::atomic<bool> busy_ = false;
  std::atomic<double> last_s_ = 0;
  std::int64_t last_start_ns_;
  std::uint64_t handed_over_ = 0;  ///< revision
  Channel<Task> tasks_{1};
  Channel<Result<void>> answers_{1};
  std::jthread thread_;
};

}  // namespace ydd
