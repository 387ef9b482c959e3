// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dynamic_model.hpp"
#include "dynamic_reading.hpp"

namespace rths::diagnosis {

/// A spring between two masses; 0 is the ground.
struct Spring {
  Index from = 0, to = 0;
};

/// Masses, springs, inputs and outputs of a structure: M x'' + C x' + K x = forces of the inputs.
/// If the base is displaced, motion is absolute; otherwise it is relative to the base.
struct Mechanics {
  enum class Input { Force, BaseAcceleration, BaseDisplacement };
  enum class Output { Displacement, Velocity, Acceleration, Deformation, SpringForce };

  struct Drive {
    Input kind;
    Index mass;               ///< of a force
    std::size_t plant_input;  ///< of the base's displacement, the next is its rate
  };
  struct Reading {
    Output kind;
    Index index;  ///< of the mass, or of the spring
  };
  Index masses = 0;
  std::vector<Spring> springs;
  std::vector<Drive> drives;
  std::vector<Reading> readings;
  VectorXd influence;  ///< share of the base acceleration that acts on each mass

  /// Reads [model.inputs] and [model.outputs] into this and the model.
  void read(const Config& table, DynamicModel& model);

  struct Matrices {
    MatrixXd mass, damping, stiffness;
    VectorXd spring_stiffness, spring_damping;  ///< of each spring
  };
  /// Displacement between the ends of a spring, by mass.
  [[nodiscard]] RowVectorXd stretch(const Spring& spring) const;
  /// Adds a spring, and a component for terms at it.
  void add_spring(const Spring& spring, DynamicModel& model);
  /// [[spring]] between = [0, 1]
  [[nodiscard]] Spring read_spring(const Config& table) const;
  [[nodiscard]] LinearSystem system(const Matrices& matrices, std::size_t plant_inputs) const;
};

}  // namespace rths::diagnosis
