// SPDX-License-Identifier: Apache-2.0
#include "foreign_reading.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/fmi/fmu_files.hpp>
#include <rths/fmi/fmu_unit.hpp>
#include <rths/foreign/fmu.hpp>
#include <rths/foreign/opensees.hpp>
#include <rths/foreign/plugin.hpp>
#include <rths/foreign/program.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kDeadline = 60;  // of a run [s]
constexpr double kLongest = 86400;
constexpr std::int64_t kRuns = 20'000, kMostRuns = 10'000'000;

using Names = std::vector<std::string>;

// Roles by key, and the names that the simulation has for them. A table is left to its kind.
Names read_names(const Config& table, Names& roles) {
  Names names;
  for (const auto& role : table.keys()) {
    roles.push_back(role);
    names.push_back(table.is_table(role) ? role : table.text(role));
    if (names.back().empty()) table.fail(role, "the name is empty");
  }
  return names;
}

void check_columns(const Config& table, const Names& names) {
  for (const auto& role : table.keys())
    for (const auto& name : names)
      if (name == table.text(role) && name.find_first_of(",\"\n") != std::string::npos)
        table.fail(role, fmt::format("'{}' is no name of a column", name));
}

/// What the simulation itself states about a parameter.
struct KnownParameter {
  std::optional<double> value;
  std::string unit = "1";
};

ModelParameter read_parameter(const Config& all, const std::string& name,
                              const KnownParameter& known) {
  const Config table = all.table(name);
  const double value = known.value ? table.number("value", *known.value) : table.number("value");
  ModelParameter parameter{name, table.text("unit", known.unit), value, "parameter_error", {}, {}};
  if (table.has("bounds")) {
    const auto bounds = table.numbers("bounds");
    if (bounds.size() != 2 || !(bounds[0] < bounds[1]) || !(value >= bounds[0]) ||
        !(value <= bounds[1]))
      table.fail("bounds", "expected [low, high] around the value");
    parameter.bounds = {bounds[0], bounds[1]};
  }
  if (table.has("step")) parameter.step = table.number_in("step", 1e-100, 1e100);
  table.reject_unknown_keys();
  return parameter;
}

/// Reads what all kinds have, then the simulation of a kind.
class ForeignReader {
 public:
  explicit ForeignReader(const Model& model) : model_{model}, table_{model.table} {}

  ForeignReading read() {
    inputs_ = read_names(table_.table_or_empty("inputs"), found_.inputs);
    outputs_ = read_names(table_.table("outputs"), found_.outputs);
    if (outputs_.empty()) table_.fail("outputs", "the table is empty, expected an output");
    found_.most_runs =
        static_cast<std::size_t>(table_.integer_in("most_runs", 2, kMostRuns, kRuns));
    deadline_ = table_.number_in("deadline_s", 1e-3, kLongest, kDeadline);
    take({"inputs", "outputs", "parameters", "most_runs", "deadline_s"});
    if (model_.kind == ModelKind::Fmu) read_fmu();
    if (model_.kind == ModelKind::OpenSees) read_opensees();
    if (model_.kind == ModelKind::Plugin) read_plugin();
    if (model_.kind == ModelKind::Program) read_program();
    found_.rest = table_;
    for (const auto& key : taken_) found_.rest = found_.rest.without(key);
    return std::move(found_);
  }

 private:
  void take(const Names& keys) { taken_.insert(taken_.end(), keys.begin(), keys.end()); }

  // @param known  of a parameter's name
  template <class Known>
  Names read_parameters(const Known& known) {
    const Config all = table_.table_or_empty("parameters");
    for (const auto& name : all.keys())
      found_.parameters.push_back(
          read_parameter(all, name, all.placed(name, [&] { return known(name); })));
    return all.keys();
  }

  void read_program() {
    take({"command"});
    check_columns(table_.table_or_empty("inputs"), inputs_);
    check_columns(table_.table("outputs"), outputs_);
    foreign::ProgramSettings settings{
        table_.texts("command"), table_.resolve("."), inputs_, outputs_, {}, deadline_};
    settings.parameters = read_parameters([](const auto&) { return KnownParameter{}; });
    found_.simulation =
        table_.placed("command", [&] { return foreign::make_program(std::move(settings)); });
  }

  void read_opensees() {
    take({"script", "arguments", "python", "files", "function"});
    foreign::OpenSeesRunSettings settings;
    settings.python = table_.text("python", foreign::opensees_python());
    settings.script = table_.resolve(table_.text("script"));
    if (!std::filesystem::is_regular_file(settings.script))
      table_.fail("script", settings.script.string() + " is not a file");
    settings.arguments = table_.texts("arguments", {});
    for (const auto& file : table_.texts("files", {})) {
      settings.files.push_back(table_.resolve(file));
      if (!std::filesystem::exists(settings.files.back()))
        table_.fail("files", settings.files.back().string() + " does not exist");
    }
    settings.function = table_.text("function", "");
    settings.inputs = inputs_;
    settings.outputs = outputs_;
    settings.deadline = deadline_;
    settings.parameters = read_parameters([](const auto&) { return KnownParameter{}; });
    const Config outputs = table_.table("outputs");
    for (const auto& role : outputs.keys()) {
      if (!outputs.is_table(role)) continue;
      const Config one = outputs.table(role);
      settings.recorded.push_back(
          {one.text("file"), static_cast<std::size_t>(one.integer_in("column", 1, 1'000'000, 1)),
           one.number("factor", 1)});
      one.reject_unknown_keys();
    }
    if (!settings.recorded.empty() && settings.recorded.size() != outputs_.size())
      table_.fail("outputs", "some are tables, expected all or none");
    found_.simulation =
        table_.placed("script", [&] { return foreign::make_opensees(std::move(settings)); });
  }

  void read_fmu() {
    take({"file", "start", "step_s", "port"});
    foreign::FmuSettings settings;
    settings.file = table_.resolve(table_.text("file"));
    settings.inputs = inputs_;
    settings.outputs = outputs_;
    settings.step = table_.number_in("step_s", 1e-9, kLongest, 0);
    settings.holds_inputs = table_.text("hold", "") == "zero";
    settings.deadline = deadline_;
    const auto description =
        table_.placed("file", [&] { return fmi::read_description(settings.file); });
    settings.parameters = read_parameters([&](const std::string& name) {
      const fmi::Variable* variable = description.find(name);
      if (variable == nullptr) return KnownParameter{};
      return KnownParameter{variable->start, variable->unit.empty() ? "1" : variable->unit};
    });
    read_connections([&](const std::string& name) { return unit_of(description, name); }, settings);
    found_.simulation =
        table_.placed("file", [&] { return foreign::make_fmu(std::move(settings)); });
  }

  void read_plugin() {
    take({"file", "config", "start", "step_s", "port"});
    foreign::PluginRunSettings settings;
    settings.file = std::filesystem::absolute(table_.resolve(table_.text("file")));
    if (!std::filesystem::is_regular_file(settings.file))
      table_.fail("file", settings.file.string() + " is not a file");
    const Config config = table_.table_or_empty("config");
    settings.config = config.to_toml();
    settings.inputs = inputs_;
    settings.outputs = outputs_;
    settings.step = table_.number_in("step_s", 1e-9, kLongest, 0);
    settings.holds_inputs = table_.text("hold", "") == "zero";
    settings.deadline = deadline_;
    const auto signals = table_.placed(
        "file", [&] { return foreign::plugin_signals(settings.file, settings.config, deadline_); });
    const auto found = [&](const std::string& name) {
      return std::find_if(signals.begin(), signals.end(),
                          [&](const auto& signal) { return signal.name == name; });
    };
    settings.parameters = read_parameters([&](const std::string& name) {
      const auto signal = found(name);
      return signal == signals.end() ? KnownParameter{}
                                     : KnownParameter{signal->initial, signal->unit};
    });
    read_connections(
        [&](const std::string& name) {
          const auto signal = found(name);
          return signal == signals.end() ? std::string{} : signal->unit;
        },
        settings);
    found_.simulation =
        table_.placed("file", [&] { return foreign::make_plugin(std::move(settings), signals); });
  }

  static std::string unit_of(const fmi::ModelDescription& description, const std::string& name) {
    const fmi::Variable* variable = description.find(name);
    return variable == nullptr || variable->unit.empty()
               ? ""
               : fmi::si_unit_of(description, *variable).name;
  }

  // Start values, units of outputs, and ports. @param unit_of  a variable, SI; empty: not known
  template <class UnitOf, class Settings>
  void read_connections(const UnitOf& unit_of, Settings& settings) {
    const Config start = table_.table_or_empty("start");
    for (const auto& name : start.keys()) settings.start.emplace_back(name, start.number(name));
    for (const auto& output : settings.outputs) found_.units.push_back(unit_of(output));
    const Config ports = table_.table_or_empty("port");
    for (const auto& name : ports.keys()) {
      const Config table = ports.table(name);
      typename decltype(settings.ports)::value_type port;
      port.displacement = table.text("displacement");
      port.velocity = table.text("velocity", "");
      std::string velocity = port.velocity;
      if constexpr (requires { port.state; }) {
        port.force = table.text("force", "");
        port.state = table.text("state", "");
        if (port.force.empty() == port.state.empty())
          ports.fail(name, "expected one of force and state");
        if (velocity.empty()) velocity = port.state;
      } else {
        port.force = table.text("force");
      }
      table.reject_unknown_keys();
      ForeignPort found{"port." + name,
                        add_motion(name, "displacement", port.displacement, settings),
                        "",
                        "",
                        "",
                        {}};
      found.displacement_unit = unit_of(port.displacement);
      if (!velocity.empty()) {
        found.velocity = add_motion(name, "velocity", velocity, settings);
        found.velocity_unit = unit_of(velocity);
      }
      const auto like = std::find(inputs_.begin(), inputs_.end(), port.force);
      if (like != inputs_.end())
        found.like = found_.inputs[static_cast<std::size_t>(like - inputs_.begin())];
      found_.ports.push_back(std::move(found));
      settings.ports.push_back(std::move(port));
    }
  }
  template <class Settings>
  static std::string add_motion(const std::string& port, const char* quantity,
                                const std::string& variable, Settings& settings) {
    settings.outputs.push_back(variable);
    return fmt::format("auxiliary.port.{}.{}", port, quantity);
  }

  const Model& model_;
  const Config& table_;
  ForeignReading found_;
  Names inputs_, outputs_;  // in the simulation
  double deadline_ = 0;
  Names taken_;
};

}  // namespace

ForeignReading read_foreign_table(const Model& model) { return ForeignReader{model}.read(); }

}  // namespace rths::diagnosis
