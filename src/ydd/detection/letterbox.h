// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ydd/detection/detection.h"
#include "ydd/image/image.h"
#include "ydd/inference/network.h"

namespace ydd {

/// How an image lies inside a network's input of another shape: scaled alike in both directions,
/// in the middle, grey around it. `p_input = scale * p_image + offset`, pixels counted from the
/// corner of the top left pixel.
struct Letterbox {
  float scale = 1;
  int offset_x_px = 0, offset_y_px = 0;  ///< of the image's corner in the input
  int width_px = 0, height_px = 0;       ///< of the scaled image in the input
  friend bool operator==(const Letterbox&, const Letterbox&) = default;
};

/// The largest image that fits. @throws std::logic_error unless all sizes are positive.
Letterbox letterbox_for(int image_width_px, int image_height_px, int input_width_px,
                        int input_height_px);

/// A box of the input in image pixels; may reach beyond the image.
Box to_image(const Box& box_input, const Letterbox& letterbox);

/// What a network wants to see.
struct InputFormat {
  int width_px = 640, height_px = 480;
  bool rgb = true;                 ///< else blue, green, red
  float value_scale = 1.0F / 255;  ///< from 0..255 to the network's values
};

/// Turns images into network inputs; keeps its buffers from image to image.
class Letterboxer {
 public:
  explicit Letterboxer(const InputFormat& format);
  ~Letterboxer();
  Letterboxer(Letterboxer&&) noexcept;
  Letterboxer& operator=(Letterboxer&&) noexcept;

  /// {1, 3, height, width}; valid until the next call. @throws std::logic_error on an empty image.
  Tensor prepare(const ColourImage& image);

 private:
  struct Buffers;
  InputFormat format_;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace ydd
