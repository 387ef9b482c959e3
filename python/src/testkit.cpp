// SPDX-License-Identifier: Apache-2.0
//
// The engine of rths.testing.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <rths/testkit/laboratory.hpp>

#include "bindings.hpp"

namespace rths::python {
namespace {

namespace py = pybind11;
using testkit::Laboratory;
using Unlocked = py::call_guard<py::gil_scoped_release>;

}  // namespace

void bind_testkit(py::module_& module) {
  py::class_<Laboratory>(module, "Laboratory", "A ring and programs on it, for one test.")
      .def(py::init<std::filesystem::path, const std::string&, double>(), py::arg("folder"),
           py::arg("map_file"), py::arg("deadline_s"), Unlocked{})
      .def_property_readonly("name", &Laboratory::name)
      .def_property_readonly("ring", [](Laboratory& lab) { return lab.ring(); })
      .def(
          "start",
          [](Laboratory& lab, const std::string& name, const std::string& node,
             const std::vector<std::string>& command, bool linked, double ready_s) {
            lab.start({node, command, linked, name, {}, ready_s});
          },
          py::arg("name"), py::arg("node"), py::arg("command"), py::arg("linked"),
          py::arg("ready_s"), Unlocked{})
      .def("kill", &Laboratory::kill, py::arg("program"), Unlocked{})
      .def("freeze", &Laboratory::freeze, py::arg("program"))
      .def("thaw", &Laboratory::thaw, py::arg("program"))
      .def("drop", &Laboratory::drop, py::arg("node"))
      .def("drop_signal", &Laboratory::drop_signal, py::arg("signal"))
      .def("delay", &Laboratory::delay, py::arg("node"), py::arg("seconds"))
      .def("flip", &Laboratory::flip, py::arg("signal"), py::arg("bit"))
      .def("restore", &Laboratory::restore, py::arg("node"))
      .def("check_programs", &Laboratory::check_programs)
      .def("check_owners", &Laboratory::check_owners, Unlocked{})
      .def("close", &Laboratory::close, Unlocked{})
      .def("keep", &Laboratory::keep);
}

}  // namespace rths::python
