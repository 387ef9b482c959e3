// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "member.hpp"

namespace rths::python {

/// A view of the words of a partition, without a copy. It keeps the ring's memory mapped.
[[nodiscard]] pybind11::array_t<std::uint32_t> view_of(Member& member,
                                                       const std::string& partition);
/// The values as an array that owns them.
[[nodiscard]] pybind11::array_t<double> array_of(std::vector<double> values);

/// Adds Reader and Writer to the module.
void bind_recording(pybind11::module_& module);

}  // namespace rths::python
