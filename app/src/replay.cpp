// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/app/adapter_files.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/folder.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct ReplayArguments {
  Substitute substitute;
  std::string recording;  ///< file, or folder of a run
};

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
    throw Error{fmt::format("the recording has no signal '{}', which the adapter reads", signal)};
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

/// Values of an adapter's signals in a recording, row by row.
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
std::vector<double> run_rows(LoadedAdapter& loaded, const recording::Reader& run,
                             Signals& signals) {
  std::vector<double> in(signals.inputs.size()), out(signals.outputs.size());
  adapters::StepData step;
  step.inputs = in;
  step.outputs = out;
  const WallClock clock;
  std::vector<double> times;
  Status status = Status::Ok;
  for (std::size_t row = 0; row < run.rows() && status != Status::Done;
       row += loaded.rows_per_step) {
    for (std::size_t i = 0; i < in.size(); ++i)
      if (std::isfinite(signals.inputs[i][row])) in[i] = signals.inputs[i][row];
    step.time = run.time()[row];
    const TimePoint begun = clock.now();
    status = loaded.adapter->step(step);
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

int replay(const ReplayArguments& arguments) {
  const recording::Reader run{session::recording_in(arguments.recording)};
  LoadedAdapter loaded = load_adapter(arguments.substitute, run);
  Signals signals = signals_of(*loaded.adapter, run, arguments.substitute.node);
  loaded.adapter->activate();
  auto times = run_rows(loaded, run, signals);
  loaded.adapter->deactivate();
  print(signals.outputs, std::move(times));
  return kOk;
}

}  // namespace

void add_replay(CommandLine& line) {
  auto [command, a] = line.add(
      "replay", "Run a plugin or FMU on the inputs of a recording and compare its outputs", replay);
  command->add_option("library", a.substitute.file, "Plugin or FMU")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("recording", a.recording, "Recording, or folder of a run")->required();
  command
      ->add_option("--config", a.substitute.config,
                   "TOML file with the config of the plugin, or the table of the FMU's node; "
                   "without, those of "
                   "the recorded node")
      ->check(CLI::ExistingFile);
  command->add_option("--node", a.substitute.node, "Node of its monitors and parameters")
      ->capture_default_str();
}

}  // namespace rths::app
