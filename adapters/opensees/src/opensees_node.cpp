// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/experiment/parts.hpp>
#include <rths/experiment/user_program.hpp>
#include <rths/foreign/opensees.hpp>

#include "script_runner.hpp"

namespace rths::adapters {

using namespace experiment;

namespace {

constexpr double kPeriod = 1e-3;            // [s]
constexpr double kPollingPeriod = 0.25e-3;  // of its flags [s]
constexpr int kPriority = 40;
constexpr int kMostProcesses = 1024;
constexpr int kMostTag = 1'000'000'000;

OpenSeesScript read_script(const Config& table) {
  OpenSeesScript opensees;
  opensees.connect_deadline =
      table.number_in("connect_deadline_s", 0.1, 1e5, opensees.connect_deadline);
  opensees.answer_deadline =
      table.number_in("answer_deadline_s", 0.1, 1e5, opensees.answer_deadline);
  const std::string python = table.text("python", foreign::opensees_python());
  const auto arguments = table.texts("arguments", {});
  check_placeholders(
      table, "arguments", arguments,
      {kMotionPlaceholder, kStepPlaceholder, kDurationPlaceholder, kResultsPlaceholder});
  if (!table.has("script")) {
    for (const char* key : {"arguments", "processes", "python"})
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

std::vector<OpenSeesFloor> read_floors(const Config& table, const std::string& motion_fault) {
  std::vector<OpenSeesFloor> floors;
  for (const auto& one : table.tables("floor")) {
    if (!table.has("script")) table.fail("floor", "found floors without a script, expected script");
    if (!motion_fault.empty()) table.fail("floor", motion_fault);
    OpenSeesFloor floor;
    floor.name = one.text("name");
    floor.node = static_cast<int>(one.integer_in("node", 0, kMostTag));
    const auto dofs = one.numbers("dofs", {1, 2});
    if (dofs.size() != 2 || std::any_of(dofs.begin(), dofs.end(), [](double dof) {
          return dof != std::floor(dof) || dof < 0 || dof > 6;
        }))
      one.fail("dofs",
               "dofs of a floor are those along long and lat, expected two from 1 to 6; 0: none");
    floor.dofs = {static_cast<int>(dofs[0]), static_cast<int>(dofs[1])};
    one.reject_unknown_keys();
    floors.push_back(floor);
  }
  return floors;
}

// Fills in the arguments of a script. Its log and motion file lie beside the recording.
void complete_script(const Experiment& setup, const NodeContext& context, OpenSeesScript& script) {
  script.log = file_beside(context.recording, context.node, ".log");
  const auto motion = file_beside(context.recording, context.node, ".motion.csv");
  // A check has no recording.
  const auto results = context.recording.empty()
                           ? std::filesystem::path{}
                           : std::filesystem::absolute(context.recording).replace_extension();
  for (auto& argument : script.command) {
    if (fill_in(argument, setup, motion))
      script.files = {{motion, motion_text(setup.earthquake.motion)}};
    replace_all(argument, kResultsPlaceholder, results.string());
  }
}

// An ideal machine moves the tested axes only.
bool can_repeat(const OpenSeesSettings& opensees, const Experiment& setup) {
  return !opensees.script.command.empty() &&
         std::all_of(opensees.elements.begin(), opensees.elements.end(), [&](const auto& element) {
           return element.actuators.empty() &&
                  std::all_of(element.axes.begin(), element.axes.end(),
                              [&](const auto& axis) { return contains(setup.axes, axis.axis); });
         });
}

std::function<void()> program_check(const OpenSeesScript& script, const std::string& node) {
  return [command = script.command, processes = script.processes, node] {
    if (!command.empty() && !is_program(command[0]))
      throw Error{
          fmt::format("node '{}': there is no program '{}' to run its script, expected one "
                      "as its key python or as RTHS_OPENSEES_PYTHON",
                      node, command[0])};
    if (processes > 1) require_rank_launcher(processes);
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
                                const Experiment& setup, const NodeSettings& ideal) {
  OpenSeesSettings opensees;
  read_opensees(table, sim::initial_stiffness(setup.model.bearing), opensees);
  opensees.is_prompt = table.flag("prompt", false);
  opensees.script = read_script(table);
  opensees.script.processes = static_cast<int>(table.integer_in("processes", 1, kMostProcesses, 1));
  NodeSettings settings;
  settings.role = Role::Solver;
  // A prompt adapter steps on arrival of new data, so it needs fewer scheduled steps.
  settings.schedule =
      schedule_of(opensees.is_prompt ? kPeriod : kPollingPeriod, 0.1 * kPeriod, MissedSteps::Skip);
  settings.priority = kPriority;
  settings.solver.has_computing_time = settings.solver.waits_for_flags = true;
  settings.solver.ticks_per_target = ticks_per_target(opensees.handshake);
  // The time of OpenSees restarts after static analyses and does not advance during iterations.
  settings.solver.target_count = "step";
  settings.solver.motion_fault = motion_fault(opensees.script.command, node);
  opensees.script.floors = read_floors(table, settings.solver.motion_fault);
  for (const auto& floor : opensees.script.floors) settings.solver.floors.push_back(floor.name);
  settings.check = program_check(opensees.script, node);
  if (can_repeat(opensees, setup))
    settings.solver.ideal_machine = std::make_shared<const NodeSettings>(ideal);
  settings.make = [opensees](const Experiment& test, const NodeContext& context) {
    OpenSeesSettings complete = opensees;
    complete.layout = opf_layout(context.map);
    complete.simulation_step = test.time.simulation_step();
    complete.integration_step = test.time.integration_step;
    complete.rest = test.time.rest;
    complete.wait_deadline = test.solver.wait_deadline * test.time.rate;
    complete.stops_time = context.is_virtual;
    complete.ground = [motion = test.earthquake.motion](double time) {
      const auto at = motion.at(time);
      return std::array{at[0], at[1]};
    };
    if (test.solver.models_computing_time)
      complete.computing_time = [times = ComputingTimes{test.solver.computing_time}]() mutable {
        return times.draw();
      };
    complete_script(test, context, complete.script);
    return make_opensees(complete);
  };
  return settings;
}

NodeSettings read_opensees_specimen_node(const std::string& node, const Config& table,
                                         const Experiment& /*setup*/) {
  OpenSeesSpecimenSettings opensees;
  opensees.elements = read_specimen_elements(table);
  opensees.script = read_script(table);
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod);
  settings.priority = kPriority;
  settings.start_deadline = opensees.script.connect_deadline;  // ready when OpenSees is connected
  settings.check = program_check(opensees.script, node);
  settings.make = [opensees](const Experiment& test, const NodeContext& context) {
    OpenSeesSpecimenSettings complete = opensees;
    complete.layout = opf_layout(context.map);
    complete.simulation_step = test.time.simulation_step();
    complete.stops_time = context.is_virtual;
    complete_script(test, context, complete.script);
    return make_opensees_specimen(complete);
  };
  return settings;
}

}  // namespace rths::adapters
