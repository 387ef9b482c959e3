// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "specimen.hpp"

namespace trial {

/// Two horizontal actuators with their servo loops: transport delay, then
///     x'' = ω² (c - x) - 2 ζ ω x',
/// then the oil column and the compliance between piston and platen.
class Actuator {
 public:
  Actuator(const Physics& physics, double step);

  /// @param command  value of the controller's ramp at the end of this step; the ramp reaches the
  /// sent command one sample later, which the transport delay includes [m]
  /// @param load  resistance of the platen without its inertia [N]
  void advance(const Plane& command, const Plane& load);

  /// Motion of the platen.
  struct Motion {
    Plane displacement{}, velocity{}, acceleration{};
  };
  [[nodiscard]] const Motion& platen() const { return platen_; }

 private:
  struct Lag {
    double value = 0, rate = 0, acceleration = 0;
  };
  [[nodiscard]] Plane delayed(const Plane& command);
  [[nodiscard]] double servo(const Lag& piston, double command) const;
  void advance_piston(Lag& piston, double before, double command) const;
  void advance_oil(Lag& oil, const Lag& piston) const;
  void advance_yielding(std::size_t axis, double acceleration, double load);

  Physics physics_;
  double step_, frequency_;
  std::vector<Plane> sent_;
  std::size_t newest_ = 0;
  Plane reference_{};
  std::array<Lag, 2> piston_{}, oil_{}, yielding_{};
  Motion platen_;
};

}  // namespace trial
