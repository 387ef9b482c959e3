// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/fmi/fmu_check.hpp>
#include <rths/fmi/fmu_node.hpp>
#include <rths/plugin/plugin_adapter.hpp>
#include <rths/plugin/python_file.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>
#include <rths/report/report.hpp>
#include <rths/session/folder.hpp>

#include "command.hpp"
#include "commands.hpp"

namespace rths::app {
namespace {

struct ReplayArguments {
  std::string library;       ///< of the plugin
  std::string recording;     ///< file, or folder of a run
  std::string config;        ///< file with the `config` of the plugin; empty: none
  std::string node = "xpc";  ///< whose monitors and parameters it has
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

/// The adapter, and the rows from one of its steps to the next.
struct Loaded {
  std::unique_ptr<adapters::Adapter> adapter;
  std::size_t rows_per_step = 1;
};

// Returns the time of each step [s]. The adapter can be done before the last row.
std::vector<double> run_rows(Loaded& loaded, const recording::Reader& run, Signals& signals) {
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

// The table of a node in the recorded experiment; empty if the node had another kind of adapter.
Config recorded_table(const recording::Reader& run, const std::string& node,
                      const std::string& kind) {
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return {};
  const Config table = experiment->table_or_empty("node").table_or_empty(node);
  return table.text("adapter", "") == kind ? table : Config{};
}

Loaded load_plugin(const ReplayArguments& arguments, const recording::Reader& run) {
  const Config config = arguments.config.empty()
                            ? recorded_table(run, arguments.node, "plugin").table_or_empty("config")
                            : Config::load(arguments.config);
  const auto loaded =
      plugin::plugin_file(std::filesystem::absolute(arguments.library), config.to_toml());
  plugin::PluginSettings settings;
  settings.library = loaded.library;
  settings.config = loaded.config;
  settings.title = loaded.title;
  settings.may_allocate = loaded.is_python;
  return {plugin::make_plugin(settings), 1};
}

// The steps of an FMU have one length, so it steps once per period.
Loaded load_fmu(const ReplayArguments& arguments, const recording::Reader& run) {
  Config table = arguments.config.empty() ? recorded_table(run, arguments.node, "fmu")
                                          : Config::load(arguments.config);
  if (table.keys().empty())
    throw Error{
        fmt::format("node '{}' of the recording is not an FMU, expected --node of another "
                    "node, or --config with the table of a node",
                    arguments.node)};
  table.put("file", std::filesystem::absolute(arguments.library).string());
  if (!table.has("role")) table.put("role", std::string{"machine"});
  const experiment::Experiment setup;
  const auto settings = fmi::read_fmu(arguments.node, table, setup);
  const double period = table.number("period_s", to_seconds(settings.schedule.period));
  const auto& time = run.time();
  const double row = time.size() > 1 ? time[1] - time[0] : period;
  const double rows = std::round(period / row);
  constexpr double kSmallest = 1e-6;  // of a row
  if (rows < 1 || std::abs(period / row - rows) > kSmallest)
    throw Error{
        fmt::format("the FMU has steps of {:g} s, expected a multiple of the recording's "
                    "rows, {:g} s",
                    period, row)};
  const experiment::NodeContext context{
      arguments.node, from_seconds(period), true, {}, run.map(), {}, {}, {}, {}};
  return {settings.make(setup, context), static_cast<std::size_t>(rows)};
}

int replay(const ReplayArguments& arguments) {
  const recording::Reader run{session::recording_in(arguments.recording)};
  const bool is_fmu = fmi::is_fmu(arguments.library);
  Loaded loaded = is_fmu ? load_fmu(arguments, run) : load_plugin(arguments, run);
  Signals signals = signals_of(*loaded.adapter, run, arguments.node);
  loaded.adapter->activate();
  auto times = run_rows(loaded, run, signals);
  loaded.adapter->deactivate();
  print(signals.outputs, std::move(times));
  return kOk;
}

}  // namespace

void add_replay(CommandLine& line) {
  auto& a = line.values<ReplayArguments>();
  auto* command = line.app.add_subcommand(
      "replay", "Run a plugin or FMU on the inputs of a recording and compare its outputs");
  command->add_option("library", a.library, "Plugin or FMU")->required()->check(CLI::ExistingPath);
  command->add_option("recording", a.recording, "Recording, or folder of a run")->required();
  command
      ->add_option("--config", a.config,
                   "TOML file with the config of the plugin, or the table of the FMU's node; "
                   "without, those of "
                   "the recorded node")
      ->check(CLI::ExistingFile);
  command->add_option("--node", a.node, "Node of its monitors and parameters")
      ->capture_default_str();
  command->callback([&] { line.chosen = [&a] { return replay(a); }; });
}

}  // namespace rths::app
