// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rths::adapters {

/// A point or direction in space: x, y, z.
using Vector3 = std::array<double, 3>;

/// A square matrix, stored row by row.
struct SquareMatrix {
  std::size_t size = 0;
  std::vector<double> values;  ///< size²

  [[nodiscard]] double& at(std::size_t row, std::size_t column) {
    return values.at(row * size + column);
  }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const {
    return values.at(row * size + column);
  }
  /// Returns a matrix with `value` on its diagonal and 0 elsewhere.
  [[nodiscard]] static SquareMatrix diagonal(std::size_t size, double value) {
    SquareMatrix matrix{size, std::vector<double>(size * size)};
    for (std::size_t i = 0; i < size; ++i) matrix.at(i, i) = value;
    return matrix;
  }
};

/// The six components of a bearing's deformation, from its node i to its node j.
inline constexpr int kComponents = 6;
enum BasicComponent { kAxial, kShearY, kShearZ, kTorsion, kRotationY, kRotationZ };

/// A component that no machine moves: a multilinear elastic spring, extrapolated at both ends, with
/// a viscous damper.
struct ComponentSpring {
  std::vector<std::array<double, 2>> points;  ///< deformation, force, increasing [m, N], [rad, N·m]
  double damping = 0;                         ///< [N·s/m], [N·m·s/rad]

  [[nodiscard]] double elastic_force(double deformation) const;
  [[nodiscard]] double stiffness() const;  ///< at rest
};

/// An axis of the machine and the displacement that it imposes.
struct MovedAxis {
  std::string axis;       ///< "long"
  std::size_t index = 0;  ///< component of the bearing; without bearing: degree of freedom, from 0
  double direction = 1;   ///< or −1: the machine's axis points the other way
};

/// Position of a bearing between the nodes of a script. Local x points from node i to node j.
struct BearingGeometry {
  /// Degrees of freedom that the script lists, 1 to 6, of node i and of node j. An unlisted node is
  /// fixed.
  std::vector<int> i_dofs, j_dofs{1, 2, 3, 4, 5, 6};
  Vector3 x_axis{0, 0, 1}, y_axis{1, 0, 0};  ///< in the script's coordinates
  double height = 0;                         ///< from node to node [m]
  double shear_distance = 0.5;  ///< from node i to the point of zero moment, over the height [-]
  bool has_p_delta = true;      ///< include moments of the axial force on the sheared bearing
  std::array<ComponentSpring, kComponents> springs;  ///< of components that are not moved
  /// Axis that the machine loads with the force of the axial spring, if any. The element returns
  /// the spring's force.
  std::optional<MovedAxis> axial_load;
};

/// An actuator between a fixed pin and a pin on the platen, in the bearing's coordinates, with the
/// origin at the specimen's loading point [m]. Its axis is its elongation.
struct ActuatorAxis {
  std::string axis;
  Vector3 fixed_pin{}, platen_pin{};
};

/// One `element genericClient` of a script and its specimen.
struct OpenSeesElement {
  std::string name;
  bool is_udp = false;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8090;
  /// Address of its peer; "any": every peer. Empty: the started script, or without a script a
  /// process of the same user on this host.
  std::string peer;
  std::vector<bool> is_rotation;           ///< of each degree of freedom, in the script's order
  double length_unit = 1, force_unit = 1;  ///< of the script [m], [N]
  std::optional<BearingGeometry> bearing;  ///< empty: the script's own coordinates
  std::vector<MovedAxis> axes;
  std::vector<ActuatorAxis> actuators;  ///< that together move the components of `axes`, if any
  bool is_relative = false;  ///< the first trial corresponds to the specimen's start position
  /// Of the moved components, in the order of `axes` [N/m, N·m/rad, …]; empty: identified. OpenSees
  /// adds damping · velocity and mass · acceleration to the force, so state only contributions that
  /// the measured force lacks.
  std::optional<SquareMatrix> initial_stiffness, damping, mass;
  double probe = 1e-3;        ///< amplitude of the identification [m, rad]
  double first_trial = 0.05;  ///< largest first move from rest, of each axis [m, rad]

  [[nodiscard]] std::ptrdiff_t dofs() const { return std::ssize(is_rotation); }
  /// Whether a moved component or degree of freedom is a rotation.
  [[nodiscard]] bool turns(std::size_t index) const {
    return bearing ? index >= kTorsion : is_rotation[index];
  }
  /// The script's units of displacement and force, of a rotation or a translation [m, rad], [N,
  /// N·m].
  [[nodiscard]] double displacement_unit(bool turning) const { return turning ? 1 : length_unit; }
  [[nodiscard]] double force_unit_of(bool turning) const {
    return turning ? force_unit * length_unit : force_unit;
  }
  [[nodiscard]] bool needs_identification() const {
    return !initial_stiffness || !damping || !mass;
  }
};

}  // namespace rths::adapters
