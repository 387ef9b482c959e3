// SPDX-License-Identifier: Apache-2.0
#include "run_modes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/roles.hpp>

namespace rths::launch {
namespace {

constexpr std::uint32_t kPartitionAlignment = 16;  // longwords: one writer per cache line
constexpr NodeId kOperatorId{200};
constexpr std::uint16_t kFirstExtraNodeId = 201;  // for nodes that are not in the laboratory's map

void check_tuning(const std::string& place, const NodePlan& plan,
                  const std::vector<adapters::Port>& ports, const Tuning& tuning) {
  std::vector<std::string> known;
  for (const auto& port : ports)
    if (port.direction == adapters::Direction::Parameter) known.push_back(port.name);
  for (const auto& [name, value] : tuning) {
    const auto port = std::find_if(ports.begin(), ports.end(), [&wanted = name](const auto& p) {
      return p.direction == adapters::Direction::Parameter && p.name == wanted;
    });
    if (port == ports.end())
      throw Error{fmt::format("{}node '{}' has no parameter '{}'{}", place, plan.node, name,
                              did_you_mean_one_of(name, known))};
    if (port->range && !(value >= port->range->first && value <= port->range->second))
      throw Error{fmt::format("{}node '{}': {} is {}, expected {} to {}", place, plan.node, name,
                              value, port->range->first, port->range->second)};
  }
}

memmap::Signal signal_for(const adapters::Port& port, const NodePlan& plan) {
  memmap::Signal signal;
  signal.name = port.name;
  signal.unit = port.unit;
  signal.event = port.event || port.direction == adapters::Direction::Parameter;
  signal.initial = port.initial;
  signal.range = port.range;
  for (const auto& [name, value] : plan.tune)
    if (name == port.name) signal.initial = value;
  return signal;
}

std::uint32_t first_free(const memmap::MapDescription& description) {
  std::uint32_t end = 0;
  for (const auto& partition : description.partitions)
    end = std::max(end, partition.base.value() + partition.longwords);
  return (end + kPartitionAlignment - 1) / kPartitionAlignment * kPartitionAlignment;
}

// Appends a partition for the ports of one direction.
void append_partition(memmap::MapDescription& description, const std::string& name,
                      const std::string& writer, adapters::Direction direction,
                      const std::vector<adapters::Port>& ports, const NodePlan& plan) {
  memmap::Partition partition;
  partition.name = name;
  partition.node = writer;
  partition.base = LongwordOffset{first_free(description)};
  partition.tear_group = direction == adapters::Direction::Monitor;
  for (const auto& port : ports) {
    if (port.direction != direction) continue;
    partition.signals.push_back(signal_for(port, plan));
    partition.signals.back().offset = advance(partition.base, partition.longwords++);
  }
  if (partition.longwords > 0) description.partitions.push_back(std::move(partition));
}

void add_node(memmap::MapDescription& description, const std::string& name) {
  const auto& nodes = description.nodes;
  if (std::any_of(nodes.begin(), nodes.end(), [&](const auto& n) { return n.name == name; }))
    return;
  const auto extra = static_cast<std::uint16_t>(std::count_if(
      nodes.begin(), nodes.end(), [](const auto& n) { return n.id.value() >= kFirstExtraNodeId; }));
  description.nodes.push_back(
      {name, NodeId{static_cast<std::uint16_t>(kFirstExtraNodeId + extra)}, ""});
}

void extend(memmap::MapDescription& description, const NodePlan& plan,
            const std::vector<adapters::Port>& adapter_ports) {
  auto ports = adapters::runner_ports();
  ports.insert(ports.end(), adapter_ports.begin(), adapter_ports.end());
  check_tuning("", plan, ports, plan.tune);
  check_tuning("[uncompensated]: ", plan, ports, plan.uncompensated);
  add_node(description, plan.node);
  append_partition(description, "monitor." + plan.node, plan.node, adapters::Direction::Monitor,
                   ports, plan);
  append_partition(description, "tune." + plan.node, kOperator, adapters::Direction::Parameter,
                   ports, plan);
}

// Words of the gateways and launchers of a test on several hosts, and of its order in virtual time.
void extend_for_hosts(memmap::MapDescription& description, const Experiment& experiment) {
  const auto append = [&](const std::string& name, const std::string& node,
                          std::uint32_t longwords) -> memmap::Partition& {
    add_node(description, node);
    memmap::Partition partition;
    partition.name = name;
    partition.node = node;
    partition.base = LongwordOffset{first_free(description)};
    partition.longwords = longwords;
    return description.partitions.emplace_back(std::move(partition));
  };
  for (const auto& host : experiment.network.hosts) {
    append(launcher_partition(host.name), launcher_node(host.name), kLauncherLongwords).tear_group =
        true;
    std::vector<std::string> signals;
    for (const auto& plan : experiment.nodes)
      if (plan.host != host.name)
        signals.insert(signals.end(), {"age." + plan.node, "delay." + plan.node});
    for (const auto& other : experiment.network.hosts)
      if (other.name != host.name)
        signals.insert(signals.end(), {"clock_offset." + other.name, "clock_error." + other.name});
    auto& partition = append("gateway." + host.name, "gateway_" + host.name,
                             static_cast<std::uint32_t>(signals.size()));
    for (std::uint32_t i = 0; i < signals.size(); ++i) {
      memmap::Signal signal;
      signal.name = signals[i];
      signal.unit = "s";
      signal.offset = advance(partition.base, i);
      partition.signals.push_back(std::move(signal));
    }
  }
  if (experiment.network.hosts.empty()) return;
  for (const auto& plan : experiment.nodes) append(turn_partition(plan.node), plan.node, 1);
}

experiment::NodeContext context_of(const Experiment& experiment, const NodePlan& plan,
                                   ClockKind clock, const RecordingPlan& recording,
                                   const memmap::Map& map) {
  experiment::NodeContext context{plan.node,
                                  plan.schedule.period,
                                  clock == ClockKind::Virtual,
                                  recording.file,
                                  map,
                                  recording.texts,
                                  recording.meta,
                                  {},
                                  {}};
  for (const auto& other : experiment.nodes) {
    context.periods[other.node] = other.schedule.period;
    const experiment::Role role = other.settings.role;
    const bool moves_machine =
        role == experiment::Role::Solver || role == experiment::Role::Controller;
    if (moves_machine && !other.settings.program && other.node != plan.node)
      context.watched.push_back(other.node);
  }
  return context;
}

std::optional<replicated::CardOptions> cards_of(const Experiment& experiment) {
  if (!experiment.cards) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& plan : experiment.nodes) names.push_back(plan.node);
  auto cards = replicated::read_cards(experiment.cards->cards, experiment.cards->faults, names);
  cards.seed = experiment.seed;
  return cards;
}

}  // namespace

Assembly assemble(const Experiment& experiment, ClockKind clock, const RecordingPlan& recording) {
  const memmap::Map laboratory = memmap::load_map(experiment.map);
  auto description = laboratory.description();
  description.nodes.push_back({kOperator, kOperatorId, ""});
  std::vector<Station> stations;
  for (const auto& plan : experiment.nodes) {
    const auto& settings = plan.settings;
    stations.push_back({plan, nullptr});
    if (settings.program) {
      static_cast<void>(laboratory.node(plan.node));  // its words are those of the map
      continue;
    }
    if (!settings.monitors)
      stations.back().adapter =
          settings.make(experiment, context_of(experiment, plan, clock, recording, laboratory));
    extend(description, plan,
           settings.monitors ? settings.monitors() : stations.back().adapter->ports());
  }
  extend_for_hosts(description, experiment);
  Assembly assembly{memmap::Map{std::move(description)}, std::move(stations), cards_of(experiment)};
  recording::check_roles(experiment.role_table, assembly.map);
  for (const auto& station : assembly.stations)
    if (station.adapter)
      adapters::check_ports(station.adapter->ports(), assembly.map, station.plan.node);
  for (auto& station : assembly.stations)
    if (!station.adapter && !station.plan.settings.program)
      station.adapter = station.plan.settings.make(
          experiment, context_of(experiment, station.plan, clock, recording, assembly.map));
  return assembly;
}

}  // namespace rths::launch
