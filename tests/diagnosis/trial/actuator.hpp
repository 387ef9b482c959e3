// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "specimen.hpp"

namespace trial {

/// Two horizontal actuators with their servo loops: transport delay, then
///     x'' = ω² (c - x) - 2 ζ ω x',
/// then what stands between the piston and the platen.
class Actuator {
 public:
  Actuator(const Physics& physics, double step);

  /// @param command  towards which the controller's ramp has come at the end of this step; it
  /// reaches what was sent one sample later, which is part of the transport delay [m]
  /// @param load  that the platen resists with, inertia left out [N]
  void advance(const Plane& command, const Plane& load);

  /// How the platen moves.
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
