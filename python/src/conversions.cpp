// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"

namespace rths::python {

namespace py = pybind11;

py::array_t<std::uint32_t> view_of(Member& member, const std::string& partition) {
  const auto [words, is_writable] = member.words_of(partition);
  auto* const kept = new std::shared_ptr<RingHandle>{member.ring()};
  const py::capsule owner{
      kept, [](void* ring) { delete static_cast<std::shared_ptr<RingHandle>*>(ring); }};
  py::array_t<std::uint32_t> view{static_cast<py::ssize_t>(words.size()), words.data(), owner};
  if (!is_writable) view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::array_t<double> array_of(std::vector<double> values) {
  auto* const kept = new std::vector<double>{std::move(values)};
  const py::capsule owner{kept,
                          [](void* vector) { delete static_cast<std::vector<double>*>(vector); }};
  return py::array_t<double>{static_cast<py::ssize_t>(kept->size()), kept->data(), owner};
}

}  // namespace rths::python
