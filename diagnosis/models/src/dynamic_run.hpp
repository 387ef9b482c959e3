// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <rths/identification/vectors.hpp>

#include "component_terms.hpp"
#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// A connection with its terms.
struct ConnectionWithTerms {
  std::size_t connection = 0;  ///< of the model
  ComponentTerms terms;
  bool holds_linear = false;  ///< the terms include its linear spring and damper
};

/// A model with its terms, for one record: the data of a free run except the values of parameters.
struct DynamicSetup {
  std::vector<std::optional<ComponentTerms>> inputs;  ///< chains, by input of the model
  /// Whether a chain acts on the signal between samples too, by input of the model.
  std::vector<bool> is_bent;
  std::vector<PlantInput> plant_inputs;
  std::vector<ConnectionWithTerms> connections;  ///< with terms
  std::vector<std::optional<ComponentTerms>> outputs;
  Interpolation between;
  int substeps = 1;      ///< per sample
  double time_step = 0;  ///< between samples [s]
};

/// Inputs of a free run.
struct DynamicSignals {
  double start = 0;                         ///< [s]
  std::vector<std::vector<double>> inputs;  ///< by input of the model
  VectorXd start_state;
  /// First rows of the measured outputs, which the start state fits at any parameters; empty: the
  /// start state is known.
  MatrixXd beginning;
  double limit = 0;  ///< larger outputs count as diverged
};

/// Runs a model freely: computes the outputs from the inputs alone.
/// @param steps  of a substep, with only the connections of the setup
/// @param values  of the hypothesis' free parameters
/// @param motion  if not null: displacement of each connection, then velocity of each, then
///                acceleration if known, by sample
/// @returns outputs, by sample; empty if the run diverges
template <class Real, class Entry>
[[nodiscard]] std::vector<std::vector<Real>> run_freely(
    const DynamicSetup& setup, const DynamicSignals& signals, const StepMatrices<Entry>& steps,
    const std::vector<Real>& values, std::vector<std::vector<double>>* motion = nullptr);

/// Runs a model freely, with derivatives only with respect to terms at the outputs: the rest runs
/// without derivatives, which is faster.
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
