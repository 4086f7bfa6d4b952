// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "binding.h"
#include "ydd/base/log.h"
#include "ydd/base/version.h"

namespace ydd::python {
namespace {

void set_log_level(const std::string& level) {
  if (level == "info") return log::set_level(log::Level::info);
  if (level == "warning") return log::set_level(log::Level::warning);
  if (level == "off") return log::set_level(log::Level::off);
  throw Failure("level: must be info, warning or off, not " + level);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled part of ydd_slam; import that.";
  // What is bound is called by where people import it from.
  const py::object own_name = module.attr("__name__");
  module.attr("__name__") = "ydd_slam";
  module.attr("__version__") = std::string(kVersion);
  py::register_exception<Failure>(module, "Error", PyExc_RuntimeError).attr("__doc__") =
      "What input caused: one line that names it and tells what to do.";
  log::set_level(log::Level::warning);
  module.def("set_log_level", &set_log_level, py::arg("level"),
             "Which lines go to standard error: 'info', 'warning' (at first) or 'off'.");
  bind_camera(module);
  bind_detection(module);
  bind_evaluation(module);
  bind_readers(module);
  bind_simulation(module);
  bind_frame(module);
  bind_map(module);
  bind_slam(module);
  module.attr("__name__") = own_name;
}

}  // namespace ydd::python
