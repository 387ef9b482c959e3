// SPDX-License-Identifier: Apache-2.0
#include "foreign_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

#include "dynamic_drive.hpp"
#include "dynamic_reading.hpp"

namespace rths::diagnosis {

ForeignModel::ForeignModel(const Model& model) : read_{read_foreign_table(model)} {
  runs_ = std::make_unique<foreign::Runs>(std::move(read_.simulation), read_.most_runs);
}

std::vector<std::string> ForeignModel::computed() const {
  std::vector<std::string> roles;
  for (const auto& role : read_.outputs) roles.push_back(prediction_of(role));
  for (const auto& port : read_.ports) {
    roles.push_back(port.displacement);
    if (!port.velocity.empty()) roles.push_back(port.velocity);
  }
  return roles;
}

foreign::RunInputs ForeignModel::stated_run(const Record& record) const {
  foreign::RunInputs run{record.start, record.time_step, record.samples(), {}, {}, {}};
  for (const auto& role : read_.inputs) run.inputs.push_back(channel_of(record, role).values);
  for (const auto& parameter : read_.parameters) run.parameters.push_back(parameter.value);
  return run;
}

Record ForeignModel::predicted(const Record& record, bool is_first) const {
  if (!record.gaps.empty())
    throw Error{
        fmt::format("{}: the record has gaps, but a simulation that runs needs all of its inputs",
                    record.name)};
  const foreign::RunInputs run = stated_run(record);
  for (std::size_t i = 0; i < read_.units.size(); ++i)
    if (const auto& unit = channel_of(record, read_.outputs[i]).unit;
        !read_.units[i].empty() && unit != read_.units[i])
      throw Error{fmt::format("{}: {} is in {}, but the simulation returns {}", record.name,
                              read_.outputs[i], unit, read_.units[i])};
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
  const foreign::RunOutputs result = runs_->result(run);
  if (!result.trouble.empty()) throw Error{fmt::format("{}: {}", record.name, result.trouble)};
  Record with = record;
  // In the order of `computed()`.
  auto put = [&, values = result.outputs.begin()](const std::string& role,
                                                  const std::string& unit) mutable {
    std::erase_if(with.channels, [&](const Channel& channel) { return channel.role == role; });
    with.channels.push_back({role, unit, *values++});
  };
  for (const auto& role : read_.outputs) put(prediction_of(role), channel_of(record, role).unit);
  for (const auto& port : read_.ports) {
    put(port.displacement, port.displacement_unit);
    if (!port.velocity.empty()) put(port.velocity, port.velocity_unit);
  }
  return with;
}

std::string ForeignModel::note() const {
  return fmt::format("The simulation ran {} times, of {} that are allowed (most_runs).",
                     runs_->made(), runs_->most());
}

DynamicModel read_foreign(const ForeignModel& foreign, const Record& record) {
  Record only = record;
  // Other predictions in the record are none of this simulation.
  const auto computed = foreign.computed();
  std::erase_if(only.channels, [&](const Channel& channel) {
    return is_predicted(channel.role) &&
           std::find(computed.begin(), computed.end(), channel.role) == computed.end();
  });
  return read_predicted(foreign.rest(), only,
                        {foreign.inputs(), foreign.parameters(), foreign.ports()});
}

}  // namespace rths::diagnosis
