// SPDX-License-Identifier: Apache-2.0
//
// The options of `rths bench`.
#include <CLI/CLI.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

void add_bench_card(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "card", "Hops per second of computing time of cards in virtual time, and their rates");
  command->add_flag("--json", a.card.json, "One JSON document instead of a table");
  command->add_option("--passes", a.card.passes, "Number of passes of each row")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seconds", a.card.seconds, "Computing time of a pass [s]")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_card(a.card); }; });
}

void add_bench_bearings(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "bearings", "Median and worst time of one step of a bearing, compared with OpenSees");
  command->add_flag("--json", a.bearings.json, "One JSON document instead of tables");
  command->add_option("--passes", a.bearings.passes, "Number of passes through the motion")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--steps", a.bearings.steps, "Steps per pass, at 1 kHz")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
  command->add_option("--opensees", a.bearings.opensees,
                      "Python with OpenSees [RTHS_OPENSEES_PYTHON, or that of ./lab]");
  command->callback([&] { chosen = [&a] { return bench_bearings(a.bearings); }; });
}

void add_bench_srmd(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "srmd", "Hybrid tests on the virtual SRMD, compared with the figures of its paper");
  command->add_option("--json", a.srmd.json,
                      "File for the results; finished tests of an interrupted run are in "
                      "FILE.partial, and the next run continues there");
  command->add_option("--draws", a.srmd.draws, "Machines of the family besides the nominal one")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
  command->add_option("--records", a.srmd.records, "Ground motions")
      ->check(CLI::Range(1, 3))
      ->capture_default_str();
  command->add_option("--seconds", a.srmd.duration, "Duration of a test [s]")
      ->check(CLI::Range(10.0, 1000.0))
      ->capture_default_str();
  command->add_option("--jobs", a.srmd.jobs, "Tests at one time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_srmd(a.srmd); }; });
}

void add_bench_bridge(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "bridge", "From one ring to another over DDS, compared with bare DDS samples");
  command->add_flag("--json", a.bridge.json, "One JSON document instead of lines");
  command->add_option("--cycles", a.bridge.cycles, "Measurements in turns with bare samples")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--updates", a.bridge.updates, "Writes of each cycle")
      ->check(CLI::Range(1000, 1'000'000'000))
      ->capture_default_str();
  command->add_option("--domain", a.bridge.domain, "DDS domain; the next one is used, too")
      ->check(CLI::Range(0, 229))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_bridge(a.bridge); }; });
}

void add_bench_opensees(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "opensees",
      "Round trip from an OpenSees element to a specimen, compared with a bare ping-pong");
  command->add_flag("--json", a.opensees.json, "One JSON document instead of lines");
  command->add_option("--cycles", a.opensees.cycles, "Number of measurement cycles")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--round-trips", a.opensees.round_trips, "Round trips per kind and cycle")
      ->check(CLI::Range(10, 1'000'000))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_opensees(a.opensees); }; });
}

void add_bench_diagnosis(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "diagnosis", "Blind trial of the diagnosis, compared with SINDy and FROLS");
  command->add_option("--cases", a.diagnosis.cases, "Cases of all families together")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--family", a.diagnosis.families, "Only this family; repeatable")
      ->check(CLI::IsMember({"own", "opensees", "recordings", "laboratory", "systems"}))
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--seed", a.diagnosis.seed, "Seed of the cases [from the commit]")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed));
  command->add_option("--json", a.diagnosis.json, "File for the results");
  command->add_option("--out", a.diagnosis.out,
                      "Folder of cases and verdicts; a run found there resumes");
  command->add_option("--data", a.diagnosis.data, "Folder of recordings [../shared/data]");
  command->add_option("--python", a.diagnosis.python,
                      "Python with OpenSees and NumPy [RTHS_OPENSEES_PYTHON, or that of ./lab]");
  auto* alone = command->add_flag("--no-peers{false}", a.diagnosis.peers, "The diagnosis alone");
  command
      ->add_option("--peer-cases", a.diagnosis.peer_cases,
                   "The peers get only the first so many cases [all]")
      ->check(CLI::Range(1, 10'000))
      ->excludes(alone);
  command
      ->add_option("--require", a.diagnosis.required,
                   "Fail if a smaller share of the detectable cases is right")
      ->check(CLI::Range(0.0, 1.0));
  command->callback([&] { chosen = [&a] { return bench_diagnosis(a.diagnosis); }; });
}

void add_bench_force(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "force", "Identification and correction of a machine's own force, on simulated empty tables");
  command->add_flag("--json", a.force.json, "One JSON document instead of tables");
  command->add_option("--seeds", a.force.seeds, "Number of machines")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_force(a.force); }; });
}

void add_bench_vertical(CLI::App& bench, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = bench.add_subcommand(
      "vertical", "Force control of a stiff vertical axis, compared with the paper's cascade");
  command->add_flag("--json", a.vertical.json, "One JSON document instead of a table");
  command->add_option("--draws", a.vertical.draws, "Number of machines beside the nominal one")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--duration", a.vertical.duration, "Duration of the command [s]")
      ->check(CLI::Range(8.0, 1000.0))
      ->capture_default_str();
  command->callback([&] { chosen = [&a] { return bench_vertical(a.vertical); }; });
}

}  // namespace

void add_bench(CLI::App& app, BenchmarkArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("bench", "Run a benchmark on this host");
  command->require_subcommand(1);
  auto* ring = command->add_subcommand(
      "ring",
      "Latency and cost of the ring, compared with a bare cache line and with other libraries");
  ring->add_flag("--json", a.ring.json, "One JSON document instead of tables");
  ring->add_option("--cycles", a.ring.cycles, "Number of measurement cycles")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  ring->add_option("--row", a.ring.rows, "Measure only this row; repeatable")
      ->check(CLI::IsMember(bench_rows()))
      ->take_all()
      ->allow_extra_args(false);
  ring->add_option("--round-trips", a.ring.round_trips, "Round trips per row and cycle")
      ->check(CLI::Range(100, 10'000'000))
      ->capture_default_str();
  ring->add_option("--seed", a.ring.seed, "Seed of the bootstrap for 95 % intervals")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed))
      ->capture_default_str();
  ring->add_option("--keep", a.ring.keep,
                   "Folder for finished cycles; cycles found there are not repeated");
  ring->callback([&] { chosen = [&a] { return bench_ring(a.ring); }; });
  add_bench_bearings(*command, a, chosen);
  add_bench_srmd(*command, a, chosen);
  add_bench_card(*command, a, chosen);
  add_bench_opensees(*command, a, chosen);
  add_bench_bridge(*command, a, chosen);
  add_bench_diagnosis(*command, a, chosen);
  add_bench_force(*command, a, chosen);
  add_bench_vertical(*command, a, chosen);
}

}  // namespace rths::app
