// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/message.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/folder.hpp>
#include <rths/session/run.hpp>

#include "command.hpp"

namespace rths::app {

Changes split_changes(const std::vector<std::string>& sets) {
  Changes changes;
  for (const auto& set : sets) {
    const auto change = key_value(set);
    if (!change) throw CLI::ValidationError{"--set " + set + ": expected key=value"};
    changes.push_back(*change);
  }
  return changes;
}

void check_sizes(const experiment::Experiment& experiment) {
  for (const auto& remark : session::remarks_on(experiment))
    write_message(fmt::format("rths: {}\n", remark));
}

std::string version() { return RTHS_VERSION; }

namespace {

// In the order of the help.
constexpr void (*kCommands[])(CommandLine&) = {
    add_run,    add_node,   add_check,    add_export,    add_report, add_compare, add_diagnose,
    add_loop,   add_terms,  add_plant,    add_map,       add_new,    add_replay,  add_play,
    add_record, add_test,   add_dump,     add_view,      add_top,    add_who,     add_watch,
    add_send,   add_bridge, add_ring,     add_fault,     add_stop,   add_doctor,  add_clean,
    add_bench,  add_delay,  add_identify, add_calibrate, add_pretest};

// Names of a ring's or a recording's signals.
std::vector<std::string> signals_of(const std::string& source) {
  try {
    if (std::filesystem::exists(source))
      return recording::Reader{session::recording_in(source)}.names();
    return broker::Ring::attach(source).map().signal_names();
  } catch (const Error&) {
    return {};
  }
}

std::vector<std::string> nodes_of(const std::string& recording) {
  std::vector<std::string> nodes;
  try {
    const recording::Reader run{session::recording_in(recording)};
    for (const auto& node : run.map().description().nodes) nodes.push_back(node.name);
  } catch (const Error&) {
  }
  return nodes;
}

std::vector<std::string> candidates_for(const std::string& option, const std::string& source) {
  if (option == "signals") return signals_of(source);
  if (option == "map") return built_in_names("maps");
  if (option == "bearing") return built_in_names("bearings");
  std::vector<std::string> candidates;
  if (option == "--as") return nodes_of(source);
  if (option == "assignments")
    for (const auto& name : signals_of(source)) candidates.push_back(name + "=");
  if (option == "ring" || option == "source")
    for (const auto& ring : broker::list_rings()) candidates.push_back(ring.name);
  return candidates;
}

int parse_and_run(int argc, char** argv) {
  become_bench({argv + 1, argv + argc});
  broker::on_lost_memory(broker::OnLostMemory::Exit);
  CLI::App app{"A software SCRAMNet+ ring, and the hybrid-simulation laboratory on it."};
  app.name("rths");
  app.require_subcommand(1);
  app.set_version_flag("--version", version());
  CommandLine line{app};
  for (const auto add : kCommands) add(line);
  return run({app, line.chosen, version(), candidates_for}, argc, argv);
}

}  // namespace
}  // namespace rths::app

int main(int argc, char** argv) {
  return rths::app::guarded("rths", [&] { return rths::app::parse_and_run(argc, argv); });
}
