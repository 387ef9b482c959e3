// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/roles.hpp>

#include <sstream>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::recording {
namespace {

/// A role of an axis: its key, its member, and the SRMD's word with {c} and {a} for
/// controller and axis.
struct AxisRole {
  const char* key;
  std::string AxisRoles::*name;
  const char* usual;
};
constexpr AxisRole kAxisRoles[] = {
    {"target", &AxisRoles::target, "opf.{a}.displ.target"},
    {"command", &AxisRoles::command, "monitor.{c}.pc.command.{a}"},
    {"displacement", &AxisRoles::displacement, "monitor.{c}.displacement.out.{a}"},
    {"force", &AxisRoles::force, "monitor.{c}.observer.force.{a}"},
    {"reference", &AxisRoles::reference, "xpc.{a}.displ.ref"},
    {"reference_echo", &AxisRoles::reference_echo, "srmd.{a}.displ.ref_echo"},
    {"machine_displacement", &AxisRoles::machine_displacement, "srmd.{a}.displ.fbk"},
    {"machine_acceleration", &AxisRoles::machine_acceleration, "srmd.{a}.accel.fbk"},
    {"machine_force", &AxisRoles::machine_force, "srmd.{a}.force.fbk"},
    {"returned_displacement", &AxisRoles::returned_displacement, "daq.{a}.displ.fbk"},
    {"returned_force", &AxisRoles::returned_force, "daq.{a}.force.fbk"}};

/// A role of the run, with {c} as above.
struct RunRole {
  const char* key;
  std::string Roles::*name;
  const char* usual;
};
constexpr RunRole kSignalRoles[] = {
    {"new_target", &Roles::new_target, "opf.newTarget"},
    {"time", &Roles::time, "opf.1.time.target"},
    {"load", &Roles::load, "srmd.compression.force.fbk"},
    {"load_reference", &Roles::load_reference, "xpc.compression.force.ref"},
    {"vertical_force", &Roles::vertical_force, "srmd.vert.force.fbk"},
    {"vertical_command", &Roles::vertical_command, "monitor.{c}.vertical_load.out"},
    {"vertical_measured", &Roles::vertical_measured, "monitor.{c}.vertical_measured.out"}};

/// A role of a node, with the adapters that play it.
struct NodeRole {
  const char* key;
  std::string Roles::*name;
  const char* usual;
  std::vector<std::string> adapters;
};
const std::vector<NodeRole>& node_roles() {
  static const std::vector<NodeRole> roles{
      {"solver", &Roles::solver, "opf", {"numerical", "opensees"}},
      {"controller", &Roles::controller, "xpc", {"simulink_like"}},
      {"machine", &Roles::machine, "srmd", {"srmd"}}};
  return roles;
}

std::string filled_in(std::string name, const Roles& roles, const std::string& axis) {
  const auto replace = [&](const std::string& mark, const std::string& value) {
    if (const auto at = name.find(mark); at != std::string::npos)
      name.replace(at, mark.size(), value);
  };
  replace("{c}", roles.controller);
  replace("{a}", axis);
  return name;
}

}  // namespace

Config with_map_roles(const Config& experiment, const Config& map_roles) {
  Config merged = experiment;
  merged.set("roles", map_roles.overlaid(experiment.table_or_empty("roles")));
  return merged;
}

Roles read_roles(const Config& experiment) {
  const Config table = experiment.table_or_empty("roles");
  const Config nodes = experiment.table_or_empty("node");
  Roles roles;
  for (const auto& role : node_roles())
    roles.*role.name = table.text(role.key, node_with(nodes, role.adapters).value_or(role.usual));
  for (const auto& role : kSignalRoles)
    roles.*role.name = table.text(role.key, filled_in(role.usual, roles, ""));
  const auto tested = experiment.texts("axes", names_of(kHorizontal));
  for (const std::string& axis : names_of(kHorizontal)) {
    const Config own = table.table_or_empty(axis);
    AxisRoles names;
    names.axis = axis;
    for (const auto& role : kAxisRoles)
      names.*role.name = own.text(role.key, filled_in(role.usual, roles, axis));
    own.reject_unknown_keys();
    if (contains(tested, axis)) roles.axes.push_back(std::move(names));
  }
  table.reject_unknown_keys();
  return roles;
}

std::optional<std::string> node_with(const Config& nodes,
                                     const std::vector<std::string>& adapters) {
  for (const auto& name : nodes.keys())
    if (nodes.is_table(name) && contains(adapters, nodes.table(name).text("adapter", "")))
      return name;
  return std::nullopt;
}

void check_roles(const Config& roles, const memmap::Map& map) {
  const auto check = [&](const Config& table, const char* key) {
    if (!table.has(key)) return;
    static_cast<void>(table.placed(key, [&] { return map.signal(table.text(key)); }));
  };
  for (const auto& role : node_roles())
    if (roles.has(role.key))
      static_cast<void>(roles.placed(role.key, [&] { return map.node(roles.text(role.key)); }));
  for (const auto& role : kSignalRoles) check(roles, role.key);
  for (const std::string& axis : names_of(kHorizontal))
    for (const auto& role : kAxisRoles) check(roles.table_or_empty(axis), role.key);
}

std::vector<KeyValue> overrides_of(const Reader& run) {
  std::vector<KeyValue> changes;
  std::istringstream lines{run.config(kOverridesText)};
  for (std::string line; std::getline(lines, line);)
    if (auto change = key_value(line)) changes.push_back(std::move(*change));
  return changes;
}

std::string experiment_path(const Reader& run) {
  const auto meta = run.meta();
  const auto path = meta.find("experiment_path");
  return path == meta.end() ? "" : path->second;
}

std::optional<Config> recorded_experiment(const Reader& run) {
  const auto meta = run.meta();
  const auto name = meta.find("experiment");
  if (name == meta.end()) return std::nullopt;
  auto file = Config::parse(run.config(name->second), name->second);
  for (const auto& [key, value] : overrides_of(run)) file.set(key, value);
  return file;
}

std::optional<Config> experiment_in(const Reader& run) {
  const auto file = recorded_experiment(run);
  const std::string map_roles = run.config(kMapRolesText);
  if (!file || map_roles.empty()) return file;
  return with_map_roles(*file, Config::parse(map_roles, kMapRolesText));
}

Roles roles_of(const Reader& run) {
  const Config experiment = experiment_in(run).value_or(Config{});
  const auto nodes = experiment.table_or_empty("node").keys();
  Roles roles = read_roles(experiment);
  // A recording has all words of the map, also those of nodes that are not in the test.
  const auto is_written = [&](const std::string& name) {
    if (!run.has(name)) return false;
    const auto& writer = run.map().entry(run.map().signal(name)).partition->node;
    return contains(nodes, writer);
  };
  const auto replace = [&](std::string& name, const std::vector<std::string>& others) {
    if (is_written(name)) return;
    for (const auto& other : others)
      if (is_written(other)) {
        name = other;
        return;
      }
  };
  for (auto& axis : roles.axes) {
    replace(axis.command, {axis.target});
    replace(axis.displacement, {axis.machine_displacement, axis.returned_displacement});
    replace(axis.force, {axis.machine_force, axis.returned_force});
  }
  return roles;
}

}  // namespace rths::recording
