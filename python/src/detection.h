// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "binding.h"
#include "ydd/detection/detector.h"
#include "ydd/detection/object_catalogue.h"

namespace ydd::python {

/// From a sequence of `Detection`, or of tuples (class, box) or (class, box, score). `source`
/// starts the message of a failure.
Detections detections_from(const py::handle& given, const std::string& source);

/// From one (H, W) array (of a person), or from a sequence of tuples (class, array).
Detections masks_from(const py::handle& given);

/// A function of Python that looks at pictures, and the last exception that it raised. GIL.
struct PythonLook {
  py::function function;
  py::object raised;
};
/// The last holder may let go of it in any thread.
std::shared_ptr<PythonLook> make_look(py::function function);

/// A detector written in Python: `look` is called with an RgbdFrame and gives what detections_from
/// takes. Takes the GIL itself.
class CallableDetector : public Detector {
 public:
  CallableDetector(std::shared_ptr<PythonLook> look, ObjectCatalogue catalogue)
      : look_(std::move(look)), catalogue_(std::move(catalogue)) {}

  /// An exception becomes one line, and stays in PythonLook::raised.
  Result<Detections> detect(const RgbdFrame& frame) override;

 private:
  Result<Detections> ask(const RgbdFrame& frame);

  std::shared_ptr<PythonLook> look_;
  ObjectCatalogue catalogue_;
};

}  // namespace ydd::python
