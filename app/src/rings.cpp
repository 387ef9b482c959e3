// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/launch/run.hpp>

#include "command.hpp"
#include "commands.hpp"
#include "doctor.hpp"

namespace rths::app {
namespace {

using Json = nlohmann::ordered_json;

std::string cards_of(const broker::RingReport& ring) {
  return fmt::format("memory and registers of {} {}", ring.cards,
                     ring.cards == 1 ? "card" : "cards");
}

void describe(const broker::RingReport& ring) {
  if (!ring.usable) {
    fmt::print("{}: {} bytes: {}\n", printable(ring.name), ring.bytes, ring.trouble);
    return;
  }
  fmt::print("{}: {} bytes, map '{}' version {} {}\n", ring.name, ring.bytes, ring.map_name,
             ring.map_version, ring.map_hash);
  for (const auto& occupant : ring.occupants)
    fmt::print("  {:<12} {:<16} {} ({} heartbeats)\n", occupant.node, occupant.process,
               occupant.alive ? "alive" : "ended without leaving; its slot is free",
               occupant.beats);
  for (const auto& group : ring.torn_groups)
    fmt::print(
        "  partition '{}' has an unfinished write; readers get the last complete one, and the next "
        "node of the same name repairs it\n",
        group);
  if (ring.in_use()) return;
  if (ring.is_of_cards())
    fmt::print("  no process uses it; it keeps {}; 'rths clean {}' removes it\n", cards_of(ring),
               ring.name);
  else
    fmt::print("  no process uses it; 'rths clean' removes it\n");
}

Json json_of(const broker::RingReport& ring) {
  Json json = {{"ring", ring.name},
               {"bytes", ring.bytes},
               {"usable", ring.usable},
               {"in_use", ring.in_use()},
               {"cards", ring.cards}};
  if (!ring.usable) {
    json["trouble"] = ring.trouble;
    return json;
  }
  json["map"] = ring.map_name;
  json["map_version"] = ring.map_version;
  json["map_hash"] = ring.map_hash;
  json["processes"] = Json::array();
  for (const auto& occupant : ring.occupants)
    json["processes"].push_back({{"node", occupant.node},
                                 {"pid", occupant.pid},
                                 {"of_this_pid_namespace", occupant.has_pid_here},
                                 {"alive", occupant.alive},
                                 {"heartbeats", occupant.beats}});
  json["torn_groups"] = ring.torn_groups;
  return json;
}

/// Removes an unused ring, or prints why not. @returns whether it is removed
bool remove(const broker::RingReport& ring) {
  const bool removed = !ring.foreign && broker::remove_unused_ring(ring.name);
  if (removed)
    fmt::print("removed {}\n", printable(ring.name));
  else
    fmt::print("kept {}: {}\n", printable(ring.name),
               ring.in_use()  ? "processes use it"
               : ring.foreign ? ring.trouble
                              : "cannot be removed");
  return removed;
}

bool remove_named(const std::vector<std::string>& names) {
  bool all = true;
  for (const auto& name : names) {
    const auto ring = broker::inspect_ring(name);
    if (!ring) throw Error{fmt::format("there is no ring '{}'", name)};
    all = remove(*ring) && all;
  }
  return all;
}

bool remove_unused() {
  bool all = true;
  for (const auto& ring : broker::list_rings()) {
    if (ring.in_use()) continue;
    if (!ring.other_user.empty())
      fmt::print("skipped {}: {}\n", printable(ring.name), ring.trouble);
    else if (ring.is_of_cards())
      fmt::print("kept {}: {}; 'rths clean {}' removes it\n", ring.name, cards_of(ring), ring.name);
    else
      all = remove(ring) && all;
  }
  return all;
}

int doctor(const DoctorArguments& arguments) {
  if (arguments.domain) return doctor_of_network(arguments);
  const std::string& format = arguments.format;
  const auto rings = broker::list_rings();
  const bool as_json = format == "json";
  bool any_unused = false;
  for (const auto& ring : rings) {
    if (as_json)
      fmt::print("{}\n", json_of(ring).dump());
    else
      describe(ring);
    any_unused = any_unused || !(ring.in_use() || ring.is_of_cards() || !ring.other_user.empty());
  }
  const std::string missing = launch::missing_privileges();
  if (as_json) {
    fmt::print("{}\n", Json{{"real_time", missing.empty()}, {"missing", missing}}.dump());
    return any_unused ? kConditionNotMet : kOk;
  }
  if (rings.empty()) fmt::print("no rings\n");
  fmt::print("real time: {}\n",
             missing.empty() ? "scheduling and memory locking are available" : missing);
  return any_unused ? kConditionNotMet : kOk;
}

int clean(const std::vector<std::string>& rings) {
  const bool all = rings.empty() ? remove_unused() : remove_named(rings);
  return all ? kOk : kConditionNotMet;
}

}  // namespace

void add_doctor(CommandLine& line) {
  auto& a = line.values<DoctorArguments>();
  auto* command = line.app.add_subcommand(
      "doctor", "List the rings of this host and their faults, or the network's");
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "json"}));
  auto* domain =
      command
          ->add_option("--domain", a.domain,
                       "Examine the network: interfaces, gateways of this DDS domain, their clocks")
          ->check(CLI::Range(0, 230));
  command->add_option("--interface", a.interface, "As for the gateway of this host")->needs(domain);
  repeatable(command->add_option("--peer", a.peers, "As for the gateway of this host"))
      ->needs(domain);
  command->callback([&] { line.chosen = [&a] { return doctor(a); }; });
}

void add_clean(CommandLine& line) {
  auto& a = line.values<std::vector<std::string>>();
  auto* command = line.app.add_subcommand(
      "clean", "Remove rings that no running process uses, but keep idle cards");
  command->add_option("ring", a, "Names of rings to remove, also with idle cards");
  command->callback([&] { line.chosen = [&a] { return clean(a); }; });
}

}  // namespace rths::app
