// SPDX-License-Identifier: Apache-2.0
//
// The extension rths._rths. The package's modules in Python are its only users.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>
#include <rths/testkit/expectation.hpp>

#include "bindings.hpp"
#include "follower.hpp"

namespace rths::python {
namespace {

namespace py = pybind11;
using Unlocked = py::call_guard<py::gil_scoped_release>;

py::dict description_of(const memmap::SignalEntry& entry, const memmap::Codec& codec) {
  py::dict values;
  for (const auto& [name, value] : entry.signal->values)
    values[py::str(name)] = codec.to_si(static_cast<double>(value));
  py::object range = py::none();
  if (entry.signal->range)
    range = py::make_tuple(codec.to_si(entry.signal->range->first),
                           codec.to_si(entry.signal->range->second));
  using namespace py::literals;
  return py::dict("name"_a = entry.name, "unit"_a = memmap::parse_unit(entry.signal->unit).si,
                  "node"_a = entry.partition->node, "partition"_a = entry.partition->name,
                  "offset"_a = entry.signal->offset.value(),
                  "type"_a = memmap::to_text(entry.signal->type), "range"_a = range,
                  "values"_a = values, "tear_group"_a = entry.partition->tear_group);
}

py::list signals_of(SignalRing& ring) {
  py::list signals;
  for (const auto& entry : ring.map().signals())
    signals.append(description_of(entry, ring.codec(entry)));
  return signals;
}

std::vector<std::string> nodes_of(SignalRing& ring) {
  std::vector<std::string> names;
  for (const auto& node : ring.map().description().nodes) names.push_back(node.name);
  return names;
}

std::vector<std::string> ring_names() {
  std::vector<std::string> names;
  for (const auto& report : broker::list_rings()) names.push_back(report.name);
  return names;
}

void bind_ring(py::module_& module) {
  py::class_<SignalRing, std::shared_ptr<SignalRing>>(module, "Ring")
      .def_static("create", &SignalRing::create, py::arg("name"), py::arg("map_file"), Unlocked{})
      .def_static("attach", &SignalRing::attach, py::arg("name"), Unlocked{})
      .def_static("in_process", &SignalRing::in_process, py::arg("map_file"), Unlocked{})
      .def("join", &SignalRing::join, py::arg("node"), py::arg("plain"))
      .def("observe", &SignalRing::observe)
      .def(
          "follow",
          [](const std::shared_ptr<SignalRing>& ring, const std::vector<std::string>& signals) {
            return std::make_unique<Follower>(ring, signals);
          },
          py::arg("signals"))
      .def("signals", &signals_of)
      .def("nodes", &nodes_of)
      .def_property_readonly("map_toml", [](SignalRing& r) { return r.map().to_toml(); })
      .def_property_readonly("map_name", [](SignalRing& r) { return r.map().description().name; });
}

void bind_members(py::module_& module) {
  py::class_<SignalNode>(module, "Node")
      .def_property_readonly("name", &SignalNode::name)
      .def("read", py::overload_cast<const std::vector<std::string>&>(&SignalNode::read),
           py::arg("signals"))
      .def("write",
           py::overload_cast<const std::vector<std::pair<std::string, testkit::Value>>&>(
               &SignalNode::write),
           py::arg("values"))
      .def("view", &view_of, py::arg("partition"))
      .def("beat", &SignalNode::beat)
      .def("beats_of", &SignalNode::beats_of, py::arg("node"))
      .def("presence_of", &SignalNode::presence_of, py::arg("node"))
      .def_property_readonly("has_left", &SignalNode::has_left)
      .def("leave", &SignalNode::leave);

  py::class_<testkit::Change>(module, "Change")
      .def_readonly("node", &testkit::Change::node)
      .def_readonly("values", &testkit::Change::values);
  py::class_<Follower>(module, "Follower").def("wait", &Follower::wait, py::arg("timeout_s"));
}

}  // namespace

PYBIND11_MODULE(_rths, module) {
  const auto error = py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
  py::register_exception<LostWrites>(module, "LostWrites", error);
  py::register_exception<testkit::NotMet>(module, "NotMet", PyExc_AssertionError);
  bind_ring(module);
  bind_members(module);
  bind_recording(module);
  bind_testkit(module);
  module.def("ring_names", &ring_names);
  module.def("remove_ring", &broker::remove_ring, py::arg("name"));
}

}  // namespace rths::python
