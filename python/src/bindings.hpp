// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <rths/testkit/signals.hpp>

namespace rths::python {

using testkit::SignalNode;
using testkit::SignalRing;

/// A view of the words of a partition, without a copy. It keeps the ring's memory mapped.
[[nodiscard]] pybind11::array_t<std::uint32_t> view_of(SignalNode& member,
                                                       const std::string& partition);
/// The values as an array that owns them.
[[nodiscard]] pybind11::array_t<double> array_of(std::vector<double> values);

/// Adds Reader and Writer to the module.
void bind_recording(pybind11::module_& module);
/// Adds Laboratory to the module.
void bind_testkit(pybind11::module_& module);

}  // namespace rths::python
