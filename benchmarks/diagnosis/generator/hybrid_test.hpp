// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ground_motion.hpp"
#include "sensors.hpp"

namespace trial {

/// The recording of one test and its true values, with one entry for each sample.
struct Record {
  std::vector<Plane> command, displacement, acceleration, force;  ///< [m], [m], [m/s²], [N]
  std::vector<double> axial_load;                                 ///< [N]

  std::vector<Boundary> truth;  ///< true motion of the platen
  std::vector<Plane> load;      ///< on the platen, without its inertia [N]
  std::vector<Plane> fine_displacement, fine_acceleration,
      fine_force;  ///< at the default resolution

  [[nodiscard]] double peak_displacement() const;  ///< [m]
  [[nodiscard]] double peak_force() const;         ///< of any axis, at the load cell [N]
  [[nodiscard]] double peak_speed() const;         ///< of any axis [m/s]
};

/// Runs a hybrid test in closed loop: a computed structure and a bearing in the machine.
Record run_test(const Excitation& excitation, const Physics& physics, const ChannelNoise& noise,
                Random random);

}  // namespace trial
