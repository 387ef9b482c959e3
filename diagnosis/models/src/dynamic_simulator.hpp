// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/identification/relation.hpp>

#include "dynamic_run.hpp"
#include "dynamic_sizes.hpp"

namespace rths::diagnosis {

/// Runs a dynamic model with a hypothesis' terms from its inputs alone.
class DynamicSimulator : public Simulator {
 public:
  /// The model must outlive this.
  /// @param sizes  null: terms compute in SI and every connection is observed, to determine `sizes`
  /// @throws Error if terms or names do not fit the model   @setup
  DynamicSimulator(const DynamicModel& model, const Hypothesis& hypothesis,
                   const DynamicSizes* sizes, double time_step, const DynamicSignals& signals);

  [[nodiscard]] bool run(const VectorXd& values, const std::vector<Index>& wanted,
                         MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const override;

  /// The state at the first sample that best fits the beginning of the measurement.
  [[nodiscard]] VectorXd start(const VectorXd& values) const {
    return start(values, steps(plant_values(values)));
  }
  /// Displacements, then velocities, then accelerations of the observed connections: those with
  /// terms, or all if `sizes` is null. Empty if the run diverges.
  [[nodiscard]] std::vector<std::vector<double>> motion(const VectorXd& values) const;
  /// An input of the model after its terms.
  [[nodiscard]] std::vector<double> driven(std::size_t input, const VectorXd& values) const;
  /// A step of a system solves for the forces of its connections by iteration.
  [[nodiscard]] int work_per_row() const override {
    constexpr int kWorkOfStep = 6, kWorkOfStart = 3;
    return kWorkOfStep * setup_.substeps * (has_free_start() ? kWorkOfStart : 1);
  }

 private:
  struct Bound {
    Index free, parameter;
    double scale;
  };
  /// Sets up the terms of all components and binds their free parameters.
  void attach_terms(const Hypothesis& hypothesis, const DynamicSizes* sizes);
  void attach_to_connections(const Hypothesis& hypothesis, const DynamicSizes* sizes);
  /// The terms at a component; null if it has none.
  [[nodiscard]] ComponentTerms* terms_of(const std::string& component);
  /// Binds the free parameters of terms.
  void bind_terms(const Hypothesis& hypothesis);
  /// Binds the free parameters of the linear system.
  void bind_model(const Hypothesis& hypothesis);
  [[nodiscard]] int substeps_needed(const Hypothesis& hypothesis, const DynamicSizes& sizes) const;
  [[nodiscard]] VectorXd plant_values(const VectorXd& values) const;
  [[nodiscard]] LinearSystem system(const VectorXd& plant) const;
  [[nodiscard]] StepMatrices<double> steps(const VectorXd& plant) const;
  [[nodiscard]] bool only_at_outputs(const std::vector<Index>& lanes) const;
  [[nodiscard]] bool has_free_start() const { return signals_.beginning.size() > 0; }
  [[nodiscard]] VectorXd start(const VectorXd& values, const StepMatrices<double>& steps) const;
  /// As `run`, from the start state of the signals.
  [[nodiscard]] bool run_from(const DynamicSignals& signals, const VectorXd& values,
                              const std::vector<Index>& wanted, const StepMatrices<double>& steps,
                              MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const;
  [[nodiscard]] bool run_lanes(const DynamicSignals& signals, const VectorXd& values,
                               const std::vector<Index>& lanes, const StepMatrices<double>& steps,
                               MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const;
  /// Response of the prediction to each state at the start; empty if a run diverges.
  [[nodiscard]] std::vector<MatrixXd> start_response(DynamicSignals signals, const VectorXd& values,
                                                     const StepMatrices<double>& steps,
                                                     const MatrixXd& prediction) const;

  const DynamicModel& model_;
  const DynamicSignals& signals_;
  DynamicSetup setup_;
  std::vector<Bound> bound_;  ///< free parameters of the linear system
};

[[nodiscard]] std::vector<double> plain(const VectorXd& values);
/// Outputs as a matrix, rows × outputs, with at least one output.
[[nodiscard]] MatrixXd as_columns(const std::vector<std::vector<double>>& outputs);

/// Natural units of records, from a run of the simulation as stated.
/// @throws Error if the run diverges   @setup
[[nodiscard]] DynamicSizes measured_sizes(const DynamicModel& model, const Hypothesis& base,
                                          const std::vector<const Record*>& records);

/// Location of a parameter of a hypothesis: in the model ("mass.1") or in a term.
struct ParameterIndex {
  std::optional<std::size_t> of_model;  ///< in `DynamicModel::parameters`
  std::size_t term = 0;                 ///< otherwise: index of the term
  std::string parameter;                ///< and the parameter's name in the term
};
/// @throws Error if no parameter, or more than one, has this name   @setup
[[nodiscard]] ParameterIndex find_parameter(const DynamicModel& model,
                                            const std::vector<ModelTerm>& terms,
                                            const std::string& name);

}  // namespace rths::diagnosis
