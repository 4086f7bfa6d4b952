// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The encoder behind VideoFile: a library of its own that is loaded when a video is asked for.
/// OpenCV's video back end brings some 200 libraries, 60 MB and half a second with it.
///
/// Thread: one per encoder. No exception leaves these functions.
#pragma GCC visibility push(default)  // the one library whose names others look up
extern "C" {
/// Null when there is no encoder for MP4 or the file cannot be written.
void* ydd_video_open(const char* file, int width_px, int height_px, double frames_per_second);
/// The next picture: rows of blue, green, red. False when it could not be written.
bool ydd_video_add(void* encoder, const unsigned char* bgr);
/// Completes the file.
void ydd_video_close(void* encoder);
}
#pragma GCC visibility pop
