// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths_adapter.h>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/fmi/fmu_unit.hpp>
#include <rths/memmap/units.hpp>

namespace rths::fmi {
namespace {

const Variable& variable_of(const ModelDescription& description, const Config& table,
                            const std::string& key, const std::string& name) {
  if (const Variable* variable = description.find(name)) return *variable;
  std::vector<std::string> names;
  for (const auto& variable : description.variables) names.push_back(variable.name);
  table.fail(key, fmt::format("the FMU has no variable '{}'{}", name, did_you_mean(name, names)));
}

// Why no signal or start value can be bound to a variable; empty: it can.
std::string refusal_of(const Variable& variable) {
  if (variable.is_array) return fmt::format("'{}' is an array, expected a scalar", variable.name);
  if (variable.type == Type::Other)
    return fmt::format("'{}' is of type {}, expected a number or a Boolean", variable.name,
                       variable.type_name);
  if (variable.is_clocked)
    return fmt::format("'{}' belongs to a clock, which is not supported", variable.name);
  return "";
}

bool is_signal_name(const std::string& name) {
  const auto allowed = [](char c) { return is_letter_or_digit(c) || c == '_' || c == '.'; };
  return !name.empty() && name.front() != '.' && name.back() != '.' &&
         std::all_of(name.begin(), name.end(), allowed);
}

/// Reads the tables of a node, each of which names variables.
class BindingReader {
 public:
  BindingReader(const ModelDescription& description, const Config& table)
      : description_{description},
        table_{table},
        signals_{table.table_or_empty("signals")},
        units_{table.table_or_empty("units")},
        start_{table.table_or_empty("start")} {}

  Bindings read(bool is_complete) {
    read_start();
    for (const auto& name : signals_.keys()) check_signal(name);
    for (const auto& name : units_.keys()) check_unit(name);
    for (const auto& variable : description_.variables) add_variable(variable, is_complete);
    add_tunable();
    mark_ramped(is_complete);
    const auto is_flag = [](const Binding& b) { return b.unit == "1"; };
    std::stable_sort(all_.signals.begin(), all_.signals.end(), [&](const auto& a, const auto& b) {
      return rank(a, is_flag(a)) < rank(b, is_flag(b));
    });
    return std::move(all_);
  }

 private:
  static int rank(const Binding& binding, bool is_flag) {
    if (binding.direction == RTHS_INPUT) return is_flag ? 0 : 1;
    if (binding.direction == RTHS_PARAMETER) return 2;
    if (binding.direction == RTHS_MONITOR) return 3;
    return is_flag ? 5 : 4;
  }

  void read_start() {
    for (const auto& name : start_.keys()) {
      const Variable& variable = variable_of(description_, start_, name, name);
      if (const auto refusal = refusal_of(variable); !refusal.empty()) start_.fail(name, refusal);
      if (variable.causality != "parameter" && variable.causality != "input")
        start_.fail(name, fmt::format("'{}' has causality {}, expected parameter or input", name,
                                      variable.causality));
      const double value = variable.type == Type::Boolean
                               ? static_cast<double>(start_.flag(name, false))
                               : start_.number(name);
      if ((variable.lowest && value < *variable.lowest) ||
          (variable.highest && value > *variable.highest))
        start_.fail(
            name, fmt::format("{} is {:g}, the FMU allows {:g} to {:g}", name, value,
                              variable.lowest.value_or(-1e300), variable.highest.value_or(1e300)));
      all_.start.emplace_back(&variable, value);
    }
  }

  void check_signal(const std::string& name) const {
    const Variable& variable = variable_of(description_, signals_, name, name);
    static_cast<void>(signals_.text(name));
    if (const auto refusal = refusal_of(variable); !refusal.empty()) signals_.fail(name, refusal);
    if (variable.causality != "input" && variable.causality != "output")
      signals_.fail(name, fmt::format("'{}' has causality {}, expected input or output", name,
                                      variable.causality));
  }

  void check_unit(const std::string& name) const {
    const Variable& variable = variable_of(description_, units_, name, name);
    static_cast<void>(units_.placed(name, [&] { return memmap::parse_unit(units_.text(name)); }));
    if (!variable.is_real())
      units_.fail(name,
                  fmt::format("'{}' is of type {}, which has no unit", name, variable.type_name));
    if (!variable.unit.empty())
      units_.fail(name, fmt::format("the FMU states [{}] for '{}', expected no other unit here",
                                    variable.unit, name));
  }

  Binding binding_of(const Variable& variable) const {
    Binding binding{&variable, variable.name, RTHS_MONITOR, false, "1", {}};
    if (!units_.has(variable.name)) {
      const SiUnit unit = si_unit_of(description_, variable);
      binding.unit = unit.name;
      binding.conversion = unit.conversion;
      return binding;
    }
    const auto unit = memmap::parse_unit(units_.text(variable.name));
    binding.unit = unit.si;
    binding.conversion = {unit.scale, unit.offset};
    return binding;
  }

  void add_variable(const Variable& variable, bool is_complete) {
    const bool is_input = variable.causality == "input";
    if (!is_input && variable.causality != "output") return;
    if (!refusal_of(variable).empty()) return;  // it keeps its start value
    if (signals_.has(variable.name)) {
      Binding binding = binding_of(variable);
      binding.signal = signals_.text(variable.name);
      binding.direction = is_input ? RTHS_INPUT : RTHS_OUTPUT;
      all_.signals.push_back(std::move(binding));
    } else if (is_input) {
      if (is_complete && !start_.has(variable.name))
        throw Error{
            fmt::format("{}: input '{}' has no signal, expected one in [signals] or a "
                        "value in [start]",
                        table_.where(), variable.name)};
    } else if (is_signal_name(variable.name)) {
      all_.signals.push_back(binding_of(variable));
    }
  }

  void add_tunable() {
    for (const auto& name : table_.texts("tunable", {})) {
      const Variable& variable = variable_of(description_, table_, "tunable", name);
      if (const auto refusal = refusal_of(variable); !refusal.empty())
        table_.fail("tunable", refusal);
      if (variable.causality != "parameter" || variable.variability != "tunable")
        table_.fail("tunable", fmt::format("'{}' is a {} {}, expected a tunable parameter", name,
                                           variable.variability, variable.causality));
      if (!is_signal_name(name))
        table_.fail("tunable", fmt::format("'{}' cannot be the name of a signal", name));
      Binding binding = binding_of(variable);
      binding.direction = RTHS_PARAMETER;
      all_.signals.push_back(std::move(binding));
    }
  }

  void mark_ramped(bool is_complete) {
    for (const auto& name : table_.texts("ramp", {})) {
      static_cast<void>(variable_of(description_, table_, "ramp", name));
      const auto binding =
          std::find_if(all_.signals.begin(), all_.signals.end(), [&](const Binding& candidate) {
            return candidate.variable->name == name && candidate.direction == RTHS_OUTPUT;
          });
      if (binding != all_.signals.end())
        binding->is_ramped = true;
      else if (is_complete)
        table_.fail("ramp", fmt::format("'{}' is no output with a signal", name));
    }
  }

  const ModelDescription& description_;
  const Config& table_;
  Config signals_, units_, start_;
  Bindings all_;
};

}  // namespace

Bindings read_bindings(const ModelDescription& description, const Config& table, bool is_complete) {
  return BindingReader{description, table}.read(is_complete);
}

Config with_names(const ModelDescription& description, const Config& table,
                  const std::function<bool(const std::string&)>& is_signal) {
  Config signals = table.table_or_empty("signals");
  const Config start = table.table_or_empty("start");
  for (const auto& variable : description.variables) {
    const auto& name = variable.name;
    const bool is_exchanged = variable.causality == "input" || variable.causality == "output";
    if (is_exchanged && refusal_of(variable).empty() && !signals.has(name) && !start.has(name) &&
        is_signal(name))
      signals.put(name, name);
  }
  Config complete = table;
  complete.set("signals", signals);
  return complete;
}

}  // namespace rths::fmi
