// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::adapters {

/// The six components of a bearing's deformation, from its node i to its node j.
inline constexpr int kComponents = 6;
enum Component { kAxial, kShearY, kShearZ, kTorsion, kRotationY, kRotationZ };

/// A component that no machine moves: elastic along a polygon, whose ends go on for ever, and
/// viscous.
struct ComponentSpring {
  std::vector<std::array<double, 2>> points;  ///< deformation, force, rising [m, N], [rad, N·m]
  double damping = 0;                         ///< [N·s/m], [N·m·s/rad]

  [[nodiscard]] double elastic_force(double deformation) const;
  [[nodiscard]] double stiffness() const;  ///< at rest
};

/// An axis of the machine, and what moves it: a component of the bearing, or, of an element in the
/// script's own coordinates, the degree of freedom of that position.
struct MovedAxis {
  std::string axis;      ///< "long"
  std::size_t of = 0;    ///< component or position
  double direction = 1;  ///< or −1: the machine counts the other way
};

/// How a bearing stands between the nodes of a script. Local x points from node i to node j.
struct BearingGeometry {
  /// Degrees of freedom that the script lists, 1 to 6, of node i and of node j. A node that is not
  /// listed does not move.
  std::vector<int> i_dofs, j_dofs{1, 2, 3, 4, 5, 6};
  Eigen::Vector3d x_axis{0, 0, 1}, y_axis{1, 0, 0};  ///< in the script's coordinates
  double height = 0;                                 ///< from node to node [m]
  double shear_distance = 0.5;  ///< of the point of no moment from node i, as a
                                ///< part of the height
  bool has_p_delta = true;      ///< moments of the axial force on the sheared bearing
  std::array<ComponentSpring, kComponents> springs;  ///< of components that are not moved
  /// What the machine is to load with the force of the axial spring, if it does. Answered is the
  /// spring's force.
  std::optional<MovedAxis> axial_load;
};

/// One of a machine's actuators, between a pin that stands and one on the platen, in the bearing's
/// coordinates, the origin where the specimen is loaded [m]. The axis is how much longer it is.
struct ActuatorAxis {
  std::string axis;
  Eigen::Vector3d fixed_pin, platen_pin;
};

/// One `element genericClient` of a script, and the specimen that stands for it.
struct OpenSeesElement {
  std::string name;
  bool is_udp = false;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8090;
  std::vector<bool> is_rotation;           ///< of each degree of freedom, as the script lists them
  double length_unit = 1, force_unit = 1;  ///< of the script [m], [N]
  std::optional<BearingGeometry> bearing;  ///< none: the script's own coordinates
  std::vector<MovedAxis> axes;
  std::vector<ActuatorAxis>
      actuators;             ///< move the components of `axes` together, if there are any
  bool is_relative = false;  ///< the first trial is where the specimen stands at the start
  /// Of what is moved, in the order of `axes` [N/m, N·m/rad, …]; none: identified. OpenSees adds
  /// damping · velocity and mass · acceleration to the force: they state what is not measured.
  std::optional<Eigen::MatrixXd> initial_stiffness, damping, mass;
  double probe = 1e-3;  ///< how far the specimen is moved to identify them [m, rad]

  [[nodiscard]] Eigen::Index dofs() const { return std::ssize(is_rotation); }
  /// Whether what is moved turns: a component of the bearing, or a degree of freedom.
  [[nodiscard]] bool turns(std::size_t of) const {
    return bearing ? of >= kTorsion : is_rotation[of];
  }
  /// The script's units of displacement and force, of what turns or does not [m, rad], [N, N·m].
  [[nodiscard]] double displacement_unit(bool turning) const { return turning ? 1 : length_unit; }
  [[nodiscard]] double force_unit_of(bool turning) const {
    return turning ? force_unit * length_unit : force_unit;
  }
  [[nodiscard]] bool is_identified() const { return !initial_stiffness || !damping || !mass; }
};

}  // namespace rths::adapters
