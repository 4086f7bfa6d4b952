// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <pybind11/pybind11.h>

#include "ydd/base/result.h"

/// The Python module: what the rooms give, as NumPy arrays and small classes. Nothing is computed
/// here.
namespace ydd::python {

namespace py = pybind11;

/// What a `Result` without a value becomes: `ydd_slam.Error` with the same line.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class T>
T value_of(Result<T> result) {
  if (!result) throw Failure(result.error().message);
  return *std::move(result);
}
inline void value_of(const Result<void>& result) {
  if (!result) throw Failure(result.error().message);
}

/// What `work` gives; other Python threads run meanwhile. It must not touch Python.
template <class Work>
auto without_gil(Work&& work) {
  const py::gil_scoped_release release;
  return std::forward<Work>(work)();
}

/// Says by a flag, which the GIL guards, that something is at work.
class Busy {
 public:
  explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& flag_;
};

// One for each topic, in the order in which they need each other.
void bind_camera(py::module_& module);
void bind_detection(py::module_& module);
void bind_evaluation(py::module_& module);
void bind_readers(py::module_& module);
void bind_simulation(py::module_& module);
void bind_frame(py::module_& module);
void bind_map(py::module_& module);
void bind_slam(py::module_& module);

}  // namespace ydd::python
