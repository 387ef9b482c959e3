// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "dynamic_simulator.hpp"
#include "foreign_model.hpp"

namespace rths::diagnosis {

/// Runs a foreign simulation, then the terms at its outputs. Derivatives with respect to its
/// parameters and to terms at its inputs and ports are differences between runs.
class ForeignSimulator final : public Simulator {
 public:
  /// Model, foreign model and signals must outlive this.
  /// @throws Error if terms or names do not fit the model   @setup
  ForeignSimulator(const DynamicModel& model, const ForeignModel& foreign,
                   const Hypothesis& hypothesis, const DynamicSizes& sizes, double time_step,
                   const DynamicSignals& signals);

  [[nodiscard]] bool run(const VectorXd& values, const std::vector<Index>& wanted,
                         MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const override;

 private:
  [[nodiscard]] foreign::RunInputs run_at(const VectorXd& values) const;
  /// The terms at the ports, with their free parameters.
  [[nodiscard]] foreign::PortLaw law_at(const VectorXd& values) const;
  /// Takes the outputs of a run as those that the terms at the outputs distort.
  [[nodiscard]] bool take(const foreign::RunOutputs& run) const;
  /// Step of a difference, within the bounds of the parameter.
  [[nodiscard]] double step_of(Index free, const VectorXd& values, double growth) const;
  /// Derivative by a parameter, rows × outputs; none if the run fails.
  [[nodiscard]] std::optional<MatrixXd> slope(Index free, const VectorXd& values, double growth,
                                              const MatrixXd& prediction) const;
  /// Growth of a step until it changes an output by some per cent: outputs of a simulation in fixed
  /// steps jump with its parameters where an event moves by a step, and a small step sees no jump.
  [[nodiscard]] double growth_of(Index free, const VectorXd& values,
                                 const MatrixXd& prediction) const;

  const DynamicModel& model_;
  const ForeignModel& foreign_;
  const Hypothesis hypothesis_;
  DynamicSizes sizes_;
  std::vector<FreeParameter> free_;
  double time_step_;
  /// Inputs of the model that the foreign one takes and computes, in its order.
  std::vector<std::size_t> inputs_, computed_;
  /// Parameter of the foreign model that a free one sets; none: of a term.
  std::vector<std::optional<std::size_t>> parameter_;
  std::vector<bool> is_upstream_;  ///< by free parameter: whether it changes the runs
  mutable DynamicSignals signals_;
  DynamicSimulator outputs_;
};

}  // namespace rths::diagnosis
