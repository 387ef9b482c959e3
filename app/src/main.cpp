// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/broker/ring.hpp>
#include <rths/command_line/program.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/key_value.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/folder.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

/// Values of all options; must outlive the parser.
struct Arguments {
  RunArguments run;
  NodeArguments node;
  ExportArguments table;
  LoopArguments loop;
  TermsArguments terms;
  RingCommandArguments rings;
  DiagnoseArguments diagnose;
  CheckArguments check;
  NewAdapterArguments made;
  ReplayArguments replay;
  CommissioningArguments before;
  std::string clock = "wall", file, language = "cpp", folder, beside, kept = "out/failed_tests";
  std::vector<std::string> sets;
};

void add_run(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("run", "Run an experiment and write its recording and report");
  command->add_option("experiment", a.run.settings.experiment, "Experiment file")->required();
  command
      ->add_option("--clock", a.clock,
                   "wall: real time, one process per node; virtual: deterministic, no waiting; "
                   "auto: real time, repeated in virtual time if the host was too late")
      ->check(CLI::IsMember({"wall", "virtual", "auto"}));
  auto* out = command->add_option("--out", a.run.settings.out,
                                  "Folder for the results [a new one: out/<name>/<UTC time>]");
  command
      ->add_flag("--force", a.run.settings.replaces,
                 "Replace the results of an earlier run in --out")
      ->needs(out);
  command->add_option("--ring", a.run.settings.ring, "Name of the ring [the experiment's]");
  auto* host = command->add_option("--host", a.run.settings.host,
                                   "Run only the nodes of this host, together with the other hosts "
                                   "of the experiment");
  command
      ->add_option("--interface", a.run.settings.interface,
                   "Network interface or address, with --host [the experiment's]")
      ->needs(host);
  command
      ->add_option(
          "--set", a.sets,
          "Override a key of the experiment: key=value, such as map=sts or motion.scale=0.5")
      ->take_all()
      ->allow_extra_args(false);
  command
      ->add_option("--improve", a.run.settings.improvements,
                   "improved.toml of a diagnosis, added to the improvements of the model")
      ->check(CLI::ExistingFile)
      ->take_all()
      ->allow_extra_args(false);
  command->add_flag("!--no-diagnosis", a.run.settings.diagnoses,
                    "Do not diagnose the recording at the end");
  command->add_flag("--json", a.run.json, "One JSON document instead of lines");
  command->callback([&] {
    auto& settings = a.run.settings;
    if (a.clock == "virtual") settings.clock = launch::ClockKind::Virtual;
    settings.repeats_late = a.clock == "auto";
    settings.changes = split_changes(a.sets);
    settings.version = version();
    chosen = [&a] { return run(a.run); };
  });
}

void add_node(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("node", "Run one node; for the launcher");
  command->group("");
  command->add_option("experiment", a.node.experiment)->required();
  command->add_option("--node", a.node.node)->required();
  command->add_option("--ring", a.node.ring)->required();
  command->add_option("--recording", a.node.recording)->required();
  command->add_option("--set", a.sets)->take_all()->allow_extra_args(false);
  command->callback([&] {
    a.node.changes = split_changes(a.sets);
    chosen = [&a] { return node(a.node); };
  });
}

void add_check(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("check",
                                     "Check a map, diagram, constants, bearing, machine, safety "
                                     "limits, experiment, scenario of cards, case, improved "
                                     "model, motion, recording, plugin or FMU; its content "
                                     "decides which");
  command->add_option("file", a.check.file, "File, or the word server")->required();
  command->add_option("address", a.check.address,
                      "HOST:PORT of a server for OpenSees' genericClient, after the word server");
  command->add_option("--config", a.check.config, "TOML file with the config of a plugin")
      ->check(CLI::ExistingFile);
  command->add_option("--dofs", a.check.dofs, "Degrees of freedom of a server")
      ->check(CLI::Range(1, 15))
      ->capture_default_str();
  command
      ->add_option("--amplitude", a.check.amplitude,
                   "Trial displacement of a server, in its units [0: it stays at rest]")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--udp", a.check.udp, "The server uses UDP");
  command
      ->add_option("--set", a.sets, "Override a key of the experiment, as in rths run: key=value")
      ->take_all()
      ->allow_extra_args(false);
  command->callback([&] {
    a.check.changes = split_changes(a.sets);
    chosen = [&a] { return check(a.check); };
  });
}

void add_export(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "export", "Write signals of a recording as a table: one row per time, SI units");
  command->add_option("recording", a.table.recording, "Recording, or folder of a run")->required();
  command->add_option("--signals", a.table.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--from", a.table.from, "First time [s]");
  command->add_option("--to", a.table.to, "Last time [s]");
  command->add_option("--format", a.table.format)->check(CLI::IsMember({"csv", "mat"}));
  command->add_option("--out", a.table.out, "File [name of the recording, in this folder]");
  command->callback([&] { chosen = [&a] { return export_table(a.table); }; });
}

void add_loop(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("loop", "Drive a bearing through loops; print and draw them");
  command->add_option("bearing", a.loop.bearing, "Built-in name (lprb, eqsb, tpfb) or file")
      ->required();
  command->add_option("--amplitude-m", a.loop.amplitude)
      ->check(CLI::Range(1e-6, 10.0))
      ->capture_default_str();
  command->add_option("--frequency-Hz", a.loop.frequency)
      ->check(CLI::Range(1e-4, 20.0))
      ->capture_default_str();
  command
      ->add_option("--cycles", a.loop.cycles,
                   "Cycles at full amplitude, after one with growing amplitude")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--axial-load-N", a.loop.axial_load, "[weight per bearing of the example plant]")
      ->check(CLI::Range(0.0, 1e9));
  command->add_option("--svg", a.loop.svg, "Draw both loops into this SVG file");
  command->add_option("--csv", a.loop.csv, "Write the loop along one axis to this CSV file");
  command->add_option("--set", a.sets, "Override a term: term.key=value, term.enabled=false")
      ->take_all()
      ->allow_extra_args(false);
  command->callback([&] {
    a.loop.changes = split_changes(a.sets);
    chosen = [&a] { return loop(a.loop); };
  });
}

void add_terms(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "terms", "List the terms of bearings, machines and sensors, with equations");
  command->add_option("names", a.terms.names, "Terms to list [all]");
  command->add_option("--format", a.terms.format)
      ->check(CLI::IsMember({"text", "markdown", "json"}));
  command->add_option("--draw", a.terms.draw,
                      "Draw the effect of each term into this folder, print nothing");
  command->callback([&] { chosen = [&a] { return terms(a.terms); }; });
}

void add_diagnose(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "diagnose", "Find the physics that a simulation omits, or report that none is missing");
  command
      ->add_option("case", a.diagnose.settings.source,
                   "Folder with a case.toml, a case file, or folder or recording of a run")
      ->required();
  command->add_option("--out", a.diagnose.settings.out,
                      "Folder for the results [out/diagnosis/<name>]");
  command->add_option("--against", a.diagnose.settings.against,
                      "Prediction of another simulation, instead of the model's");
  command
      ->add_option("--without", a.diagnose.settings.without,
                   "Terms to exclude, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--seed", a.diagnose.settings.seed, "Seed of noise and resampling")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed))
      ->capture_default_str();
  command->add_flag("--plan", a.diagnose.plans,
                    "Print what this case can tell, without a diagnosis");
  command->add_flag("--progress", a.diagnose.progress,
                    "Show the progress every 30 s where standard error is not a terminal");
  command->add_flag("--json", a.diagnose.json, "One JSON document instead of lines");
  command->callback([&] { chosen = [&a] { return diagnose(a.diagnose); }; });
}

void add_map(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("map", "Memory maps");
  command->require_subcommand(1);
  command->add_subcommand("list", "List the built-in maps")->callback([&] {
    chosen = [] { return map_list(); };
  });
  auto* check_command = command->add_subcommand("check", "Check a map");
  check_command->add_option("map", a.file, "File, or name of a built-in map")->required();
  check_command->callback([&] { chosen = [&a] { return map_check(a.file); }; });
  auto* gen = command->add_subcommand("gen", "Print a header for programs that use the map");
  gen->add_option("map", a.file, "File, or name of a built-in map")->required();
  gen->add_option("--lang", a.language)->check(CLI::IsMember({"c", "cpp"}));
  gen->callback([&] { chosen = [&a] { return map_gen(a.file, a.language); }; });
}

void add_plugins(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* make = app.add_subcommand("new", "Make a folder to begin with");
  make->require_subcommand(1);
  auto* adapter = make->add_subcommand("adapter", "A plugin that builds, with its tests");
  adapter->add_option("name", a.made.name, "Name of the adapter and its folder")->required();
  adapter->add_option("--language", a.made.language)
      ->check(CLI::IsMember({"c", "cpp", "python"}))
      ->capture_default_str();
  adapter->add_option("--role", a.made.role)
      ->check(CLI::IsMember({"machine", "controller"}))
      ->capture_default_str();
  adapter->callback([&] { chosen = [&a] { return new_adapter(a.made); }; });
  auto* command = app.add_subcommand(
      "replay", "Run a plugin or FMU on the inputs of a recording and compare its outputs");
  command->add_option("library", a.replay.library, "Plugin or FMU")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("recording", a.replay.recording, "Recording, or folder of a run")->required();
  command
      ->add_option("--config", a.replay.config,
                   "TOML file with the config of the plugin, or the table of the FMU's node; "
                   "without, those of "
                   "the recorded node")
      ->check(CLI::ExistingFile);
  command->add_option("--node", a.replay.node, "Node of its monitors and parameters")
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return replay(a.replay); }; });
}

void add_test(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "test", "Run a test: programs on a ring of their own, faults, expectations of signals");
  command->add_option("file", a.file, "Test file")->required()->check(CLI::ExistingFile);
  command->add_option("--keep", a.kept, "Folder for logs and recordings of failed tests")
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return test(a.file, a.kept); }; });
}

void add_report(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("report", "Rewrite the report of a run");
  command->add_option("folder", a.folder, "Folder of the run")->required();
  command->add_option("--beside", a.beside,
                      "Folder of another run, to show its response and spectra, too");
  command->callback([&] { chosen = [&a] { return report(a.folder, a.beside); }; });
}

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

std::vector<std::string> candidates_for(const std::string& option, const std::string& source) {
  if (option == "signals") return signals_of(source);
  if (option == "map") return built_in_names("maps");
  if (option == "bearing") return built_in_names("bearings");
  std::vector<std::string> candidates;
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
  Arguments arguments;
  Chosen chosen;
  for (const auto add : {add_run, add_node, add_check, add_export, add_report, add_diagnose,
                         add_loop, add_terms, add_map, add_plugins, add_test})
    add(app, arguments, chosen);
  add_ring_commands(app, arguments.rings, chosen);
  app.add_subcommand("bench", "Run a benchmark on this host, with rths-bench(1) where it is built");
  add_commissioning(app, arguments.before, chosen);
  return run({app, chosen, version(), candidates_for}, argc, argv);
}

}  // namespace

Changes split_changes(const std::vector<std::string>& sets) {
  Changes changes;
  for (const auto& set : sets) {
    const auto change = key_value(set);
    if (!change) throw CLI::ValidationError{"--set " + set + ": expected key=value"};
    changes.push_back(*change);
  }
  return changes;
}

}  // namespace rths::app

int main(int argc, char** argv) {
  return rths::app::guarded("rths", [&] { return rths::app::parse_and_run(argc, argv); });
}
