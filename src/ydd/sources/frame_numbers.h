// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "ydd/base/result.h"
#include "ydd/base/timestamp.h"
#include "ydd/dataset/recording.h"

/// Recordings without a list: the names of the files tell which frame they are of, or when they
/// were taken.
namespace ydd::sources {

/// Where nothing tells the time, frames are taken to be 1/30 s apart.
Timestamp frame_stamp(std::int64_t number);

/// One line of log that says so.
void tell_frame_rate(const std::filesystem::path& place);

/// A picture file and what its name tells.
struct NumberedFile {
  std::filesystem::path file;
  std::int64_t number = 0;         ///< of the frame, where the name is one
  std::optional<Timestamp> stamp;  ///< where the name is a time
};

/// The files of `folder` named `prefix`, number or time, one of `endings`, in the order of number
/// or time; others are passed over. A number is short digits; a time is "1305031102.175304" in
/// seconds, 13, 16 or 19 digits in milli-, micro- or nanoseconds, or the part after the dash of
/// "0000001-000000033369" in microseconds (Redwood). Fails when a number stands twice, and when
/// there is none.
Result<std::vector<NumberedFile>> numbered_files(const std::filesystem::path& folder,
                                                 std::string_view prefix,
                                                 const std::vector<std::string_view>& endings);

/// Puts both streams together: by time where all names are times, else by number, at 30 Hz, which
/// the log then says, as well as how many have no partner. `place` is for messages.
Result<Recording> recording_of(const std::filesystem::path& place,
                               const std::vector<NumberedFile>& colour,
                               const std::vector<NumberedFile>& depth);

}  // namespace ydd::sources
