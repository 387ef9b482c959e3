// SPDX-License-Identifier: Apache-2.0
#include "foreign_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/foreign/program.hpp>

#include "dynamic_drive.hpp"
#include "dynamic_reading.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kDeadline = 60;  // of a run [s]
constexpr double kLongest = 86400;
constexpr std::int64_t kRuns = 20'000, kMostRuns = 10'000'000;

// Roles by key, and the names that the simulation has for them.
std::vector<std::string> read_names(const Config& table, std::vector<std::string>& roles) {
  std::vector<std::string> names;
  for (const auto& role : table.keys()) {
    roles.push_back(role);
    names.push_back(table.text(role));
    if (names.back().empty() || names.back().find_first_of(",\"\n") != std::string::npos)
      table.fail(role, fmt::format("'{}' is no name of a column", names.back()));
  }
  return names;
}

ModelParameter read_parameter(const Config& all, const std::string& name) {
  const Config table = all.table(name);
  ModelParameter parameter{
      name, table.text("unit", "1"), table.number("value"), "parameter_error", {}, {}};
  if (table.has("bounds")) {
    const auto bounds = table.numbers("bounds");
    if (bounds.size() != 2 || !(bounds[0] < bounds[1]) || !(parameter.value >= bounds[0]) ||
        !(parameter.value <= bounds[1]))
      table.fail("bounds", "expected [low, high] around the value");
    parameter.bounds = {bounds[0], bounds[1]};
  }
  if (table.has("step")) parameter.step = table.number_in("step", 1e-100, 1e100);
  table.reject_unknown_keys();
  return parameter;
}

}  // namespace

ForeignModel::ForeignModel(const Config& table) {
  foreign::ProgramSettings settings;
  settings.command = table.texts("command");
  settings.folder = table.resolve(".");
  settings.deadline = table.number_in("deadline_s", 1e-3, kLongest, kDeadline);
  settings.inputs = read_names(table.table_or_empty("inputs"), inputs_);
  settings.outputs = read_names(table.table("outputs"), outputs_);
  if (outputs_.empty()) table.fail("outputs", "the table is empty, expected an output");
  const Config parameters = table.table_or_empty("parameters");
  for (const auto& name : parameters.keys()) {
    parameters_.push_back(read_parameter(parameters, name));
    settings.parameters.push_back(name);
  }
  const auto most = table.integer_in("most_runs", 2, kMostRuns, kRuns);
  auto program = table.placed("command", [&] { return foreign::make_program(settings); });
  runs_ = std::make_unique<foreign::Runs>(std::move(program), static_cast<std::size_t>(most));
}

foreign::RunInputs ForeignModel::stated_run(const Record& record) const {
  foreign::RunInputs run{record.start, record.time_step, record.samples(), {}, {}};
  for (const auto& role : inputs_) run.inputs.push_back(channel_of(record, role).values);
  for (const auto& parameter : parameters_) run.parameters.push_back(parameter.value);
  return run;
}

Record ForeignModel::predicted(const Record& record, bool is_first) const {
  if (!record.gaps.empty())
    throw Error{
        fmt::format("{}: the record has gaps, but a simulation that runs needs all of its inputs",
                    record.name)};
  const foreign::RunInputs run = stated_run(record);
  if (is_first) {
    try {
      runs_->check_repeats(run);
    } catch (const Error& error) {
      throw Error{fmt::format("{}: {}", record.name, error.what())};
    }
    write_message(fmt::format("The simulation runs in {:.2g} s, at most {} times, {} at a time.\n",
                              runs_->seconds() / static_cast<double>(runs_->made()), runs_->most(),
                              foreign::processors()));
  }
  const foreign::RunOutputs& result = runs_->result(run);
  if (!result.trouble.empty()) throw Error{fmt::format("{}: {}", record.name, result.trouble)};
  Record with = record;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const std::string role = prediction_of(outputs_[i]);
    std::erase_if(with.channels, [&](const Channel& channel) { return channel.role == role; });
    with.channels.push_back({role, channel_of(record, outputs_[i]).unit, result.outputs[i]});
  }
  return with;
}

std::string ForeignModel::note() const {
  return fmt::format("The simulation ran {} times, of {} that are allowed (most_runs).",
                     runs_->made(), runs_->most());
}

DynamicModel read_foreign(const Config& table, const ForeignModel& foreign, const Record& record) {
  Config rest = table;  // without what the simulation reads
  for (const char* key : {"command", "deadline_s", "most_runs", "inputs", "outputs", "parameters"})
    rest = rest.without(key);
  Record only = record;
  // Other predictions in the record are none of this simulation.
  std::erase_if(only.channels, [&](const Channel& channel) {
    return is_predicted(channel.role) &&
           std::none_of(foreign.outputs().begin(), foreign.outputs().end(),
                        [&](const auto& role) { return channel.role == prediction_of(role); });
  });
  return read_predicted(rest, only, foreign.inputs(), foreign.parameters());
}

}  // namespace rths::diagnosis
