// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include "bindings.hpp"

namespace rths::python {
namespace {

namespace py = pybind11;

// An object of Python that keeps the value until it is freed itself.
template <class T>
py::capsule kept(T value) {
  auto owned = std::make_unique<T>(std::move(value));
  py::capsule capsule{owned.get(),
                      [](void* last) { const std::unique_ptr<T> freed{static_cast<T*>(last)}; }};
  static_cast<void>(owned.release());
  return capsule;
}

}  // namespace

py::array_t<std::uint32_t> view_of(SignalNode& member, const std::string& partition) {
  const auto [words, is_writable] = member.words_of(partition);
  py::array_t<std::uint32_t> view{static_cast<py::ssize_t>(words.size()), words.data(),
                                  kept(member.ring())};
  if (!is_writable) view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::array_t<double> array_of(std::vector<double> values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  const double* const data = values.data();  // a move keeps it
  return py::array_t<double>{size, data, kept(std::move(values))};
}

}  // namespace rths::python
