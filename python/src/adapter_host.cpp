// SPDX-License-Identifier: Apache-2.0
//
// A file in Python behind the interface of plugins: librths_python_adapter.so. Its config has the
// key `file` and the table `config`. rths.adapter has the other half.
#include <dlfcn.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <tuple>

#include <pybind11/embed.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <rths_adapter.hpp>

namespace rths::python {
namespace {

namespace py = pybind11;

/// A failure with its line, for the exceptions of [setup] functions.
class Failure : public std::exception {
 public:
  explicit Failure(std::string text) : text_{std::move(text)} {}
  [[nodiscard]] const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

// Beside this library: of an installation, or of a build.
void add_package_path() {
  Dl_info here{};
  if (dladdr(reinterpret_cast<void*>(&add_package_path), &here) == 0) return;
  const auto prefix =
      std::filesystem::path{here.dli_fname}.parent_path().parent_path().parent_path();
  const auto path = py::module_::import("sys").attr("path");
  for (const char* folder : {RTHS_PYTHON_DIR, "python"})
    if (std::filesystem::exists(prefix / folder / "rths" / "adapter.py"))
      path.attr("append")((prefix / folder).string());
}

// Extensions of Python take its symbols from the process; this library was loaded without showing
// its own. The interpreter stays until the process ends.
void start_interpreter() {
  static std::once_flag once;
  std::call_once(once, [] {
    dlopen(RTHS_LIBPYTHON, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD);
    PyConfig config;
    PyConfig_InitPythonConfig(&config);
    config.install_signal_handlers = 0;
    config.write_bytecode = 0;
    config.parse_argv = 0;
    PyConfig_SetString(&config, &config.program_name, L"python3");  // of an active environment
    const PyStatus status = Py_InitializeFromConfig(&config);
    PyConfig_Clear(&config);
    if (PyStatus_Exception(status) != 0) throw Failure{"the interpreter of Python does not start"};
    add_package_path();
    PyEval_SaveThread();
  });
}

class PythonAdapter final : public PluginBase {
 public:
  explicit PythonAdapter(const char* config) {
    start_interpreter();
    const py::gil_scoped_acquire lock;
    try {
      py::object host = py::module_::import("rths.adapter").attr("_Host")(config);
      check(host, host.attr("made"));
      for (const auto& entry : host.attr("signals")) signals_.push_back(entry.cast<Signal>());
      host_ = std::move(host);
    } catch (const py::error_already_set& error) {
      throw Failure{error.what()};
    }
  }
  ~PythonAdapter() override {
    const py::gil_scoped_acquire lock;
    host_ = py::object{};
  }
  PythonAdapter(const PythonAdapter&) = delete;
  PythonAdapter& operator=(const PythonAdapter&) = delete;

  [[nodiscard]] std::vector<rths_signal> signals() const override {
    std::vector<rths_signal> list;
    for (const auto& [name, unit, direction, flags, initial, lowest, highest] : signals_)
      list.push_back({name.c_str(), unit.c_str(), direction, flags, initial, lowest, highest});
    return list;
  }
  void activate() override {
    const py::gil_scoped_acquire lock;
    check(host_, host_.attr("activate")());
  }
  [[nodiscard]] rths_status step(double time_s, const double* in, double* out) noexcept override {
    const py::gil_scoped_acquire lock;
    try {
      const auto inputs = view_of(in, true);
      inputs.attr("setflags")(py::arg("write") = false);
      const auto status =
          host_.attr("step")(time_s, inputs, view_of(out, false)).cast<rths_status>();
      if (status == RTHS_FAULT) message_ = host_.attr("message").cast<std::string>();
      return status;
    } catch (const std::exception& error) {
      message_ = error.what();
      return RTHS_FAULT;
    }
  }
  void deactivate() noexcept override {
    const py::gil_scoped_acquire lock;
    try {
      host_.attr("deactivate")();
    } catch (const std::exception&) {
      PyErr_Clear();
    }
  }
  [[nodiscard]] const char* message() const noexcept override { return message_.c_str(); }

 private:
  using Signal =
      std::tuple<std::string, std::string, std::uint32_t, std::uint32_t, double, double, double>;

  static void check(const py::object& host, const py::object& is_good) {
    if (!is_good.cast<bool>()) throw Failure{host.attr("message").cast<std::string>()};
  }
  // An array on the memory of the host.
  [[nodiscard]] py::array_t<double> view_of(const double* values, bool read) const {
    py::ssize_t count = 0;
    for (const auto& signal : signals_) {
      const auto direction = std::get<2>(signal);
      if ((direction == RTHS_INPUT || direction == RTHS_PARAMETER) == read) ++count;
    }
    return py::array_t<double>{count, values, py::none()};
  }

  py::object host_;
  std::vector<Signal> signals_;
  std::string message_;
};

}  // namespace
}  // namespace rths::python

RTHS_EXPORT_ADAPTER(rths::python::PythonAdapter, "python", "0.1")
