// SPDX-License-Identifier: Apache-2.0
//
// The options of commands on rings.
#include <sys/utsname.h>

#include <CLI/CLI.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

void add_dump(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
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

void add_who(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("who", "Print the last writer and write time of words");
  command->add_option("ring", a.who.ring, "Name of a ring")->required();
  command->add_option("signals", a.who.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--format", a.who.format)->check(CLI::IsMember({"text", "json"}));
  command->callback([&] { chosen = [&a] { return who(a.who); }; });
}

void add_watch(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
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

void add_fault(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("fault", "Cause a fault of the cards of a replicated ring");
  command->add_option("ring", a.fault.ring, "Name of a ring")->required();
  command
      ->add_option("keys", a.fault.keys,
                   "key=value, as in a [[fault]] of an experiment: kind=power_off node=NAME")
      ->required();
  command->callback([&] { chosen = [&a] { return fault(a.fault); }; });
}

std::string this_host() {
  utsname host{};
  return uname(&host) == 0 ? host.nodename : "host";
}

void add_bridge(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
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

void add_send(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("send", "Write words of a ring by name");
  command->add_option("ring", a.send.ring, "Name of a ring")->required();
  command
      ->add_option("assignments", a.send.assignments, "name=value, optionally with a unit: 12.5mm")
      ->required();
  command->callback([&] { chosen = [&a] { return send(a.send); }; });
}

void add_ring(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
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

void add_stop(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand("stop", "End a run in order, with its report");
  command->add_option("ring", a.stopped, "Name of the run's ring")->required();
  command->callback([&] { chosen = [&a] { return stop(a.stopped); }; });
}

void add_doctor(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "doctor", "List the rings of this host and their faults, or the network's");
  command->add_option("--format", a.doctor.format)->check(CLI::IsMember({"text", "json"}));
  auto* domain =
      command
          ->add_option("--domain", a.doctor.domain,
                       "Examine the network: interfaces, gateways of this DDS domain, their clocks")
          ->check(CLI::Range(0, 230));
  command->add_option("--interface", a.doctor.interface, "As for the gateway of this host")
      ->needs(domain);
  command->add_option("--peer", a.doctor.peers, "As for the gateway of this host")
      ->take_all()
      ->allow_extra_args(false)
      ->needs(domain);
  command->callback([&] { chosen = [&a] { return doctor(a.doctor); }; });
}

void add_clean(CLI::App& app, RingCommandArguments& a, Chosen& chosen) {
  auto* command =
      app.add_subcommand("clean", "Remove rings that no running process uses, but keep idle cards");
  command->add_option("ring", a.removed, "Names of rings to remove, also with idle cards");
  command->callback([&] { chosen = [&a] { return clean(a.removed); }; });
}

}  // namespace

void add_ring_commands(CLI::App& app, RingCommandArguments& arguments, Chosen& chosen) {
  for (const auto add : {add_dump, add_who, add_watch, add_send, add_bridge, add_ring, add_fault,
                         add_stop, add_doctor, add_clean})
    add(app, arguments, chosen);
}

}  // namespace rths::app
