// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::sim {

/// A building as a stick: masses above one another, sheared against each other and the basemat.
///
/// Storey stiffnesses are equal along the stick and scaled so that the first mode on a fixed base
/// has the frequency given. Both horizontal directions are independent above the basemat.
struct Stick {
  std::string name;
  std::vector<double> masses;      ///< bottom to top [kg], > 0
  std::vector<double> elevations;  ///< of the masses [m], ascending
  double frequency_long = 0;       ///< first mode, fixed base [Hz]
  double frequency_lat = 0;        ///< [Hz]
};

/// A plant on seismic isolators that all move alike: one bearing, tested, stands for all of them.
struct IsolatedPlant {
  double basemat_mass = 0;  ///< [kg]
  std::vector<Stick> sticks;
  double damping_ratio = 0.04;       ///< of every mode of the sticks on a fixed base [-]
  int bearings = 486;                ///< the bearing's force is multiplied by this
  double spectrum_elevation = 47.5;  ///< where floor spectra are taken [m]
  double vertical_frequency = 9.5;   ///< of all of it on its bearings, up and down [Hz]
  double vertical_damping = 0.05;    ///< of that [-]
};

/// What one bearing carries when nothing moves [N].
[[nodiscard]] double weight_per_bearing(const IsolatedPlant& plant);

/// The equations of motion of a plant, in coordinates relative to the ground:
///     M a + C v + K u + L F(u_b) = −M ι a_g
///
/// Degrees of freedom come in pairs (long, lat): the basemat first, then the masses of each stick.
struct PlantMatrices {
  Eigen::MatrixXd M;            ///< [kg]
  Eigen::MatrixXd C;            ///< [N·s/m]
  Eigen::MatrixXd K;            ///< without the bearings [N/m]
  Eigen::MatrixXd iota;         ///< dof × 2: 1 where a degree of freedom moves with the ground [-]
  int bearings = 0;             ///< L = bearings on the basemat's two degrees of freedom
  double mass_per_bearing = 0;  ///< [kg]
  double vertical_frequency = 0;         ///< [Hz]
  double vertical_damping = 0;           ///< [-]
  std::vector<std::string> floor_names;  ///< one per stick
  std::vector<int> floors;               ///< its long degree of freedom at the spectrum elevation

  [[nodiscard]] int dofs() const { return static_cast<int>(M.rows()); }
  /// The same sticks on a rigid base that moves with the ground: basemat left out.
  [[nodiscard]] PlantMatrices fixed_base() const;
};

/// @throws Error if a stick has no mass at the spectrum elevation, or a parameter is unphysical
/// @setup
[[nodiscard]] PlantMatrices assemble(const IsolatedPlant& plant);

/// A plant of the kind the paper tests: containment, internal structure and auxiliary building.
///
/// The paper prints neither masses nor frequencies of the model. These are ours, chosen so that the
/// isolated period after yield is about 3 s, the plant on unyielded bearings has 2.8 Hz, and the
/// auxiliary building has its pair of modes at 7.6 Hz.
[[nodiscard]] IsolatedPlant example_plant();

}  // namespace rths::sim
