// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/command_line/program.hpp>
#include <rths/dds/network.hpp>

#include "doctor.hpp"

namespace rths::app {
namespace {

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

}  // namespace

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

}  // namespace rths::app
