// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/external_node.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/experiment/user_program.hpp>

namespace rths::adapters {

using namespace experiment;

NodeSettings read_external(const std::string& node, const Config& table,
                           const Experiment& /*setup*/) {
  for (const char* key : {"period_s", "phase_s", "tune"})
    if (table.has(key))
      table.fail(key, fmt::format("found {} of a program of its own, expected none", key));
  UserProgram program;
  program.command = table.texts("command", {});
  check_placeholders(table, "command", program.command,
                     {kMotionPlaceholder, kStepPlaceholder, kDurationPlaceholder, kRingPlaceholder,
                      kNodePlaceholder});
  if (!program.command.empty() && program.command[0].find('/') != std::string::npos)
    program.command[0] = table.resolve(program.command[0]).string();
  program.folder = table.resolve(".");  // not empty
  program.connect_deadline =
      table.number_in("connect_deadline_s", 0.1, 1e5, program.connect_deadline);
  program.longest_silence = table.number_in("silence_s", 0.05, 1e6, program.longest_silence);
  NodeSettings settings;
  settings.role = Role::Solver;  // joins the ring when the others are there
  settings.start_deadline = program.connect_deadline;
  settings.check = [command = program.command, node] {
    if (!command.empty() && !is_program(command[0]))
      throw Error{
          fmt::format("node '{}': there is no program '{}', expected one as the first word "
                      "of its command",
                      node, command[0])};
  };
  settings.program = std::move(program);
  settings.lacks_safety = true;
  return settings;
}

}  // namespace rths::adapters
