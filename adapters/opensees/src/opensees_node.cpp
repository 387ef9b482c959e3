// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees_node.hpp>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <fmt/format.h>

#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/core/error.hpp>

#include "script_placeholders.hpp"

namespace rths::adapters {
namespace {

constexpr double kPeriod = 1e-3;            // [s]
constexpr double kPollingPeriod = 0.25e-3;  // of its flags [s]
constexpr int kPriority = 40;

// Default Python of OpenSees scripts.
std::string default_python() {
  const char* python = std::getenv("RTHS_OPENSEES_PYTHON");
  return python != nullptr ? python : "python3";
}

OpenSeesScript read_script(const Config& table) {
  OpenSeesScript opensees;
  opensees.connect_deadline =
      table.number_in("connect_deadline_s", 0.1, 1e5, opensees.connect_deadline);
  opensees.answer_deadline =
      table.number_in("answer_deadline_s", 0.1, 1e5, opensees.answer_deadline);
  const std::string python = table.text("python", default_python());
  const auto arguments = table.texts("arguments", {});
  for (const auto& argument : arguments)
    if (argument.starts_with("{") && argument != kMotionPlaceholder &&
        argument != kStepPlaceholder && argument != kDurationPlaceholder)
      table.fail("arguments",
                 fmt::format("unknown placeholder '{}', expected {}, {} or {}", argument,
                             kMotionPlaceholder, kStepPlaceholder, kDurationPlaceholder));
  if (!table.has("script")) {
    for (const char* key : {"arguments", "python"})
      if (table.has(key))
        table.fail(key, fmt::format("found {} without a script, expected script", key));
    return opensees;
  }
  const auto script = table.resolve(table.text("script"));
  if (!std::filesystem::exists(script))
    table.fail("script", fmt::format("script is '{}', expected a file", script.string()));
  opensees.command = {python, script.string()};
  opensees.command.insert(opensees.command.end(), arguments.begin(), arguments.end());
  return opensees;
}

// Columns: time [s], accelerations long and lat [m/s²].
std::string text_of(const sim::GroundMotion& motion) {
  std::string text = "t_s,long_m_per_s2,lat_m_per_s2\n";
  for (std::size_t i = 0; i < motion.long_acceleration.size(); ++i)
    text += fmt::format("{:.9g},{:.9g},{:.9g}\n", static_cast<double>(i) * motion.time_step,
                        motion.long_acceleration[i], motion.lat_acceleration[i]);
  return text;
}

void replace_all(std::string& text, std::string_view from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

// Fills in the arguments of a script. Its log and motion file lie beside the recording.
void complete_script(const TestSetup& setup, const NodeContext& context, OpenSeesScript& script) {
  const auto beside = [&](const std::string& ending) {
    const auto& recording = context.recording;
    return recording.parent_path() / (recording.stem().string() + "." + context.node + ending);
  };
  script.log = beside(".log");
  const auto motion = beside(".motion.csv");
  for (auto& argument : script.command) {
    if (argument.find(kMotionPlaceholder) != std::string::npos)
      script.files = {{motion, text_of(setup.motion)}};
    replace_all(argument, kMotionPlaceholder, std::filesystem::absolute(motion).string());
    replace_all(argument, kStepPlaceholder, fmt::format("{}", setup.integration_step));
    replace_all(argument, kDurationPlaceholder, fmt::format("{}", setup.duration));
  }
}

// As execvp searches it.
bool is_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return access(name.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  std::istringstream folders{path == nullptr ? "/usr/bin:/bin" : path};
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path{folder} / name).c_str(), X_OK) == 0) return true;
  return false;
}

std::function<void()> program_check(const OpenSeesScript& script, const std::string& node) {
  return [command = script.command, node] {
    if (!command.empty() && !is_program(command[0]))
      throw Error{
          fmt::format("node '{}': there is no program '{}' to run its script, expected one "
                      "as its key python or as RTHS_OPENSEES_PYTHON",
                      node, command[0])};
  };
}

// A script that reads its own motion would repeat the first earthquake, which proves nothing.
std::string motion_fault(const std::vector<std::string>& command, const std::string& node) {
  const bool takes_motion = std::any_of(command.begin(), command.end(), [](const auto& word) {
    return word.find(kMotionPlaceholder) != std::string::npos;
  });
  if (takes_motion) return "";
  return fmt::format(
      "the script of node '{}' ignores the motion of the experiment, expected {} among its "
      "arguments",
      node, kMotionPlaceholder);
}

}  // namespace

NodeSettings read_opensees_node(const std::string& node, const Config& table,
                                const TestSetup& setup) {
  OpenSeesSettings opensees;
  read_opensees(table, sim::initial_stiffness(setup.model), opensees);
  opensees.is_prompt = table.flag("prompt", false);
  opensees.script = read_script(table);
  NodeSettings settings;
  settings.role = Role::Solver;
  // A prompt adapter steps on arrival of new data, so it needs fewer scheduled steps.
  settings.schedule = schedule_of(opensees.is_prompt ? kPeriod : kPollingPeriod, 0.1 * kPeriod);
  settings.priority = kPriority;
  // The time of OpenSees restarts after static analyses and does not advance during iterations.
  settings.target_count = "step";
  settings.motion_fault = motion_fault(opensees.script.command, node);
  settings.check = program_check(opensees.script, node);
  settings.make = [opensees](const TestSetup& test, const NodeContext& context) {
    OpenSeesSettings complete = opensees;
    complete.layout = opf_layout(context.map);
    complete.simulation_step = test.simulation_step();
    complete.rest = test.rest;
    complete.wait_deadline = test.wait_deadline * test.rate;
    complete.stops_time = context.is_virtual;
    complete_script(test, context, complete.script);
    return make_opensees(complete);
  };
  return settings;
}

NodeSettings read_opensees_specimen_node(const std::string& node, const Config& table,
                                         const TestSetup& /*setup*/) {
  OpenSeesSpecimenSettings opensees;
  opensees.elements = read_specimen_elements(table);
  opensees.script = read_script(table);
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod);
  settings.priority = kPriority;
  settings.start_deadline = opensees.script.connect_deadline;  // ready when OpenSees is connected
  settings.check = program_check(opensees.script, node);
  settings.make = [opensees](const TestSetup& test, const NodeContext& context) {
    OpenSeesSpecimenSettings complete = opensees;
    complete.layout = opf_layout(context.map);
    complete.simulation_step = test.simulation_step();
    complete.stops_time = context.is_virtual;
    complete_script(test, context, complete.script);
    return make_opensees_specimen(complete);
  };
  return settings;
}

}  // namespace rths::adapters
