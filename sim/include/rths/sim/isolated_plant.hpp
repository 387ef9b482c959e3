// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::sim {

/// A building as a stick: masses above one another, connected by shear springs to each other and to
/// the basemat.
///
/// Storey stiffnesses are equal along the stick and scaled so that the first mode on a fixed base
/// has the given frequency. The two horizontal directions are independent above the basemat.
struct Stick {
  std::string name;
  std::vector<double> masses;      ///< bottom to top [kg], > 0
  std::vector<double> elevations;  ///< of the masses [m], ascending
  double frequency_long = 0;       ///< first mode, fixed base [Hz]
  double frequency_lat = 0;        ///< [Hz]
};

/// A plant on seismic isolators that all move alike: one tested bearing represents all of them. The
/// isolators stand evenly under a rectangular basemat.
struct IsolatedPlant {
  double basemat_mass = 0;  ///< [kg]
  std::vector<Stick> sticks;
  double damping_ratio = 0.04;       ///< of every mode of the sticks on a fixed base [-]
  int bearings = 486;                ///< factor on the bearing's force
  double spectrum_elevation = 47.5;  ///< of the floor spectra [m]
  double vertical_frequency = 9.5;   ///< of the plant on its bearings, vertical mode [Hz]
  double vertical_damping = 0.05;    ///< ratio of the vertical mode [-]
  double plan_long = 110;            ///< sides of the basemat [m]
  double plan_lat = 90;              ///< [m]
  double bearing_long = 0;           ///< the tested bearing's place, from the basemat's centre [m]
  double bearing_lat = 0;            ///< [m]
  /// True if horizontal motion varies the compression of the tested bearing.
  [[nodiscard]] bool overturns() const { return bearing_long != 0 || bearing_lat != 0; }
};

/// Static load on one bearing [N].
[[nodiscard]] double weight_per_bearing(const IsolatedPlant& plant);

/// The equations of motion of a plant, in coordinates relative to the ground:
///     M a + C v + K u + L F(u_b) = −M ι a_g
///
/// Degrees of freedom are pairs (long, lat): the basemat first, then the masses of each stick.
struct PlantMatrices {
  Eigen::MatrixXd M;              ///< [kg]
  Eigen::MatrixXd C;              ///< [N·s/m]
  Eigen::MatrixXd K;              ///< without the bearings [N/m]
  Eigen::MatrixXd iota;           ///< dof × 2: 1 for a degree of freedom in that direction, else 0
  int bearings = 0;               ///< L = bearings on the basemat's two degrees of freedom
  double mass_per_bearing = 0;    ///< [kg]
  double vertical_frequency = 0;  ///< [Hz]
  double vertical_damping = 0;    ///< [-]
  /// Compression of the tested bearing per force of the masses [-]; empty without bearings.
  Eigen::VectorXd overturning;
  std::vector<std::string> floor_names;  ///< one per stick
  std::vector<int> floors;               ///< long degrees of freedom at the spectrum elevation

  [[nodiscard]] int dofs() const { return static_cast<int>(M.rows()); }
  /// The same sticks on a rigid base that moves with the ground, without the basemat.
  [[nodiscard]] PlantMatrices fixed_base() const;
};

/// @throws Error if a stick has no mass at the spectrum elevation, or a parameter is unphysical
/// @setup
[[nodiscard]] PlantMatrices assemble(const IsolatedPlant& plant);

/// A plant like the paper's: containment, internal structure and auxiliary building.
///
/// The paper gives neither masses nor frequencies of its model. These values are ours, chosen for
/// an isolated period after yield of about 3 s, 2.8 Hz on unyielded bearings, and a pair of modes
/// of the auxiliary building at 7.6 Hz.
[[nodiscard]] IsolatedPlant example_plant();

}  // namespace rths::sim
