// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/plant/large_plant_analysis.hpp>

namespace rths::plant {

/// Adds up the energies of a plant, step by step.
class EnergyCount {
 public:
  explicit EnergyCount(const LargePlantAnalysis& plant);
  [[nodiscard]] const EnergyBalance& energy() const { return energy_; }
  /// After the step is corrected.   @realtime
  void add_step(const LargePlantAnalysis& plant) RTHS_REALTIME;

 private:
  /// Forces at the end of a step, whose work is added.
  struct Forces {
    VectorXd damping;               // a₁ K_I v
    VectorXd bearings, not_damped;  // at the bearings: f, and a₁ k v that d takes away
    VectorXd ground;                // M ι a_g
  };
  void find_forces(const LargePlantAnalysis& plant) RTHS_REALTIME;
  void find_levels(const LargePlantAnalysis& plant) RTHS_REALTIME;

  EnergyBalance energy_;
  Forces now_, before_;
  VectorXd last_displacement_, product_;
  MatrixXd corrected_, last_corrected_;  // motion at the bearings
};

}  // namespace rths::plant
