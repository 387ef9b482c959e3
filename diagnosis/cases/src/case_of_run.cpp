// SPDX-License-Identifier: Apache-2.0
#include "case_of_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

#include "case_raw.hpp"

namespace rths::diagnosis {
namespace {

using recording::at_each_count;
using recording::AxisRoles;
using recording::NodeTicks;
using recording::of_file;
using recording::Reader;

// A lead-rubber bearing at 1 m/s passes its yield displacement of 3 mm in 3 ms. Steps longer than
// that cause numerical errors in the force. Slow tests do not need short steps.
constexpr double kFineRate = 500, kUsualRate = 250;  // [Hz]
constexpr double kFurthest = 2e-3;                   // travel of a bearing in a step [m]

NodeTicks ticks_of(const Reader& run, const std::string& node) {
  NodeTicks ticks{run, node};
  if (ticks.count() < 2)
    throw Error{fmt::format("the recording holds no steps of node '{}'", node)};
  return ticks;
}

// Difference of two nodes' tick counters at the same instant: nodes start one after the other. The
// median removes rows that were recorded between the ticks of the two nodes.
std::ptrdiff_t lead(const NodeTicks& node, const NodeTicks& other) {
  std::vector<double> differences;
  for (std::size_t row = 0; row < node.counter().size(); ++row)
    if (node.counter()[row] >= 1 && other.counter()[row] >= 1)
      differences.push_back(node.counter()[row] - other.counter()[row]);
  if (differences.empty()) return 0;
  return std::lround(maths::median(std::move(differences)));
}

// Shifts in time by whole samples; repeats the value at the ends.
std::vector<double> shifted(const std::vector<double>& values, std::ptrdiff_t by,
                            std::size_t count) {
  std::vector<double> result(count);
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  for (std::size_t i = 0; i < count; ++i)
    result[i] = values[static_cast<std::size_t>(
        std::clamp(static_cast<std::ptrdiff_t>(i) + by, std::ptrdiff_t{0}, last))];
  return result;
}

// Until the first target arrives, the loop is open and the machine is at rest.
std::optional<std::pair<std::size_t, std::size_t>> quiet_stretch(const NodeTicks& machine,
                                                                 const std::string& new_target) {
  constexpr std::size_t kFewest = 500;  // samples
  const auto word = machine.values(new_target);
  const auto first =
      std::find_if(word.begin(), word.end(), [](double value) { return value != 0; });
  const auto end = static_cast<std::size_t>(first - word.begin());
  if (end < kFewest || end == word.size()) return std::nullopt;
  return std::pair{std::size_t{0}, end};
}

// Ticks without a row. The interpolation of short gaps is far below the comparison's bandwidth.
std::vector<std::pair<std::size_t, std::size_t>> gaps_of(const NodeTicks& ticks) {
  std::vector<std::pair<std::size_t, std::size_t>> gaps;
  std::size_t last = 0;
  for (const double value : ticks.counter()) {
    const auto count = static_cast<std::size_t>(std::lround(std::max(0.0, value)));
    if (count <= last) continue;
    if (count > ticks.count()) break;
    if (last > 0 && count - last > kBridged) gaps.emplace_back(last - 1, count - 1);
    last = count;
  }
  return gaps;
}

void add_axis(Record& record, const Reader& run, const NodeTicks& machine,
              const NodeTicks& controller, const AxisRoles& names) {
  if (!run.has(names.command) || !run.has(names.machine_displacement)) return;
  const auto measured = [&](const char* role, const char* unit, const std::string& name) {
    record.channels.push_back({role + ("." + names.axis), unit, machine.values(name)});
  };
  record.channels.push_back(
      {"command." + names.axis, "m",
       shifted(controller.values(names.command), lead(controller, machine), machine.count())});
  measured("displacement", "m", names.machine_displacement);
  measured("acceleration", "m/s2", names.machine_acceleration);
  measured("force", "N", names.machine_force);
}

Record record_of(const Reader& run, const std::string& name, Use use) {
  const recording::Roles roles = recording::roles_of(run);
  const NodeTicks machine = ticks_of(run, roles.machine);
  const NodeTicks controller = ticks_of(run, roles.controller);
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = machine.interval();
  for (const auto& names : roles.axes) add_axis(record, run, machine, controller, names);
  if (record.channels.empty())
    throw Error{fmt::format("no axis has a command, expected '{}'", roles.axes[0].command)};
  record.channels.push_back({"vertical_force", "N", machine.values(roles.vertical_force)});
  record.quiet = quiet_stretch(machine, roles.new_target);
  record.gaps = gaps_of(machine);
  return record;
}

// Largest velocity, averaged over a few samples to suppress noise [m/s].
double fastest(const Case& c) {
  constexpr std::size_t kSpan = 10;
  double largest = 0;
  for (const auto& record : c.records)
    for (const auto& channel : record.channels) {
      if (!channel.role.starts_with("displacement.")) continue;
      for (std::size_t i = kSpan; i < channel.values.size(); ++i)
        largest = std::max(largest, std::abs(channel.values[i] - channel.values[i - kSpan]) /
                                        (kSpan * record.time_step));
    }
  return largest;
}

Model model_of(const Reader& run) {
  const std::string text = run.config(recording::kModelText);
  if (text.empty())
    throw Error{
        fmt::format("it contains no model of the simulation (/config/{}): run the "
                    "experiment again",
                    recording::kModelText)};
  return read_model(Config::parse(text, recording::kModelText));
}

// The experiment of a run with the changes of its command line, if its file still exists: only then
// relative paths in it have a meaning.
void take_experiment(const Reader& run, const Config& experiment, CaseSource& source) {
  const std::string path = recording::experiment_path(run);
  if (!std::filesystem::exists(path)) return;
  const auto folder = std::filesystem::absolute(path).parent_path();
  source.experiment = experiment.in_folder(folder).in_its_folder();
  source.experiment_folder = source.experiment.resolve("");
  source.inputs = source.experiment.named_files();
  source.inputs.emplace_back(path);
}

}  // namespace

Case case_of_run(const std::filesystem::path& file) {
  Case result;
  result.folder = file.parent_path();
  of_file(file, [&] {
    const Reader run{file};
    const auto experiment = recording::recorded_experiment(run);
    result.name = file.stem().string();
    if (experiment) result.name = experiment->text("name", result.name);
    result.model = model_of(run);
    result.records.push_back(record_of(run, file.filename().string(), Use::Fit));
    if (experiment) take_experiment(run, *experiment, result.source);
  });
  const auto held_out = file.parent_path() / kHeldOutFile;
  // A run may be about to make it.
  if (held_out != file && std::filesystem::exists(held_out) &&
      !recording::is_being_written(held_out))
    of_file(held_out, [&] {
      result.records.push_back(record_of(Reader{held_out}, kHeldOutFile, Use::HeldOut));
      result.source.inputs.push_back(held_out);
    });
  if (fastest(result) / kUsualRate > kFurthest) result.comparison.model_rate = kFineRate;
  result.source.inputs.push_back(file);
  result.source.folder = std::filesystem::absolute(file).parent_path();
  result.source.file = Config{}.in_folder(result.source.folder);
  result.source.file.set("format", std::to_string(kCaseFormat));
  result.source.file.put("name", result.name);
  result.source.file.put("run", file.filename().string());
  result.source.file.set("model", result.model.table);
  return result;
}

}  // namespace rths::diagnosis
