// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ydd/base/temporary_folder_testing.h"
#include "ydd/image/encode.h"
#include "ydd/image/image.h"

namespace ydd::sources {

/// A folder for a small recording, with pictures whose colour and depth tell which frame they are.
class LayoutTest : public testing::Test {
 protected:
  static constexpr int kWidth = 40, kHeight = 30;

  std::filesystem::path at(const std::string& name) const {
    std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    return file;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name), std::ios::binary) << text;
  }
  /// Blue is `value` everywhere.
  void put_colour(const std::string& name, int value, int width = kWidth,
                  int height = kHeight) const {
    const Bgr pixel{static_cast<std::uint8_t>(value), 20, 30};
    std::vector<Bgr> pixels(std::size_t(width) * height, pixel);
    const ColourImage image(width, height, std::move(pixels));
    const auto written =
        name.ends_with(".png") ? write_png(at(name), image) : write_jpeg(at(name), image, 95);
    ASSERT_TRUE(written) << written.error().message;
  }
  void put_depth(const std::string& name, int count, int width = kWidth,
                 int height = kHeight) const {
    std::vector<std::uint16_t> counts(std::size_t(width) * height,
                                      static_cast<std::uint16_t>(count));
    const auto written = write_png(at(name), RawDepthImage(width, height, std::move(counts)));
    ASSERT_TRUE(written) << written.error().message;
  }

  TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_ / "recording";
};

/// A rotation of 90 degrees about z and the translation (x, y, z), as rows of a 4x4 matrix.
inline std::string turned_matrix(double x, double y, double z) {
  return fmt::format("0 -1 0 {}\n1 0 0 {}\n0 0 1 {}\n0 0 0 1\n", x, y, z);
}

}  // namespace ydd::sources
