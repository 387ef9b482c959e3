// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "specimen.hpp"

namespace trial {

/// The numerical substructure: for each horizontal axis a base on the bearing and one storey.
///     m_1 u_1'' = -F - c_1 u_1' + k (u_2 - u_1) + c (u_2' - u_1') - m_1 a_g
///     m_2 u_2'' =             - k (u_2 - u_1) - c (u_2' - u_1') - m_2 a_g
class Structure {
 public:
  /// @param force  of the bearing on the base [N]
  /// @param ground  acceleration [m/s²]
  void advance(const Plane& force, const Plane& ground, double step);

  [[nodiscard]] const Plane& displacement() const { return base_displacement_; }  ///< [m]
  [[nodiscard]] const Plane& velocity() const { return base_velocity_; }          ///< [m/s]
  [[nodiscard]] const Plane& acceleration() const { return base_acceleration_; }  ///< [m/s²]

 private:
  Plane base_displacement_{}, base_velocity_{}, base_acceleration_{};
  Plane top_displacement_{}, top_velocity_{};
};

/// Returns the command for which the nominal actuator has no delay.
Plane compensated(const Structure& structure);

}  // namespace trial
