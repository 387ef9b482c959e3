// SPDX-License-Identifier: Apache-2.0
//
// The options of `rths bench`. A new benchmark is a member of Arguments and a function here.
#include "commands.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

namespace rths::bench {
namespace {

void show(const std::string& stage) { write_message(fmt::format("\r{:<60}", stage)); }

// Shows the stage of a long measurement on a terminal, in one line that is empty at the end.
template <class Options, class Report>
Report measured(Report (*measure)(const Options&), Options options) {
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  if constexpr (requires { options.progress; })
    if (on_terminal) options.progress = show;
  Report report = measure(options);
  if (on_terminal) show("\r");
  return report;
}

int exit_code(GateResult result) {
  if (result == GateResult::Pass) return app::kOk;
  return result == GateResult::Fail ? app::kFailure : app::kConditionNotMet;
}

// Results are written to a file at the end, after minutes or hours.
int bench_srmd(SrmdOptions options, const std::string& file) {
  app::check_result_file(file);
  if (!file.empty() && !std::ofstream{file, std::ios::app})
    throw Error{file + ": cannot be written"};
  if (!file.empty()) options.partial = file + ".partial";
  const SrmdReport report = measured(run_srmd_bench, options);
  fmt::print("{}", to_text(report));
  if (file.empty()) return app::kOk;
  app::write_file(file, to_json(report));
  std::filesystem::remove(options.partial);
  return app::kOk;
}

struct Name {
  const char* command;
  const char* description;
};

// Adds a benchmark that prints its report.
template <class Options, class Report>
CLI::App* add(Commands& to, const Name& name, Options& options, Report (*measure)(const Options&)) {
  auto* command = to.bench.add_subcommand(name.command, name.description);
  command->add_flag("--json", to.arguments.json, "One JSON document instead of text");
  command->callback([&to, &options, measure] {
    to.chosen = [&json = to.arguments.json, &options, measure] {
      const Report report = measured(measure, options);
      fmt::print("{}", json ? to_json(report) : to_text(report));
      return exit_code(report.result);
    };
  });
  return command;
}

void add_ring(Commands& to) {
  RingOptions& options = to.arguments.ring;
  auto* command = add(
      to,
      {"ring",
       "Latency and cost of the ring, compared with a bare cache line and with other libraries"},
      options, run_ring_bench);
  command->add_option("--cycles", options.cycles, "Number of measurement cycles")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  std::vector<std::string> names;
  for (const auto& row : all_rows()) names.push_back(row.name);
  command->add_option("--row", options.rows, "Measure only this row; repeatable")
      ->check(CLI::IsMember(names))
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--round-trips", options.round_trips, "Round trips per row and cycle")
      ->check(CLI::Range(100, 10'000'000))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "Seed of the bootstrap for 95 % intervals")
      ->check(CLI::Range(std::int64_t{0}, app::kLargestSeed))
      ->capture_default_str();
  command->add_option("--keep", options.keep,
                      "Folder for finished cycles; cycles found there are not repeated");
}

void add_bearings(Commands& to) {
  BearingOptions& options = to.arguments.bearings;
  auto* command = add(
      to, {"bearings", "Median and worst time of one step of a bearing, compared with OpenSees"},
      options, run_bearing_bench);
  command->add_option("--passes", options.passes, "Number of passes through the motion")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--steps", options.steps, "Steps per pass, at 1 kHz")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
  command->add_option("--opensees", options.python,
                      "Python with OpenSees [RTHS_OPENSEES_PYTHON, or that of ./lab]");
}

void add_solver(Commands& to) {
  SolverOptions& options = to.arguments.solver;
  auto* command = add(
      to,
      {"solver", "Time of one step of plants on 486 nonlinear bearings, compared with OpenSees"},
      options, run_solver_bench);
  command->add_option("--dof", options.dofs, "Degrees of freedom, the nearest mesh; repeatable")
      ->check(CLI::Range(1000, 1'000'000))
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--steps", options.steps, "Steps of a row; a tenth of a full plant")
      ->check(CLI::Range(100, 10'000'000))
      ->capture_default_str();
  command
      ->add_option("--opensees-steps", options.opensees_steps,
                   "Steps of OpenSees; a twentieth above 15,000 degrees of freedom")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command->add_option("--opensees", options.python,
                      "Python with OpenSees [RTHS_OPENSEES_PYTHON, or that of ./lab]");
}

void add_srmd(Commands& to) {
  SrmdOptions& options = to.arguments.srmd;
  auto* command = to.bench.add_subcommand(
      "srmd", "Hybrid tests on the virtual SRMD, compared with the figures of its paper");
  command->add_option("--json", to.arguments.file,
                      "File for the results; finished tests of an interrupted run are in "
                      "FILE.partial, and the next run continues there");
  command->add_option("--draws", options.draws, "Machines of the family besides the nominal one")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
  command->add_option("--records", options.records, "Ground motions")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  command->add_option("--seconds", options.duration, "Duration of a test [s]")
      ->check(CLI::Range(10.0, 1000.0))
      ->capture_default_str();
  command->add_option("--jobs", options.jobs, "Tests at one time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->callback(
      [&to] { to.chosen = [&a = to.arguments] { return bench_srmd(a.srmd, a.file); }; });
}

void add_card(Commands& to) {
  CardOptions& options = to.arguments.card;
  auto* command = add(
      to, {"card", "Hops per second of computing time of cards in virtual time, and their rates"},
      options, run_card_bench);
  command->add_option("--passes", options.passes, "Number of passes of each row")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seconds", options.seconds, "Computing time of a pass [s]")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
}

void add_opensees(Commands& to) {
  OpenSeesOptions& options = to.arguments.opensees;
  auto* command =
      add(to,
          {"opensees",
           "Round trip from an OpenSees element to a specimen, compared with a bare ping-pong"},
          options, run_opensees_bench);
  command->add_option("--cycles", options.cycles, "Number of measurement cycles")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--round-trips", options.round_trips, "Round trips per kind and cycle")
      ->check(CLI::Range(10, 1'000'000))
      ->capture_default_str();
}

void add_bridge(Commands& to) {
  BridgeOptions& options = to.arguments.bridge;
  auto* command =
      add(to, {"bridge", "From one ring to another over DDS, compared with bare DDS samples"},
          options, run_bridge_bench);
  command->add_option("--cycles", options.cycles, "Measurements in turns with bare samples")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--updates", options.updates, "Writes of each cycle")
      ->check(CLI::Range(1000, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--domain", options.domain, "DDS domain; the next one is used, too")
      ->check(CLI::Range(0, 229))
      ->capture_default_str();
}

void add_diagnosis(Commands& to) {
  DiagnosisOptions& options = to.arguments.diagnosis;
  auto* command = to.bench.add_subcommand(
      "diagnosis", "Blind trial of the diagnosis, compared with SINDy and FROLS");
  command->add_option("--cases", options.cases, "Cases of all families together")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--family", options.families, "Only this family; repeatable")
      ->check(CLI::IsMember(
          {"own", "opensees", "recordings", "laboratory", "systems", "rows", "outside", "program"}))
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--seed", options.seed, "Seed of the cases [from the commit]")
      ->check(CLI::Range(std::int64_t{0}, app::kLargestSeed));
  command->add_option("--json", to.arguments.file, "File for the results");
  command->add_option("--out", options.out,
                      "Folder of cases and verdicts; a run found there resumes");
  command->add_option("--data", options.data, "Folder of recordings [../shared/data]");
  command->add_option("--python", options.python,
                      "Python with OpenSees and NumPy [RTHS_OPENSEES_PYTHON, or that of ./lab]");
  auto* alone = command->add_flag("--no-peers{false}", options.peers, "The diagnosis alone");
  command
      ->add_option("--peer-cases", options.peer_cases,
                   "The peers get only the first so many cases [all]")
      ->check(CLI::Range(1, 10'000))
      ->excludes(alone);
  command
      ->add_option("--require", options.required,
                   "Fail if a smaller share of the detectable cases is right")
      ->check(CLI::Range(0.0, 1.0));
  command->callback(
      [&to] { to.chosen = [&a = to.arguments]() -> int { become_trial(a.diagnosis, a.file); }; });
}

void add_force(Commands& to) {
  ForceOptions& options = to.arguments.force;
  auto* command =
      add(to,
          {"force",
           "Identification and correction of a machine's own force, on simulated empty tables"},
          options, run_force_bench);
  command->add_option("--seeds", options.seeds, "Number of machines")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
}

void add_vertical(Commands& to) {
  VerticalOptions& options = to.arguments.vertical;
  auto* command = add(
      to, {"vertical", "Force control of a stiff vertical axis, compared with the paper's cascade"},
      options, run_vertical_bench);
  command->add_option("--draws", options.draws, "Number of machines beside the nominal one")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--duration", options.duration, "Duration of the command [s]")
      ->check(CLI::Range(8.0, 1000.0))
      ->capture_default_str();
}

}  // namespace

void add_benchmarks(Commands& to) {
  for (const auto add : {add_ring, add_bearings, add_solver, add_srmd, add_card, add_opensees,
                         add_bridge, add_diagnosis, add_force, add_vertical})
    add(to);
}

}  // namespace rths::bench
