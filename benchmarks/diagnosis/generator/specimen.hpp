// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "parameters.hpp"

namespace trial {

using Plane = std::array<double, 2>;  ///< long, lat

/// Motion of the platen and axial load at one instant.
struct Boundary {
  double time = 0;                                   ///< [s]
  Plane displacement{}, velocity{}, acceleration{};  ///< [m], [m/s], [m/s²]
  double axial_load = kReferenceLoad;                ///< > 0 compresses [N]
};

/// The lead-rubber bearing and its mounting.
///     F = K u + Q z,   u_y dz_i = du_i - z_i r_i^(n-2) w_i (1 - β + β sgn w_i)
///     r_i² = z_i² + η z_j²,   w_i = z_i du_i + η z_j du_j
class Bearing {
 public:
  explicit Bearing(const Physics& physics, double step);

  /// @returns the bearing's force at the displacement of its mounting [N]
  Plane advance(const Boundary& platen);

  [[nodiscard]] const Plane& loop_state() const { return loop_; }  ///< z [-]

 private:
  Plane mounted(const Plane& platen) const;
  Plane with_slack(const Plane& platen) const;
  void advance_loops(const Plane& increment);
  void remember(const Plane& increment, const Plane& turned);
  [[nodiscard]] double strength(const Boundary& platen, double speed) const;
  [[nodiscard]] double stiffness(double load_ratio) const;

  Physics physics_;
  double step_;
  Plane displacement_{}, force_{}, loop_{}, second_loop_{}, branch_{};
  std::array<Plane, 4> shape_{};
  double plastic_path_ = 0, largest_ = 0;
};

/// The machine's components between bearing and load cell.
class Platen {
 public:
  explicit Platen(const Physics& physics) : physics_(physics) {}

  Plane advance(const Boundary& platen);  ///< @returns the force [N]

 private:
  [[nodiscard]] double friction(std::size_t axis, const Boundary& platen) const;
  [[nodiscard]] double outside(std::size_t axis, const Boundary& platen) const;
  [[nodiscard]] double corner(std::size_t axis, const Boundary& platen) const;

  Physics physics_;
  Plane displacement_{}, slip_{}, path_{};
};

}  // namespace trial
