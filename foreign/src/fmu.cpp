// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/fmu.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/fmi/fmu_files.hpp>
#include <rths/fmi/fmu_unit.hpp>

#include "fmu_run.hpp"
#include "forked_runs.hpp"

namespace rths::foreign {
namespace {

constexpr double kSameRestarted = 1e-3;  // largest change of an output by restarts, of its range

const fmi::Variable& variable_in(const fmi::ModelDescription& description,
                                 const std::string& name) {
  std::vector<std::string> names;
  for (const auto& variable : description.variables) names.push_back(variable.name);
  const fmi::Variable* variable = description.find(name);
  if (variable == nullptr)
    throw Error{
        fmt::format("the FMU has no variable '{}'{}", name, did_you_mean_one_of(name, names))};
  if (variable->is_array || variable->is_clocked || variable->type == fmi::Type::Other)
    throw Error{fmt::format("'{}' is an array, clocked or of type {}, expected a scalar number",
                            name, variable->type_name)};
  return *variable;
}

bool is_state(const fmi::Variable& variable) {
  return variable.is_exact && variable.is_real() && variable.variability == "continuous" &&
         !variable.is_array && (variable.causality == "output" || variable.causality == "local");
}

/// Finds the variables of the settings.
class SetupReader {
 public:
  explicit SetupReader(FmuSetup& setup) : setup_{setup} {}

  void read() {
    const FmuSettings& settings = setup_.settings;
    for (std::size_t i = 0; i < settings.inputs.size(); ++i) add_input(settings.inputs[i], i);
    for (std::size_t i = 0; i < settings.outputs.size(); ++i)
      add(setup_.outputs, settings.outputs[i], i);
    for (std::size_t i = 0; i < settings.parameters.size(); ++i)
      add_settable(setup_.parameters, settings.parameters[i], i);
    for (std::size_t i = 0; i < settings.start.size(); ++i)
      add_settable(setup_.start, settings.start[i].first, i);
    for (const auto& port : settings.ports) add_port(port);
  }

 private:
  const fmi::Variable& variable(const std::string& name) const {
    return variable_in(setup_.description, name);
  }
  void add(fmi::Exchanges& exchanges, const std::string& name, std::size_t index) const {
    exchanges.add(variable(name), index,
                  fmi::si_unit_of(setup_.description, variable(name)).conversion);
  }
  void add_input(const std::string& name, std::size_t index) const {
    if (variable(name).causality != "input")
      throw Error{
          fmt::format("'{}' has causality {}, expected input", name, variable(name).causality)};
    add(setup_.given, name, index);
  }
  void add_settable(fmi::Exchanges& exchanges, const std::string& name, std::size_t index) const {
    const fmi::Variable& one = variable(name);
    if (one.causality != "parameter" && one.causality != "input" && !one.is_exact)
      throw Error{
          fmt::format("'{}' has causality {}, expected parameter, input or initial = \"exact\"",
                      name, one.causality)};
    exchanges.add(one, index, {});
  }

  std::size_t motion_of(const std::string& name) {
    add(setup_.motions, name, setup_.motion_count);
    return setup_.motion_count++;
  }

  void add_port(const FmuPort& port) {
    FmuSetup::Port found;
    found.displacement = motion_of(port.displacement);
    const std::string velocity = port.velocity.empty() ? port.state : port.velocity;
    if (!velocity.empty()) found.velocity = motion_of(velocity);
    port.state.empty() ? find_force(port.force, found) : find_state(port.state, found);
    setup_.ports.push_back(found);
  }
  void find_force(const std::string& name, FmuSetup::Port& found) {
    const auto& inputs = setup_.settings.inputs;
    const auto at = std::find(inputs.begin(), inputs.end(), name);
    if (at != inputs.end()) {
      found.force = static_cast<std::size_t>(at - inputs.begin());
      return;
    }
    found.force = inputs.size() + setup_.rest.size();
    add_input(name, *found.force);
    const fmi::Variable& one = variable(name);
    double value = one.start.value_or(0);
    for (const auto& [started, number] : setup_.settings.start)
      if (started == name) value = number;
    setup_.rest.push_back(fmi::si_unit_of(setup_.description, one).conversion.si(value));
  }
  void find_state(const std::string& name, FmuSetup::Port& found) {
    if (!is_state(variable(name)))
      throw Error{fmt::format(
          "'{}' is no state that can be set: expected initial = \"exact\", causality output or "
          "local",
          name)};
    if (setup_.state_count == 0)
      for (const auto& one : setup_.description.variables)
        if (is_state(one)) {
          add(setup_.states, one.name, setup_.state_count++);
          states_.push_back(one.name);
        }
    found.state = place_in(states_, name);
    found.output = place_in(setup_.settings.outputs, name);
  }
  static std::optional<std::size_t> place_in(const std::vector<std::string>& names,
                                             const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) return std::nullopt;
    return static_cast<std::size_t>(at - names.begin());
  }

  FmuSetup& setup_;
  std::vector<std::string> states_;
};

class FmuSimulation final : public ForkedSimulation {
 public:
  explicit FmuSimulation(FmuSettings settings) : files_{settings.file} {
    setup_.description = fmi::read_description(settings.file);
    setup_.folder = files_.folder();
    setup_.library = fmi::library_in(files_.folder(), setup_.description);
    setup_.settings = std::move(settings);
    if (setup_.settings.step > 0 && setup_.description.fixed_step) check_step();
    SetupReader{setup_}.read();
  }

 private:
  [[nodiscard]] std::vector<RunOutputs> run_forked_once(
      std::span<const RunInputs* const> all) const override {
    const auto run = [&](const RunInputs& inputs, double* results) {
      run_fmu(setup_, inputs, setup_.restarts(), results);
      if (setup_.restarts() && !is_checked_ && inputs.law.key.empty())
        check_restarts(inputs, results);
    };
    const FmuSettings& settings = setup_.settings;
    const ForkedRuns runs{settings.file.string(), settings.outputs.size(), settings.deadline, run};
    auto found = runs.results(all);
    is_checked_ = is_checked_ || found[0].trouble.empty();
    return found;
  }

  void check_step() const {
    const double fixed = *setup_.description.fixed_step;
    const double count = std::round(setup_.settings.step / fixed);
    if (count < 1 || std::abs(count * fixed / setup_.settings.step - 1) > kSameRestarted)
      throw Error{
          fmt::format("step_s is {:g}, expected a multiple of the FMU's fixed step, {:g} s "
                      "(fixedInternalStepSize)",
                      setup_.settings.step, fixed)};
  }

  // A start at each step must not change the outputs: the FMU may have states of another kind.
  void check_restarts(const RunInputs& inputs, const double* restarted) const {
    std::vector<double> plain(setup_.settings.outputs.size() * inputs.rows);
    run_fmu(setup_, inputs, false, plain.data());
    for (std::size_t i = 0; i < setup_.settings.outputs.size(); ++i) {
      const auto first = plain.begin() + static_cast<std::ptrdiff_t>(i * inputs.rows);
      const auto [low, high] =
          std::minmax_element(first, first + static_cast<std::ptrdiff_t>(inputs.rows));
      double largest = 0;
      for (std::size_t row = 0; row < inputs.rows; ++row)
        largest = std::max(
            largest, std::abs(plain[i * inputs.rows + row] - restarted[i * inputs.rows + row]));
      if (largest > kSameRestarted * (*high - *low))
        throw Error{fmt::format(
            "a start at each step, for the port at a state, changes '{}' by {:.2g}: the FMU has "
            "more states than its variables with initial = \"exact\"",
            setup_.settings.outputs[i], largest)};
    }
  }

  fmi::FmuFiles files_;
  FmuSetup setup_;
  // By the first run. With other parameters, round-off may move an event by a step.
  mutable std::atomic<bool> is_checked_ = false;
};

}  // namespace

std::unique_ptr<Simulation> make_fmu(FmuSettings settings) {
  return std::make_unique<FmuSimulation>(std::move(settings));
}

}  // namespace rths::foreign
