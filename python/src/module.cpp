// SPDX-License-Identifier: Apache-2.0
//
// The extension rths._rths. The package's modules in Python are its only users.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>
#include <rths/testkit/expectation.hpp>
#include <rths/testkit/signals.hpp>

#include "bindings.hpp"

namespace rths::python {
namespace {

/// A follower was more than a journal behind.
class LostWrites : public Error {
 public:
  using Error::Error;
};

/// Waits for the writes to given signals, each once and in its writer's order, beginning now.
class Follower {
 public:
  /// @throws Error for an unknown signal, or if there are none
  Follower(const std::shared_ptr<testkit::SignalRing>& ring,
           const std::vector<std::string>& signals)
      : follower_{ring->follow(signals)} {}

  /// The next write; empty if there is none within the time. Releases Python's global lock while it
  /// waits, and ends early if Python has a signal to handle.
  /// @param timeout_s  0 to a million [s]
  /// @throws LostWrites and continues at the newest write; Error if another thread is waiting
  [[nodiscard]] std::optional<testkit::Change> wait(double timeout_s);

 private:
  std::unique_ptr<testkit::SignalFollower> follower_;
  bool is_waiting_ = false;
};

constexpr double kLongestTimeout = 1e6;  // [s]

constexpr Duration kSignalPeriod = std::chrono::milliseconds{50};  // between checks for Ctrl-C

TimePoint deadline_after(double timeout_s) {
  if (!(timeout_s >= 0 && timeout_s <= kLongestTimeout))
    throw Error{fmt::format("timeout_s is {}, expected 0 to {} s", timeout_s, kLongestTimeout)};
  return WallClock{}.now() + from_seconds(timeout_s);
}

/// Marks a follower as waiting. Changed only while the global lock is held.
class Waiting {
 public:
  explicit Waiting(bool& flag) : flag_{flag} {
    if (flag) throw Error{"another thread waits for this follower, expected one for each thread"};
    flag = true;
  }
  ~Waiting() { flag_ = false; }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  bool& flag_;
};

std::optional<testkit::Change> Follower::wait(double timeout_s) {
  const TimePoint deadline = deadline_after(timeout_s);
  const Waiting waiting{is_waiting_};
  const WallClock clock;
  for (;;) {
    broker::Write write;
    Status status = Status::Late;
    {
      const pybind11::gil_scoped_release release;
      status = follower_->wait(std::min(deadline, clock.now() + kSignalPeriod), write);
    }
    if (status == Status::Ok) return follower_->change_of(write);
    if (status == Status::LimitExceeded)
      throw LostWrites{"this follower was more than a journal behind: some writes were lost"};
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set{};
    if (clock.now() >= deadline) return std::nullopt;
  }
}

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
