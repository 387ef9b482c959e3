// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "component_terms.hpp"
#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// Terms of a connection, and whether its linear spring and damper are among them.
struct ConnectionWithTerms {
  std::size_t connection = 0;  ///< of the model
  ComponentTerms terms;
  bool holds_linear = false;
};

/// A model with terms in place, on some record: all that a free run needs but numbers.
struct DynamicSetup {
  std::vector<std::optional<ComponentTerms>> inputs;  ///< chains, by input of the model
  std::vector<PlantInput> plant_inputs;
  std::vector<ConnectionWithTerms> connections;  ///< those that have terms
  std::vector<std::optional<ComponentTerms>> outputs;
  Interpolation between;
  int substeps = 1;      ///< of a sample's step
  double time_step = 0;  ///< between samples [s]
};

/// What drives a free run.
struct DynamicSignals {
  double start = 0;                         ///< [s]
  std::vector<std::vector<double>> inputs;  ///< by input of the model
  Eigen::VectorXd start_state;
  double limit = 0;  ///< an output beyond it has diverged
};

/// Runs a model freely: outputs from inputs, nothing else.
/// @param steps  of a part, with the connections of the setup only
/// @param values  of the hypothesis' free parameters
/// @param motion  if not null: displacement of each connection, then velocity of each, then
///                acceleration as far as it is known, by sample
/// @returns by output, by sample; empty if it diverges
template <class Real, class Entry>
[[nodiscard]] std::vector<std::vector<Real>> run_freely(
    const DynamicSetup& setup, const DynamicSignals& signals, const StepMatrices<Entry>& steps,
    const std::vector<Real>& values, std::vector<std::vector<double>>* motion = nullptr);

/// The same where derivatives are wanted with respect to terms at the outputs only: the rest need
/// not carry them.
[[nodiscard]] std::vector<std::vector<sim::Dual>> through_outputs(
    const DynamicSetup& setup, const DynamicSignals& signals, const StepMatrices<double>& steps,
    const std::vector<sim::Dual>& values);

extern template std::vector<std::vector<double>> run_freely<double, double>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<double>&,
    const std::vector<double>&, std::vector<std::vector<double>>*);
extern template std::vector<std::vector<sim::Dual>> run_freely<sim::Dual, double>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<double>&,
    const std::vector<sim::Dual>&, std::vector<std::vector<double>>*);
extern template std::vector<std::vector<sim::Dual>> run_freely<sim::Dual, sim::Dual>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<sim::Dual>&,
    const std::vector<sim::Dual>&, std::vector<std::vector<double>>*);

}  // namespace rths::diagnosis
