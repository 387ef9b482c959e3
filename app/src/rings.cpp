// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/dds/network.hpp>
#include <rths/launch/run.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct DoctorArguments {
  std::string format = "text";          ///< text or json: a line per ring, and one about real time
  std::optional<std::uint32_t> domain;  ///< of DDS: examines the network instead
  std::string interface;
  std::vector<std::string> peers;
};

using Json = nlohmann::ordered_json;

constexpr Duration kListening = std::chrono::seconds{2};
constexpr Duration kWrongClock = std::chrono::seconds{1};
constexpr int kUsualMtu = 1500;  // of Ethernet [B]

std::string describe(const dds::Interface& interface) {
  std::string text =
      fmt::format("  {:<12} {:<16} {}, {}, MTU {}", interface.name, interface.address,
                  interface.is_up ? "up" : "down",
                  interface.has_multicast ? "multicast" : "no multicast", interface.mtu);
  if (interface.mtu > 0 && interface.mtu < kUsualMtu)
    text += fmt::format("; smaller than {}: frames travel in more pieces", kUsualMtu);
  return text + "\n";
}

std::string describe(const dds::FoundGateway& gateway) {
  const auto& host = gateway.host;
  std::string text = fmt::format("  host '{}': {} nodes, map {}", host.name, gateway.nodes,
                                 memmap::hash_text(gateway.map_hash));
  if (!host.clock)
    return text + "; it does not answer: its packets arrive here, ours do not arrive there\n";
  text += fmt::format(", clock known to {:.3f} ms", 1e3 * to_seconds(host.clock->error));
  if (std::chrono::abs(host.real_time_ahead) > kWrongClock)
    text += fmt::format("; its calendar clock is {:.1f} s {}: start chrony or PTP on both hosts",
                        std::abs(to_seconds(host.real_time_ahead)),
                        host.real_time_ahead > Duration{0} ? "ahead" : "behind");
  return text + "\n";
}

// Ports as the DDSI-RTPS specification (section 9.6.1) derives them from the domain.
std::string advice(std::uint32_t domain) {
  const std::uint32_t first = 7400 + 250 * domain;
  return fmt::format(
      "no gateway answered within {:.0f} s. Check on the other host:\n"
      "  a gateway runs with --domain {}, on an interface of the same network (--interface)\n"
      "  no firewall blocks the UDP ports {} to {}\n"
      "  the network carries multicast; if not, name the hosts to each other with --peer\n",
      2 * to_seconds(kListening), domain, first, first + 249);
}

Json document(const std::vector<dds::Interface>& interfaces, const dds::FoundDomain& found) {
  Json json = {
      {"interfaces", Json::array()}, {"gateways", Json::array()}, {"faults", found.faults}};
  for (const auto& one : interfaces)
    json["interfaces"].push_back({{"name", one.name},
                                  {"address", one.address},
                                  {"up", one.is_up},
                                  {"multicast", one.has_multicast},
                                  {"mtu", one.mtu}});
  for (const auto& one : found.gateways) {
    Json gateway = {{"host", one.host.name},
                    {"map_hash", memmap::hash_text(one.map_hash)},
                    {"nodes", one.nodes},
                    {"answers", one.host.clock.has_value()}};
    if (one.host.clock) {
      gateway["clock_offset_s"] = to_seconds(one.host.clock->offset);
      gateway["clock_error_s"] = to_seconds(one.host.clock->error);
      gateway["calendar_ahead_s"] = to_seconds(one.host.real_time_ahead);
    }
    json["gateways"].push_back(std::move(gateway));
  }
  return json;
}

/// Interfaces of this host, gateways of the domain and their clocks; advice.
/// @returns 0 if a gateway answered, otherwise 1
int doctor_of_network(const DoctorArguments& arguments) {
  dds::CycloneOptions network;
  network.domain = *arguments.domain;
  network.interface = arguments.interface;
  network.peers = arguments.peers;
  const auto interfaces = dds::interfaces();
  const auto found = dds::listen_for_gateways(network, kListening);
  const bool is_any = !found.gateways.empty();
  const int code = is_any && found.faults.empty() ? kOk : kConditionNotMet;
  if (arguments.format == "json") {
    fmt::print("{}\n", document(interfaces, found).dump());
    return code;
  }
  fmt::print("interfaces:\n");
  for (const auto& interface : interfaces) fmt::print("{}", describe(interface));
  if (is_any) fmt::print("gateways in domain {}:\n", network.domain);
  for (const auto& gateway : found.gateways) fmt::print("{}", describe(gateway));
  if (!found.faults.empty()) fmt::print("faults:\n");
  for (const auto& fault : found.faults) fmt::print("  {}\n", fault);
  if (!is_any) fmt::print("{}", advice(network.domain));
  return code;
}

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

int stop(const std::string& ring) {
  fmt::print("process {} ends the run on ring '{}'\n", launch::request_stop(ring), ring);
  return kOk;
}

}  // namespace

void add_doctor(CommandLine& line) {
  auto [command, a] =
      line.add("doctor", "List the rings of this host and their faults, or the network's", doctor);
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "json"}));
  auto* domain =
      command
          ->add_option("--domain", a.domain,
                       "Examine the network: interfaces, gateways of this DDS domain, their clocks")
          ->check(CLI::Range(0, 230));
  command->add_option("--interface", a.interface, "As for the gateway of this host")->needs(domain);
  repeatable(command->add_option("--peer", a.peers, "As for the gateway of this host"))
      ->needs(domain);
}

void add_clean(CommandLine& line) {
  auto [command, a] =
      line.add("clean", "Remove rings that no running process uses, but keep idle cards", clean);
  command->add_option("ring", a, "Names of rings to remove, also with idle cards");
}

void add_stop(CommandLine& line) {
  auto [command, a] = line.add("stop", "End a run in order, with its report", stop);
  command->add_option("ring", a, "Name of the run's ring")->required();
}

}  // namespace rths::app
