// SPDX-License-Identifier: Apache-2.0
#include "assembly.hpp"
#include "host_words.hpp"
#include "script_placeholders.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/adapters/echo.hpp>
#include <rths/adapters/ideal_machine.hpp>
#include <rths/adapters/recorder.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/roles.hpp>

namespace rths::launch {
namespace {

constexpr std::uint32_t kPartitionAlignment = 16;  // longwords: one writer per cache line
constexpr double kRecorderOverhang = 0.2;          // [s]
constexpr NodeId kOperatorId{200};
constexpr std::uint16_t kFirstExtraNodeId = 201;  // for nodes that are not in the laboratory's map

std::unique_ptr<adapters::Adapter> make_echo(const memmap::Map& laboratory,
                                             adapters::EchoSettings settings) {
  settings.layout = adapters::opf_layout(laboratory);
  return adapters::make_echo(settings);
}

// Fills in the arguments of a script. Its log and motion file lie beside the recording.
void complete_script(const Experiment& e, const NodePlan& plan,
                     const std::filesystem::path& recording, adapters::OpenSeesScript& script) {
  const auto beside = [&](const std::string& ending) {
    return recording.parent_path() / (recording.stem().string() + "." + plan.node + ending);
  };
  script.log = beside(".log");
  const auto motion = beside(".motion.csv");
  for (auto& argument : script.command) {
    if (argument.find(kMotionPlaceholder) != std::string::npos)
      script.files = {{motion, text_of(e.motion)}};
    argument = filled_in(argument, e, motion);
  }
}

std::unique_ptr<adapters::Adapter> make_opensees(const Experiment& e, const memmap::Map& laboratory,
                                                 const NodePlan& plan, ClockKind clock,
                                                 const std::filesystem::path& recording) {
  adapters::OpenSeesSettings settings = *plan.opensees;
  settings.layout = adapters::opf_layout(laboratory);
  settings.simulation_step = e.simulation_step();
  settings.rest = e.rest;
  settings.wait_deadline = e.wait_deadline * e.rate;
  settings.stops_time = clock == ClockKind::Virtual;
  complete_script(e, plan, recording, settings.script);
  return adapters::make_opensees(settings);
}

std::unique_ptr<adapters::Adapter> make_opensees_specimen(const Experiment& e,
                                                          const memmap::Map& laboratory,
                                                          const NodePlan& plan, ClockKind clock,
                                                          const std::filesystem::path& recording) {
  adapters::OpenSeesSpecimenSettings settings = *plan.opensees_specimen;
  settings.layout = adapters::opf_layout(laboratory);
  settings.simulation_step = e.simulation_step();
  settings.stops_time = clock == ClockKind::Virtual;
  complete_script(e, plan, recording, settings.script);
  return adapters::make_opensees_specimen(settings);
}

std::map<std::string, std::string> units_of(const memmap::Map& map) {
  std::map<std::string, std::string> units;
  for (const auto& entry : map.signals()) units[entry.name] = entry.signal->unit;
  return units;
}

std::unique_ptr<adapters::Adapter> make_adapter(const Experiment& e, const memmap::Map& laboratory,
                                                const NodePlan& plan, ClockKind clock,
                                                const std::filesystem::path& recording) {
  if (plan.adapter == "srmd") {
    adapters::SrmdSettings settings;
    settings.machine = e.machine;
    settings.period = to_seconds(plan.schedule.period);
    settings.axes = e.axes;
    settings.retreat = e.retreat;
    return adapters::make_srmd(settings);
  }
  if (plan.adapter == "ideal_machine")
    return adapters::make_ideal_machine(
        {e.specimen, e.axes, e.integration_step, e.simulation_step()});
  if (plan.adapter == "echo") return make_echo(laboratory, *plan.echo);
  if (plan.adapter == "opensees_specimen")
    return make_opensees_specimen(e, laboratory, plan, clock, recording);
  if (plan.adapter == "simulink_like")
    return adapters::make_simulink_like(
        plan.diagram,
        {e.axes, e.integration_step, e.simulation_step(), e.retreat, units_of(laboratory)});
  // A given history needs no OpenSees: the numerical adapter imposes it.
  if (plan.adapter == "opensees" && !e.history)
    return make_opensees(e, laboratory, plan, clock, recording);
  adapters::NumericalSettings settings;
  settings.handshake = plan.opensees ? plan.opensees->handshake : plan.handshake;
  settings.axes = e.axes;
  settings.plant = e.plant;
  settings.motion = e.motion;
  settings.bearing_initial_stiffness = sim::initial_stiffness(e.model);
  settings.integration_step = e.integration_step;
  settings.alpha = e.alpha;
  settings.duration = e.duration;
  settings.rest = e.rest;
  // The deadline scales with the rate.
  settings.wait_deadline = e.wait_deadline * e.rate;
  if (clock == ClockKind::Virtual || e.model_computing_time)
    settings.computing_time = e.computing_time;
  settings.history = e.history;
  return adapters::make_numerical(settings);
}

void check_tuning(const NodePlan& plan, const std::vector<adapters::Port>& ports,
                  const Tuning& tuning) {
  std::vector<std::string> known;
  for (const auto& port : ports)
    if (port.direction == adapters::Direction::Parameter) known.push_back(port.name);
  for (const auto& [name, value] : tuning) {
    const auto port = std::find_if(ports.begin(), ports.end(), [&wanted = name](const auto& p) {
      return p.direction == adapters::Direction::Parameter && p.name == wanted;
    });
    if (port == ports.end())
      throw Error{fmt::format("node '{}' has no parameter '{}'{}", plan.node, name,
                              did_you_mean_one_of(name, known))};
    if (port->range && !(value >= port->range->first && value <= port->range->second))
      throw Error{fmt::format("node '{}': {} is {}, expected {} to {}", plan.node, name, value,
                              port->range->first, port->range->second)};
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
  check_tuning(plan, ports, plan.tune);
  check_tuning(plan, ports, plan.uncompensated);
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
  for (const auto& host : experiment.hosts) {
    append(launcher_partition(host.name), launcher_node(host.name), kLauncherLongwords).tear_group =
        true;
    std::vector<std::string> signals;
    for (const auto& plan : experiment.nodes)
      if (plan.host != host.name)
        signals.insert(signals.end(), {"age." + plan.node, "delay." + plan.node});
    for (const auto& other : experiment.hosts)
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
  if (experiment.hosts.empty()) return;
  for (const auto& plan : experiment.nodes) append(turn_partition(plan.node), plan.node, 1);
}

Duration recorder_period(const Experiment& experiment) {
  Duration period{0};
  for (const auto& plan : experiment.nodes)
    if (plan.adapter == "recorder") period = plan.schedule.period;
  return period;
}

std::map<std::string, double> steps_per_row(const Experiment& experiment) {
  std::map<std::string, double> result;
  const Duration row = recorder_period(experiment);
  for (const auto& plan : experiment.nodes)
    result[plan.node] = to_seconds(row) / to_seconds(plan.schedule.period);
  return result;
}

std::unique_ptr<adapters::Adapter> make_recorder(const Experiment& experiment, ClockKind clock,
                                                 const RecordingPlan& recording,
                                                 const memmap::Map& map) {
  adapters::RecorderSettings settings;
  settings.file = recording.file;
  settings.info = {experiment.config, recording.meta, steps_per_row(experiment)};
  settings.own_thread = clock == ClockKind::Wall;
  settings.period = to_seconds(recorder_period(experiment));
  // Records until the other nodes are at rest.
  settings.linger = experiment.retreat.hold + experiment.retreat.ramp + kRecorderOverhang;
  return adapters::make_recorder(map, settings);
}

}  // namespace

Assembly assemble(const Experiment& experiment, ClockKind clock, const RecordingPlan& recording) {
  const memmap::Map laboratory = memmap::load_map(experiment.map);
  auto description = laboratory.description();
  description.nodes.push_back({kOperator, kOperatorId, ""});
  std::vector<Station> stations;
  for (const auto& plan : experiment.nodes) {
    if (plan.foreign) {
      static_cast<void>(laboratory.node(plan.node));
      stations.push_back({plan, nullptr});
      continue;
    }
    // A recorder reads all signals, so it is built when the map is complete.
    const bool records = plan.adapter == "recorder";
    stations.push_back(
        {plan,
         records ? nullptr : make_adapter(experiment, laboratory, plan, clock, recording.file)});
    extend(description, plan,
           records ? adapters::recorder_monitors() : stations.back().adapter->ports());
  }
  extend_for_hosts(description, experiment);
  Assembly assembly{memmap::Map{std::move(description)}, std::move(stations)};
  recording::check_roles(experiment.roles, assembly.map);
  for (const auto& station : assembly.stations)
    if (station.adapter)
      adapters::check_ports(station.adapter->ports(), assembly.map, station.plan.node);
  for (auto& station : assembly.stations)
    if (!station.adapter && !station.plan.foreign)
      station.adapter = make_recorder(experiment, clock, recording, assembly.map);
  return assembly;
}

}  // namespace rths::launch
