// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "ydd/image/decode.h"

namespace ydd::python {
namespace {

std::string shape_text(const py::array& array) {
  std::string out;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    out += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  }
  return fmt::format("({}) of {}", out, std::string(py::str(array.dtype())));
}

template <class T>
bool holds(const py::array& array) {
  return py::isinstance<py::array_t<T>>(array);
}

bool has_no_gaps(const py::array& array) { return (array.flags() & py::array::c_style) != 0; }

/// Lets go of an array in whatever thread the last image over it ends.
struct Releaser {
  py::array* held;
  template <class T>
  void operator()(const T* /*pixels*/) const {
    if (Py_IsInitialized() == 0) return;  // the interpreter has gone, and its memory goes too
    const py::gil_scoped_acquire acquire;
    delete held;
  }
};

/// Images over the array where nobody may write it, else of a copy.
template <class Pixel, class Value>
Image<Pixel> image_from(const py::array& array) {
  static_assert(sizeof(Pixel) % sizeof(Value) == 0);
  const auto height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
  if (!array.writeable() && has_no_gaps(array)) {
    const auto* const pixels = reinterpret_cast<const Pixel*>(array.data());
    return Image<Pixel>(width, height,
                        std::shared_ptr<const Pixel>(pixels, Releaser{new py::array(array)}));
  }
  const auto whole = py::array_t<Value, py::array::c_style>::ensure(array);
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (!pixels.empty()) std::memcpy(pixels.data(), whole.data(), pixels.size() * sizeof(Pixel));
  return Image<Pixel>(width, height, std::move(pixels));
}

ColourImage colour_from_grey(const GreyImage& grey) {
  std::vector<Bgr> pixels;
  pixels.reserve(static_cast<std::size_t>(grey.width()) * static_cast<std::size_t>(grey.height()));
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 0; x < grey.width(); ++x) {
      pixels.push_back({grey(x, y), grey(x, y), grey(x, y)});
    }
  }
  return {grey.width(), grey.height(), std::move(pixels)};
}

/// Counts in an integer type of another size, as decoders of pictures give them.
py::array_t<std::uint16_t> counts_from(const py::array& array) {
  if (array.size() > 0) {
    const auto least = array.attr("min")().cast<double>();
    const auto most = array.attr("max")().cast<double>();
    if (least < 0 || most > std::numeric_limits<std::uint16_t>::max()) {
      throw Failure(fmt::format("depth: counts must be in [0, 65535], not {} to {}", least, most));
    }
  }
  return py::array_t<std::uint16_t, py::array::c_style | py::array::forcecast>(array);
}

}  // namespace

py::array array_from(const py::handle& given, const std::string& name) {
  if (py::isinstance<py::array>(given)) return py::reinterpret_borrow<py::array>(given);
  if (!py::hasattr(given, "__array__")) {
    throw Failure(fmt::format("{}: must be an array, not {}", name,
                              py::str(py::type::of(given).attr("__name__")).cast<std::string>()));
  }
  return py::module_::import("numpy").attr("asarray")(given).cast<py::array>();
}

py::array_t<std::uint8_t> view_of(const GreyImage& image) {
  const auto held = std::make_shared<const GreyImage>(image);
  return view(held->data(), {image.height(), image.width()}, {}, keeper_of<GreyImage>(held));
}

py::array_t<std::uint8_t> view_of(const ColourImage& image) {
  const auto held = std::make_shared<const ColourImage>(image);
  const auto* const first = image.empty() ? nullptr : held->data()->data();
  return view(first, {image.height(), image.width(), 3}, {}, keeper_of<ColourImage>(held));
}

py::array_t<float> view_of(const DepthImage& image) {
  const auto held = std::make_shared<const DepthImage>(image);
  return view(held->data(), {image.height(), image.width()}, {}, keeper_of<DepthImage>(held));
}

ColourImage colour_from(const py::array& array) {
  const bool bytes = holds<std::uint8_t>(array);
  if (bytes && array.ndim() == 3 && array.shape(2) == 3) {
    return image_from<Bgr, std::uint8_t>(array);
  }
  if (bytes && array.ndim() == 2) {
    return colour_from_grey(image_from<std::uint8_t, std::uint8_t>(array));
  }
  throw Failure("colour: must have the shape (height, width, 3) or (height, width) of uint8, not " +
                shape_text(array));
}

DepthImage depth_from(const py::array& array, const Camera& camera) {
  if (array.ndim() == 2) {
    if (holds<std::uint16_t>(array)) {
      return to_metres(image_from<std::uint16_t, std::uint16_t>(array), camera);
    }
    if (holds<float>(array)) return within_limits(image_from<float, float>(array), camera);
    if (holds<double>(array)) {
      const auto narrow = py::array_t<float, py::array::c_style | py::array::forcecast>(array);
      return within_limits(image_from<float, float>(narrow), camera);
    }
    const char kind = array.dtype().kind();
    if (kind == 'i' || kind == 'u') {
      const auto counts = counts_from(array);
      return to_metres(image_from<std::uint16_t, std::uint16_t>(counts), camera);
    }
  }
  throw Failure(
      "depth: must have the shape (height, width) of float32 in metres or of uint16 in counts of "
      "the camera's depth scale, not " +
      shape_text(array));
}

GreyImage mask_from(const py::array& array) {
  const char kind = array.dtype().kind();
  if (array.ndim() != 2 || (kind != 'b' && kind != 'u' && kind != 'i')) {
    throw Failure("mask: must have the shape (height, width) of bool or integers, not " +
                  shape_text(array));
  }
  const auto set = py::array_t<bool, py::array::c_style | py::array::forcecast>(array);
  const auto height = static_cast<int>(array.shape(0)), width = static_cast<int>(array.shape(1));
  const bool* const values = set.data();
  return GreyImage(width, height, std::vector<std::uint8_t>(values, values + set.size()));
}

RgbdFrame frame_from(const py::handle& colour, const py::handle& depth, Timestamp stamp,
                     const Camera& camera) {
  RgbdFrame frame;
  frame.stamp = stamp;
  frame.colour = colour_from(array_from(colour, "colour"));
  frame.depth_m = depth_from(array_from(depth, "depth"), camera);
  const auto fits = [&](const auto& image) {
    return image.width() == camera.width_px && image.height() == camera.height_px;
  };
  if (!fits(frame.colour) || !fits(frame.depth_m)) {
    throw Failure(fmt::format(
        "colour is {} x {} px, depth {} x {}, the camera {} x {}: depth must be registered to "
        "colour and of its size",
        frame.colour.width(), frame.colour.height(), frame.depth_m.width(), frame.depth_m.height(),
        camera.width_px, camera.height_px));
  }
  frame.grey = to_grey(frame.colour);
  return frame;
}

py::array_t<double> matrix_of(const SE3& T) {
  py::array_t<double> out({4, 4});
  const Eigen::Matrix4d M = T.matrix();
  auto values = out.mutable_unchecked<2>();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) values(row, column) = M(row, column);
  }
  return out;
}

SE3 motion_from(const py::array& matrix, const std::string& name) {
  const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>(matrix);
  if (values.ndim() != 2 || values.shape(0) != 4 || values.shape(1) != 4) {
    throw Failure(name + ": must have the shape (4, 4), not " + shape_text(matrix));
  }
  Eigen::Matrix4d M;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) M(row, column) = values.at(row, column);
  }
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  constexpr double kTolerance = 1e-4;
  const bool rigid = M.allFinite() && (R * R.transpose()).isIdentity(kTolerance) &&
                     R.determinant() > 0 &&
                     (M.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kTolerance;
  if (!rigid) throw Failure(name + ": must be a rigid motion: rotation, translation, 0 0 0 1");
  return {R, M.topRightCorner<3, 1>()};
}

Timestamp stamp_from(const py::object& stamp_s, const py::object& stamp_ns) {
  if (stamp_s.is_none() == stamp_ns.is_none()) {
    throw Failure("stamp: give either stamp (seconds) or stamp_ns (nanoseconds)");
  }
  if (!stamp_ns.is_none()) return {stamp_ns.cast<std::int64_t>()};
  const auto seconds = stamp_s.cast<double>();
  if (!(std::abs(seconds) <= static_cast<double>(kLatestStamp_s))) {
    throw Failure(
        fmt::format("stamp: {} is no time in seconds; nanoseconds are stamp_ns", seconds));
  }
  // Microseconds are what a double still holds of today's seconds, and what files are written in.
  return {std::llround(seconds * 1e6) * 1000};
}

}  // namespace ydd::python
