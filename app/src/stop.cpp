// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/launch/run.hpp>

#include "command.hpp"
#include "commands.hpp"

namespace rths::app {
namespace {

int stop(const std::string& ring) {
  fmt::print("process {} ends the run on ring '{}'\n", launch::request_stop(ring), ring);
  return kOk;
}

}  // namespace

void add_stop(CommandLine& line) {
  auto& a = line.values<std::string>();
  auto* command = line.app.add_subcommand("stop", "End a run in order, with its report");
  command->add_option("ring", a, "Name of the run's ring")->required();
  command->callback([&] { line.chosen = [&a] { return stop(a); }; });
}

}  // namespace rths::app
