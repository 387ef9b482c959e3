// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <arpa/inet.h>

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::experiment {
namespace {

// A part of the names of nodes and signals.
bool is_host_name(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(),
                                      [](char c) { return is_letter_or_digit(c) || c == '_'; });
}

bool is_ip_address(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

Network read_network(const Config& file) {
  Network network;
  const Config hosts = file.table_or_empty("host");
  for (const auto& name : hosts.keys()) {
    if (!is_host_name(name))
      hosts.fail(name,
                 fmt::format("the host's name is '{}', expected letters, digits and '_'", name));
    const Config table = hosts.table(name);
    HostPlan host{name, table.text("address", ""), table.text("interface", "")};
    if (host.interface.empty() && is_ip_address(host.address)) host.interface = host.address;
    table.reject_unknown_keys();
    network.hosts.push_back(std::move(host));
  }
  if (network.hosts.size() == 1)
    hosts.fail(network.hosts[0].name, "there is one host, expected none or at least two");
  std::sort(network.hosts.begin(), network.hosts.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  const Config table = file.table_or_empty("network");
  network.domain = static_cast<std::uint32_t>(table.integer_in("domain", 0, 230, 0));
  network.deadline = table.number_in("deadline_s", 0.1, 1e5, network.deadline);
  table.reject_unknown_keys();
  return network;
}

// Every node of a test on several hosts is on one of them.
void check_hosts(const Config& file, const Experiment& experiment) {
  const auto& hosts = experiment.network.hosts;
  std::vector<std::string> known;
  for (const auto& host : hosts) known.push_back(host.name);
  for (const auto& plan : experiment.nodes) {
    const Config table = file.table("node").table(plan.node);
    if (plan.host.empty() && !known.empty())
      throw Error{fmt::format("{}: node '{}' has no host, expected host = one of {}", table.where(),
                              plan.node, fmt::join(known, ", "))};
    if (!plan.host.empty() && !contains(known, plan.host))
      table.fail("host",
                 fmt::format("host is '{}', expected {}", plan.host,
                             known.empty() ? "a table [host." + plan.host + "]"
                                           : fmt::format("one of {}", fmt::join(known, ", "))));
  }
  const auto has_address = [](const HostPlan& host) { return !host.address.empty(); };
  const auto count = std::count_if(hosts.begin(), hosts.end(), has_address);
  if (count != 0 && count != static_cast<long>(known.size()))
    file.fail("host", fmt::format("{} of {} hosts have an address, expected all or none", count,
                                  known.size()));
}

}  // namespace

void read_ring(const Config& file, Experiment& experiment) {
  experiment.network = read_network(file);
  check_hosts(file, experiment);
  const std::string fidelity = file.text("fidelity", "shared");
  if (fidelity != "shared" && fidelity != "replicated")
    file.fail("fidelity", fmt::format("fidelity is '{}', expected shared or replicated", fidelity));
  const bool is_replicated = fidelity == "replicated";
  for (const char* key : {"cards", "fault"})
    if (file.has(key) && !is_replicated)
      file.fail(key,
                fmt::format("found {} on a shared ring, expected fidelity = \"replicated\"", key));
  if (!is_replicated) return;
  if (!experiment.network.hosts.empty())
    file.fail("fidelity", "fidelity is 'replicated', expected 'shared' on several hosts");
  experiment.cards = CardTables{file.table_or_empty("cards"), file.tables("fault")};
}

}  // namespace rths::experiment
