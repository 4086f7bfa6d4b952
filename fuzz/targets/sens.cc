// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/base/log.h"
#include "ydd/dataset/camera_file.h"
#include "ydd/sources/source.h"

namespace ydd::fuzz {

// A file that is ScanNet's .sens.
void sens(std::string_view input) {
  log::set_level(log::Level::off);
  SequenceOptions options;
  options.source = "sens";
  const Result<Sequence> sequence = open_sequence(file_of(input, "a.sens"), options);
  expect_one_line(sequence);
  if (!sequence) return;
  expect_one_line(find_camera(sequence->recording()));
  expect_one_line(sequence->groundtruth()->read());
  for (std::size_t i = 0; i < std::min<std::size_t>(4, sequence->size()); ++i) {
    expect_one_line(sequence->read_colour(i));
    expect_one_line(sequence->read_depth_counts(i));
  }
}

}  // namespace ydd::fuzz
