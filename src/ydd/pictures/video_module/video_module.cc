// SPDX-License-Identifier: Apache-2.0
#include "ydd/pictures/video_module/video_module.h"

#include <memory>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

namespace {

struct Encoder {
  cv::VideoWriter writer;
  cv::Size size;
};

bool open_with(Encoder& encoder, const char* file, int codec, double frames_per_second) {
  try {
    return encoder.writer.open(file, codec, frames_per_second, encoder.size);
  } catch (const cv::Exception&) {
    return false;  // how some back ends say no
  }
}

}  // namespace

void* ydd_video_open(const char* file, int width_px, int height_px, double frames_per_second) {
  // Trying an encoder that is not there is no reason to print.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto encoder = std::make_unique<Encoder>();
  encoder->size = {width_px, height_px};
  const bool opened =
      open_with(*encoder, file, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), frames_per_second) ||
      open_with(*encoder, file, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), frames_per_second);
  return opened ? encoder.release() : nullptr;
}

bool ydd_video_add(void* encoder, const unsigned char* bgr) {
  auto& e = *static_cast<Encoder*>(encoder);
  try {
    // The writer reads it only.
    e.writer.write(cv::Mat(e.size, CV_8UC3, const_cast<unsigned char*>(bgr)));  // NOLINT
    return true;
  } catch (const cv::Exception&) {
    return false;
  }
}

void ydd_video_close(void* encoder) {
  const std::unique_ptr<Encoder> closed(static_cast<Encoder*>(encoder));
  closed->writer.release();
}
