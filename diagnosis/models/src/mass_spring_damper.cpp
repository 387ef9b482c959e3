// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "mechanics.hpp"

namespace rths::diagnosis {
namespace {

// [[model.spring]] between = [0, 1], stiffness_N_per_m, damping_N_s_per_m, and tables of terms.
void read_spring(const Config& table, Mechanics& mechanics, DynamicModel& model,
                 std::vector<ModelTerm>& terms) {
  mechanics.add_spring(mechanics.read_spring(table), model);
  const std::string& component = model.connections.back().component;
  model.parameters.push_back({component + ".stiffness",
                              "N/m",
                              table.number("stiffness_N_per_m", 0.0),
                              "stiffness_error",
                              {}});
  model.parameters.push_back({component + ".damping",
                              "N*s/m",
                              table.number_in("damping_N_s_per_m", 0, 1e30, 0.0),
                              "damping_error",
                              {}});
  for (auto& term : read_model_terms(table, component)) terms.push_back(std::move(term));
  table.reject_unknown_keys();
}

Mechanics::Matrices assembled(const Mechanics& mechanics, const VectorXd& values) {
  const Index n = mechanics.masses, springs = static_cast<Index>(mechanics.springs.size());
  Mechanics::Matrices matrices{values.head(n).asDiagonal(), MatrixXd::Zero(n, n),
                               MatrixXd::Zero(n, n), VectorXd::Zero(springs),
                               VectorXd::Zero(springs)};
  for (Index i = 0; i < springs; ++i) {
    const VectorXd stretch = mechanics.stretch(mechanics.springs[static_cast<std::size_t>(i)]);
    matrices.spring_stiffness[i] = values[n + 2 * i];
    matrices.spring_damping[i] = values[n + 2 * i + 1];
    matrices.stiffness += values[n + 2 * i] * stretch * stretch.transpose();
    matrices.damping += values[n + 2 * i + 1] * stretch * stretch.transpose();
  }
  return matrices;
}

}  // namespace

DynamicModel read_mass_spring_damper(const Config& table) {
  DynamicModel model;
  Mechanics mechanics;
  const auto masses = table.numbers("masses_kg");
  for (const double mass : masses) {
    if (!(mass > 0))
      table.fail("masses_kg", fmt::format("a mass is {}, expected more than 0", mass));
    const auto number = model.parameters.size() + 1;
    model.parameters.push_back({fmt::format("mass.{}", number), "kg", mass, "mass_error", {}});
  }
  if (masses.empty()) table.fail("masses_kg", "masses_kg is empty");
  mechanics.masses = static_cast<Index>(masses.size());
  mechanics.influence = VectorXd::Ones(mechanics.masses);
  std::vector<ModelTerm> terms;
  for (const auto& spring : table.tables("spring")) read_spring(spring, mechanics, model, terms);
  mechanics.read(table, model);
  read_common(table, model);
  model.terms.insert(model.terms.end(), terms.begin(), terms.end());
  const std::size_t inputs = model.plant_inputs.size();
  model.linear = [mechanics, inputs](const VectorXd& values) {
    return mechanics.system(assembled(mechanics, values), inputs);
  };
  return model;
}

}  // namespace rths::diagnosis
