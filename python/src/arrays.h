// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>

#include "binding.h"
#include "ydd/base/id.h"
#include "ydd/base/timestamp.h"
#include "ydd/geometry/camera.h"
#include "ydd/geometry/se3.h"
#include "ydd/image/rgbd_frame.h"

/// Arrays of NumPy over what C++ holds, and back.
namespace ydd::python {

using Shape = std::vector<py::ssize_t>;

/// A read-only array over memory that `owner` keeps alive. `strides` in bytes; empty: rows without
/// gaps.
template <class T>
py::array_t<T> view(const T* data, Shape shape, Shape strides, const py::object& owner) {
  py::array_t<T> out = strides.empty()
                           ? py::array_t<T>(std::move(shape), data, owner)
                           : py::array_t<T>(std::move(shape), std::move(strides), data, owner);
  out.attr("setflags")(py::arg("write") = false);
  return out;
}

/// Keeps something alive for arrays over it.
template <class T>
py::capsule keeper_of(std::shared_ptr<const T> held) {
  return py::capsule(new std::shared_ptr<const T>(std::move(held)),
                     [](void* p) { delete static_cast<std::shared_ptr<const T>*>(p); });
}

/// An array that takes what a vector holds: `width` values a row, 1 for a plain list.
template <class T>
py::array_t<T> taken(std::vector<T> values, py::ssize_t width = 1) {
  const auto held = std::make_shared<const std::vector<T>>(std::move(values));
  const auto rows = static_cast<py::ssize_t>(held->size()) / width;
  Shape shape{rows};
  if (width > 1) shape.push_back(width);
  return py::array_t<T>(std::move(shape), held->data(), keeper_of<std::vector<T>>(held));
}

/// Over the pixels of an image, which live as long as the array.
py::array_t<std::uint8_t> view_of(const GreyImage& image);
py::array_t<std::uint8_t> view_of(const ColourImage& image);  ///< (height, width, 3), BGR
py::array_t<float> view_of(const DepthImage& image);

/// An array as it is, or what gives itself as one (a tensor in the processor's memory). Failure: by
/// this name.
py::array array_from(const py::handle& given, const std::string& name);

/// (H, W, 3) or (H, W) of uint8. An array that nobody may write (flags.writeable is False) and that
/// has no gaps is shared; any other is copied.
ColourImage colour_from(const py::array& array);
/// (H, W): uint16 are counts of the camera's depth scale, as are other integers that fit into it,
/// float32 and float64 metres. Readings outside the camera's limits become 0.
DepthImage depth_from(const py::array& array, const Camera& camera);
/// (H, W) of bool or any integers: 1 where they are not 0.
GreyImage mask_from(const py::array& array);
/// Both arrays, of the camera's size.
RgbdFrame frame_from(const py::handle& colour, const py::handle& depth, Timestamp stamp,
                     const Camera& camera);

/// 4 x 4, a copy.
py::array_t<double> matrix_of(const SE3& T);
/// From 4 x 4; fails when it is no rigid motion.
SE3 motion_from(const py::array& matrix, const std::string& name);

/// Seconds as Python has them, or exact nanoseconds; one of the two.
Timestamp stamp_from(const py::object& stamp_s, const py::object& stamp_ns);

/// One number for an id; -1 for none.
template <class Tag>
std::int64_t number_of(Id<Tag> id) {
  if (!id.valid()) return -1;
  return (static_cast<std::int64_t>(id.generation) << 32U) | static_cast<std::int64_t>(id.slot);
}

}  // namespace ydd::python
