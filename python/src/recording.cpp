// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/recording.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.hpp"

namespace rths::python {
namespace {

namespace py = pybind11;
using recording::Reader;
using recording::Writer;

using EventTuple = std::tuple<double, std::string, double>;

std::vector<EventTuple> events_of(const Reader& reader) {
  std::vector<EventTuple> events;
  for (const auto& event : reader.events())
    events.emplace_back(event.time, event.signal, event.value);
  return events;
}

std::unique_ptr<Writer> writer_for(const std::filesystem::path& file, SignalRing& ring,
                                   const std::vector<std::string>& signals,
                                   const recording::NamedTexts& meta) {
  std::vector<SignalId> ids;
  for (const auto& signal : signals) ids.push_back(ring.map().signal(signal));
  return std::make_unique<Writer>(file, ring.map(), ids, recording::RecordingInfo{{}, meta, {}});
}

}  // namespace

// All calls keep the global lock: HDF5 allows one thread at a time.
void bind_recording(py::module_& module) {
  py::class_<Reader>(module, "Reader", "Reads the recording of a finished, running or crashed run.")
      .def(py::init<const std::filesystem::path&>(), py::arg("file"))
      .def_property_readonly("rows", &Reader::rows)
      .def_property_readonly(
          "time", [](const Reader& r) { return array_of(r.time()); },
          "Time of each row since the run began [s].")
      .def_property_readonly("names", &Reader::names)
      .def(
          "values",
          [](const Reader& reader, const std::string& signal) {
            return array_of(reader.signal(signal));
          },
          py::arg("signal"), "All values of a signal [SI].")
      .def("unit", &Reader::unit, py::arg("signal"))
      .def("config", &Reader::config, py::arg("file"))
      .def_property_readonly("meta", &Reader::meta)
      .def_property_readonly("events", &events_of, "(time [s], signal, value [SI])")
      .def_property_readonly("drops", &Reader::drops)
      .def_property_readonly("rows_missing", &Reader::rows_missing)
      .def_property_readonly("map_toml", [](const Reader& r) { return r.map().to_toml(); });

  py::class_<Writer>(module, "Writer", "Writes a recording of signals of a ring.")
      .def(py::init(&writer_for), py::arg("file"), py::arg("ring"), py::arg("signals"),
           py::arg("meta"))
      .def(
          "append",
          [](Writer& writer, double time_s, const std::vector<double>& row) {
            writer.append(from_seconds(time_s), row);
          },
          py::arg("time_s"), py::arg("row"), "One value per signal [SI]; the time ascends [s].")
      .def("close", &Writer::close)
      .def_property_readonly("rows", &Writer::rows);
}

}  // namespace rths::python
