// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/detection/recorded_detections.h"

namespace ydd::fuzz {

void detections(std::string_view input) {
  Pieces lines(input);
  while (!lines.done()) {
    const auto frame = parse_recorded_frame(lines.until('\n'), "input");
    expect_one_line(frame);
    if (!frame) continue;
    const std::string text = to_json_line(*frame);
    const auto again = parse_recorded_frame(text, "again");
    if (!again) broken("not read again: " + again.error().message);
    if (to_json_line(*again) != text) broken("read again otherwise");
  }
  expect_one_line(DetectionRecording::read(file_of(input, "detections.jsonl")));
}

}  // namespace ydd::fuzz
