// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "ydd/sources/source.h"

namespace ydd::e2e {

/// Writes lists in the folder `to` that name the images of the sequence `from`, after
/// `alter(index, entry)` has changed their stamps or files; camera and ground truth come along.
template <class Alter>
void make_altered(const std::filesystem::path& from, const std::filesystem::path& to, Alter alter) {
  namespace fs = std::filesystem;
  const Result<Sequence> sequence = open_sequence(from);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  fs::create_directories(to);
  for (const char* const name : {"camera.yaml", "groundtruth.txt"}) {
    if (fs::exists(from / name)) fs::copy_file(from / name, to / name);
  }
  std::ofstream colour(to / "rgb.txt");
  std::ofstream depth(to / "depth.txt");
  for (std::size_t i = 0; i < sequence->size(); ++i) {
    SequenceEntry entry = sequence->entry(i);
    alter(i, entry);
    colour << format_timestamp(entry.stamp) << " " << fs::absolute(entry.colour_name).string()
           << "\n";
    depth << format_timestamp(entry.depth_stamp) << " " << fs::absolute(entry.depth_name).string()
          << "\n";
  }
}

}  // namespace ydd::e2e
