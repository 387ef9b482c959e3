// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/plugin/plugin_adapter.hpp>
#include <rths/plugin/python_file.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/report.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

using adapters::Direction;
using adapters::Port;

/// An output beside its recorded values.
struct Compared {
  std::string name, unit;
  std::vector<double> recorded;  ///< empty: is not in the recording
  double largest = 0, largest_difference = 0;
};

std::vector<double> recorded_or(const recording::Reader& run, const std::string& signal,
                                std::optional<double> otherwise) {
  if (run.has(signal)) return run.signal(signal);
  if (!otherwise)
    throw Error{fmt::format("the recording has no signal '{}', which the plugin reads", signal)};
  return std::vector<double>(run.rows(), *otherwise);
}

void compare(std::vector<Compared>& outputs, const std::vector<double>& values, std::size_t row) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    auto& output = outputs[i];
    output.largest = std::max(output.largest, std::abs(values[i]));
    if (!output.recorded.empty() && std::isfinite(output.recorded[row]))
      output.largest_difference =
          std::max(output.largest_difference, std::abs(values[i] - output.recorded[row]));
  }
}

/// Values of a plugin's signals in a recording, row by row.
struct Signals {
  std::vector<std::vector<double>> inputs;
  std::vector<Compared> outputs;
};

Signals signals_of(const adapters::Adapter& adapter, const recording::Reader& run,
                   const std::string& node) {
  Signals signals;
  for (const auto& port : adapter.ports()) {
    const std::string signal = adapters::signal_name(port, node);
    const bool is_parameter = port.direction == Direction::Parameter;
    if (is_read(port))
      signals.inputs.push_back(
          recorded_or(run, signal, is_parameter ? std::optional{port.initial} : std::nullopt));
    else
      signals.outputs.push_back(
          {signal, port.unit, run.has(signal) ? run.signal(signal) : std::vector<double>{}});
  }
  return signals;
}

// Returns the time of each step [s]. The adapter can be done before the last row.
std::vector<double> run_rows(adapters::Adapter& adapter, const recording::Reader& run,
                             Signals& signals) {
  std::vector<double> in(signals.inputs.size()), out(signals.outputs.size());
  adapters::StepData step;
  step.inputs = in;
  step.outputs = out;
  const WallClock clock;
  std::vector<double> times;
  Status status = Status::Ok;
  for (std::size_t row = 0; row < run.rows() && status != Status::Done; ++row) {
    for (std::size_t i = 0; i < in.size(); ++i)
      if (std::isfinite(signals.inputs[i][row])) in[i] = signals.inputs[i][row];
    step.time = run.time()[row];
    const TimePoint begun = clock.now();
    status = adapter.step(step);
    times.push_back(to_seconds(clock.now() - begun));
    if (status == Status::Fault)
      throw Error{fmt::format("{} at {:.3f} s", step.message, step.time)};
    compare(signals.outputs, out, row);
  }
  return times;
}

void print(const std::vector<Compared>& outputs, std::vector<double> times) {
  fmt::print("{:<40} {:>12} {:>24}\n", "output", "largest", "largest difference");
  for (const auto& output : outputs)
    fmt::print(
        "{:<40} {:>12.5g} {:>24} {}\n", output.name, output.largest,
        output.recorded.empty() ? "not recorded" : fmt::format("{:.3g}", output.largest_difference),
        output.unit == "1" ? "" : output.unit);
  std::sort(times.begin(), times.end());
  fmt::print("{} steps of {:.2f} us at the median, {:.2f} us at most\n", times.size(),
             times.empty() ? 0 : 1e6 * times[times.size() / 2],
             times.empty() ? 0 : 1e6 * times.back());
}

}  // namespace

int replay(const ReplayArguments& arguments) {
  std::filesystem::path source = arguments.recording;
  if (std::filesystem::is_directory(source)) source /= report::kRunFile;
  const recording::Reader run{source};
  plugin::PluginSettings settings;
  const std::string config =
      arguments.config.empty() ? "" : Config::load(arguments.config).to_toml();
  const auto loaded = plugin::plugin_file(std::filesystem::absolute(arguments.library), config);
  settings.library = loaded.library;
  settings.config = loaded.config;
  settings.title = loaded.title;
  settings.may_allocate = loaded.is_python;
  const auto adapter = plugin::make_plugin(settings);
  Signals signals = signals_of(*adapter, run, arguments.node);
  adapter->activate();
  auto times = run_rows(*adapter, run, signals);
  adapter->deactivate();
  print(signals.outputs, std::move(times));
  return kOk;
}

}  // namespace rths::app
