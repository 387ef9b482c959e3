// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "dynamic_run.hpp"
#include "dynamic_sizes.hpp"
#include "relation.hpp"

namespace rths::diagnosis {

/// Runs a dynamic model with a hypothesis' terms in it, freely, from what drives it.
class DynamicSimulator : public Simulator {
 public:
  /// The model must outlive this.
  /// @param sizes  null: terms compute in SI, and every connection is watched, as `sizes` are made
  /// @throws Error if terms or names do not fit the model   @setup
  DynamicSimulator(const DynamicModel& model, const Hypothesis& hypothesis,
                   const DynamicSizes* sizes, double time_step, const DynamicSignals& signals);

  [[nodiscard]] bool run(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& wanted,
                         Eigen::MatrixXd& prediction,
                         std::vector<Eigen::MatrixXd>& derivatives) const override;

  /// The state at the first sample that fits the first `rows` of a measurement best.
  [[nodiscard]] Eigen::VectorXd start(const Eigen::VectorXd& values,
                                      const Eigen::MatrixXd& measured, Eigen::Index rows) const;
  /// Displacements, then velocities, then accelerations of the connections that have terms, or of
  /// all if they are watched. Empty if it diverges.
  [[nodiscard]] std::vector<std::vector<double>> motion(const Eigen::VectorXd& values) const;
  [[nodiscard]] int substeps() const { return setup_.substeps; }

 private:
  struct Bound {
    Eigen::Index free, parameter;
    double scale;
  };
  void attach_terms(const Hypothesis& hypothesis, const DynamicSizes* sizes);
  void bind(const Hypothesis& hypothesis);
  [[nodiscard]] int substeps_needed(const Hypothesis& hypothesis, const DynamicSizes& sizes) const;
  [[nodiscard]] Eigen::VectorXd plant_values(const Eigen::VectorXd& values) const;
  [[nodiscard]] LinearSystem system(const Eigen::VectorXd& plant) const;
  [[nodiscard]] StepMatrices<double> steps(const Eigen::VectorXd& plant) const;
  [[nodiscard]] bool only_at_outputs(const std::vector<Eigen::Index>& lanes) const;
  [[nodiscard]] bool run_lanes(const Eigen::VectorXd& values,
                               const std::vector<Eigen::Index>& lanes,
                               const StepMatrices<double>& steps, Eigen::MatrixXd& prediction,
                               std::vector<Eigen::MatrixXd>& derivatives) const;

  const DynamicModel& model_;
  const DynamicSignals& signals_;
  DynamicSetup setup_;
  std::vector<Bound> bound_;  ///< free parameters that are of the linear part
};

[[nodiscard]] std::vector<double> plain(const Eigen::VectorXd& values);
/// Outputs as a matrix, rows × outputs; there is at least one.
[[nodiscard]] Eigen::MatrixXd as_columns(const std::vector<std::vector<double>>& outputs);

/// Natural units of records, with the simulation run as it is stated.
/// @throws Error if it diverges   @setup
[[nodiscard]] DynamicSizes measured_sizes(const DynamicModel& model, const Hypothesis& base,
                                          const std::vector<const Record*>& records);

/// Where a parameter of a hypothesis is: "mass.1" of the model, or a term's.
struct ParameterIndex {
  std::optional<std::size_t> of_model;  ///< in `DynamicModel::parameters`
  std::size_t term = 0;                 ///< else in the terms
  std::string parameter;                ///< and its name there
};
/// @throws Error if there is none, or more than one, of this name   @setup
[[nodiscard]] ParameterIndex find_parameter(const DynamicModel& model,
                                            const std::vector<ModelTerm>& terms,
                                            const std::string& name);

}  // namespace rths::diagnosis
