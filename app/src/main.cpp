// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>

#include "command_line.hpp"
#include "commands.hpp"

namespace rths::app {
namespace {

void print_error(const std::string& text) { write_message(fmt::format("rths: {}\n", text)); }

// A closed standard stream would get the number of the next file that is opened, which messages
// would then overwrite.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0)  // NOLINT(cppcoreguidelines-pro-type-vararg)
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
      static_cast<void>(open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

// Why a command ended that could not write its results to standard output, or failed otherwise.
std::string reason_of(const std::exception& error) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system == nullptr || std::ferror(stdout) == 0) return error.what();
  return "standard output cannot be written: " + system->code().message();
}

/// Values of all options; must outlive the parser.
struct Arguments {
  RunArguments run;
  NodeArguments node;
  DumpArguments dump;
  ExportArguments table;
  WhoArguments who;
  WatchArguments watch;
  BridgeArguments bridge;
  DoctorArguments doctor;
  SendArguments send;
  BenchmarkArguments bench;
  LoopArguments loop;
  TermsArguments terms;
  RingArguments ring;
  FaultArguments fault;
  DiagnoseArguments diagnose;
  CheckArguments check;
  NewAdapterArguments made;
  ReplayArguments replay;
  CommissioningArguments before;
  std::string clock = "wall", file, language = "cpp", folder, beside, format = "text",
              kept = "out/failed_tests";
  std::vector<std::string> sets, rings;
};

void add_run(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("run", "Run an experiment and write its recording and report");
  command->add_option("experiment", a.run.experiment, "Experiment file")->required();
  command
      ->add_option("--clock", a.clock,
                   "wall: real time, one process per node; virtual: deterministic, no waiting")
      ->check(CLI::IsMember({"wall", "virtual"}));
  auto* out = command->add_option("--out", a.run.out,
                                  "Folder for the results [a new one: out/<name>/<UTC time>]");
  command->add_flag("--force", a.run.force, "Replace the results of an earlier run in --out")
      ->needs(out);
  command->add_option("--ring", a.run.ring, "Name of the ring [the experiment's]");
  auto* host = command->add_option("--host", a.run.host,
                                   "Run only the nodes of this host, together with the other hosts "
                                   "of the experiment");
  command
      ->add_option("--interface", a.run.interface,
                   "Network interface or address, with --host [the experiment's]")
      ->needs(host);
  command
      ->add_option(
          "--set", a.sets,
          "Override a key of the experiment: key=value, such as map=sts or motion.scale=0.5")
      ->take_all()
      ->allow_extra_args(false);
  command
      ->add_option("--improve", a.run.improvements,
                   "improved.toml of a diagnosis, applied to the model of the simulation")
      ->check(CLI::ExistingFile)
      ->take_all()
      ->allow_extra_args(false);
  command->add_flag("!--no-diagnosis", a.run.diagnoses, "Do not diagnose the recording at the end");
  command->callback([&] {
    a.run.virtual_time = a.clock == "virtual";
    a.run.changes = split_changes(a.sets);
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
  command->callback([&] { chosen = [&a] { return check(a.check); }; });
}

void add_dump(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command =
      app.add_subcommand("dump", "Print the words of a ring, or the rows of a recording");
  command->add_option("source", a.dump.ring_or_recording, "Name of a ring, or file of a recording")
      ->required();
  command->add_option("signals", a.dump.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--format", a.dump.format)->check(CLI::IsMember({"text", "json", "csv"}));
  command->add_flag("--once", a.dump.once, "Print current values of a ring, not changes");
  command->add_option("-n,--count", a.dump.count, "Stop after this number of lines")
      ->check(CLI::NonNegativeNumber);
  command->add_option("-T,--timeout", a.dump.timeout_ms, "Stop after this time [ms]")
      ->check(CLI::NonNegativeNumber);
  command->callback([&] { chosen = [&a] { return dump(a.dump); }; });
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

void add_who(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("who", "Print the last writer and write time of words");
  command->add_option("ring", a.who.ring, "Name of a ring")->required();
  command->add_option("signals", a.who.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--format", a.who.format)->check(CLI::IsMember({"text", "json"}));
  command->callback([&] { chosen = [&a] { return who(a.who); }; });
}

void add_watch(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "watch",
      "Journal stores of clients that bypass the API; print stores into other nodes' words");
  command->add_option("ring", a.watch.ring, "Name of a ring")->required();
  command->add_option("--period-us", a.watch.period_us, "Time between two scans [50]")
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("-T,--timeout", a.watch.timeout_ms, "Stop after this time [ms]")
      ->check(CLI::NonNegativeNumber);
  command->callback([&] { chosen = [&a] { return watch(a.watch); }; });
}

void add_send(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("send", "Write words of a ring by name");
  command->add_option("ring", a.send.ring, "Name of a ring")->required();
  command
      ->add_option("assignments", a.send.assignments, "name=value, optionally with a unit: 12.5mm")
      ->required();
  command->callback([&] { chosen = [&a] { return send(a.send); }; });
}

std::string this_host() {
  utsname host{};
  return uname(&host) == 0 ? host.nodename : "host";
}

void add_bridge(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command =
      app.add_subcommand("bridge", "Connect a ring with those of the same name on other hosts");
  command->add_option("ring", a.bridge.ring, "Name of a ring of this host")->required();
  command->add_option("--map", a.bridge.map,
                      "Create the ring with this map; it is removed at the end");
  command->add_option("--domain", a.bridge.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command->add_option("--interface", a.bridge.interface,
                      "Network interface or address [Cyclone DDS chooses]");
  command
      ->add_option("--peer", a.bridge.peers,
                   "Address of another host, for networks without multicast; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--host", a.bridge.host, "Name of this host [its network name]");
  command->add_flag("--skip-unchanged", a.bridge.skips_unchanged,
                    "Do not send writes that leave a word as it was");
  command->add_option("--as", a.bridge.joint_name, "Name of the ring on all hosts [the ring's]");
  command->add_option("-T,--timeout", a.bridge.timeout_ms, "Stop after this time [ms]")
      ->check(CLI::NonNegativeNumber);
  command->callback([&] {
    if (a.bridge.host.empty()) a.bridge.host = this_host();
    chosen = [&a] { return bridge(a.bridge); };
  });
}

void add_ring(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command =
      app.add_subcommand("ring", "Simulate a ring of cards in virtual time, message by message");
  command->require_subcommand(1);
  auto* trace = command->add_subcommand(
      "trace", "Write every hop of a scenario as trace events for Perfetto or chrome://tracing");
  trace->add_option("scenario", a.ring.source, "Scenario file")
      ->required()
      ->check(CLI::ExistingFile);
  trace->add_option("--out", a.ring.out,
                    "File for the trace [name of the scenario, in this folder]");
  trace->callback([&] { chosen = [&a] { return ring_trace(a.ring); }; });
  auto* show = command->add_subcommand(
      "show", "Draw nodes, registers, FIFOs and ages of a scenario or of a running ring");
  show->add_option("source", a.ring.source, "Scenario file, or name of a ring")->required();
  show->add_option("--at-us", a.ring.at_us, "Time in the scenario [us; its end]")
      ->check(CLI::NonNegativeNumber);
  show->callback([&] { chosen = [&a] { return ring_show(a.ring); }; });
}

void add_fault(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("fault", "Cause a fault of the cards of a replicated ring");
  command->add_option("ring", a.fault.ring, "Name of a ring")->required();
  command
      ->add_option("keys", a.fault.keys,
                   "key=value, as in a [[fault]] of an experiment: kind=power_off node=NAME")
      ->required();
  command->callback([&] { chosen = [&a] { return fault(a.fault); }; });
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
      ->add_option("case", a.diagnose.case_or_recording,
                   "Folder with a case.toml, a case file, or folder or recording of a run")
      ->required();
  command->add_option("--out", a.diagnose.out, "Folder for the results [out/diagnosis/<name>]");
  command->add_option("--against", a.diagnose.against,
                      "Prediction of another simulation, instead of the model's");
  command->add_option("--without", a.diagnose.without, "Terms to exclude, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--seed", a.diagnose.seed, "Seed of noise and resampling")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed))
      ->capture_default_str();
  command->add_flag("--plan", a.diagnose.plans,
                    "Print what this case can tell, without a diagnosis");
  command->add_flag("--progress", a.diagnose.progress,
                    "Show the progress every 30 s where standard error is not a terminal");
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

void add_rest(CLI::App& app, Arguments& a, Chosen& chosen) {
  auto* report_command = app.add_subcommand("report", "Rewrite the report of a run");
  report_command->add_option("folder", a.folder, "Folder of the run")->required();
  report_command->add_option("--beside", a.beside,
                             "Folder of another run, to show its response and spectra, too");
  report_command->callback([&] { chosen = [&a] { return report(a.folder, a.beside); }; });
  auto* stop_command = app.add_subcommand("stop", "End a run in order, with its report");
  stop_command->add_option("ring", a.folder, "Name of the run's ring")->required();
  stop_command->callback([&] { chosen = [&a] { return stop(a.folder); }; });
  auto* doctor_command = app.add_subcommand(
      "doctor", "List the rings of this host and their faults, or the network's");
  doctor_command->add_option("--format", a.doctor.format)->check(CLI::IsMember({"text", "json"}));
  auto* domain =
      doctor_command
          ->add_option("--domain", a.doctor.domain,
                       "Examine the network: interfaces, gateways of this DDS domain, their clocks")
          ->check(CLI::Range(0, 230));
  doctor_command->add_option("--interface", a.doctor.interface, "As for the gateway of this host")
      ->needs(domain);
  doctor_command->add_option("--peer", a.doctor.peers, "As for the gateway of this host")
      ->take_all()
      ->allow_extra_args(false)
      ->needs(domain);
  doctor_command->callback([&] { chosen = [&a] { return doctor(a.doctor); }; });
  auto* clean_command =
      app.add_subcommand("clean", "Remove rings that no running process uses, but keep idle cards");
  clean_command->add_option("ring", a.rings, "Names of rings to remove, also with idle cards");
  clean_command->callback([&] { chosen = [&a] { return clean(a.rings); }; });
}

// For the shell's completion and for the installation; not in the help.
std::optional<int> run_hidden(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty() || (words[0] != "complete" && words[0] != "manual")) return std::nullopt;
  if (words[0] == "manual")
    fmt::print("{}", manual_page(app, version()));
  else
    fmt::print("{}\n", fmt::join(completions(app, {words.begin() + 1, words.end()}), "\n"));
  return kOk;
}

// The help of the innermost command that was given.
std::string usage_hint(const CLI::App& app) {
  std::string command = app.get_name();
  for (const auto* inner = &app; !inner->get_subcommands().empty();) {
    inner = inner->get_subcommands().front();
    command += " " + inner->get_name();
  }
  return fmt::format("; see {} --help", command);
}

int parse_and_run(int argc, char** argv) {
  CLI::App app{"A software SCRAMNet+ ring, and the hybrid-simulation laboratory on it."};
  app.name("rths");
  app.require_subcommand(1);
  app.set_version_flag("--version", version());
  Arguments arguments;
  Chosen chosen;
  for (const auto add : {add_run, add_node, add_check, add_dump, add_export, add_who, add_watch,
                         add_fault, add_bridge, add_send, add_ring, add_loop, add_terms,
                         add_diagnose, add_map, add_plugins, add_test, add_rest})
    add(app, arguments, chosen);
  add_bench(app, arguments.bench, chosen);
  add_commissioning(app, arguments.before, chosen);
  refuse_nan(app);
  const std::vector<std::string> words{argv + 1, argv + argc};
  if (const auto result = run_hidden(app, words)) return *result;
  try {
    check_command_names(app, words);
    app.parse(argc, argv);
  } catch (const Error& error) {
    print_error(error.what());
    return kUsage;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help or version
    print_error(printable(error.what()) + usage_hint(app));
    return kUsage;
  }
  return chosen();
}

// The exit code of a command whose standard output may be lost: a full disk.
int with_output(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  print_error(std::string{"standard output cannot be written: "} + std::strerror(errno));
  return code == kOk ? kFailure : code;
}

}  // namespace

Changes split_changes(const std::vector<std::string>& sets) {
  Changes changes;
  for (const auto& set : sets) {
    const auto equals = set.find('=');
    if (equals == std::string::npos || equals == 0)
      throw CLI::ValidationError{"--set " + set + ": expected key=value"};
    changes.emplace_back(set.substr(0, equals), set.substr(equals + 1));
  }
  return changes;
}

}  // namespace rths::app

int main(int argc, char** argv) {
  try {
    rths::app::open_standard_streams();
    rths::broker::on_lost_memory(rths::broker::OnLostMemory::Exit);
    return rths::app::with_output(rths::app::parse_and_run(argc, argv));
  } catch (const rths::Interrupted& interrupted) {
    rths::app::print_error(interrupted.what());
    return rths::app::kConditionNotMet;
  } catch (const rths::Error& error) {
    rths::app::print_error(error.what());
    return rths::app::kFailure;
  } catch (const std::filesystem::filesystem_error& error) {
    rths::app::print_error(rths::printable(error.path1().string() + ": " + error.code().message()));
    return rths::app::kFailure;
  } catch (const std::exception& error) {
    rths::app::print_error(rths::printable(rths::app::reason_of(error)));
    return rths::app::kFailure;
  }
}
