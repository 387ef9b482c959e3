// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::diagnosis {

/// Sizes of a component in a dynamic model, which parameters of terms there are a part of.
struct Natural {
  double displacement, velocity, acceleration, force, peak, rms, time_step, period;
};

enum class NaturalUnit {
  Displacement,
  Velocity,
  Force,
  Stiffness,  ///< force per displacement
  Quadratic,  ///< force per displacement squared
  Cubic,
  Damping,  ///< force per velocity
  Drag,     ///< force per velocity squared
  Mass,     ///< force per acceleration
  Peak,     ///< of the signal
  Rms,
  Rate,  ///< largest, of the signal
  TimeStep,
  Period,  ///< of what moves there
  One
};
[[nodiscard]] double size_of(NaturalUnit unit, const Natural& natural);

/// A parameter that a candidate frees, or states.
struct ParameterChoice {
  enum Role {
    Size,   ///< 0, or 1 for a gain: the term has no effect
    Shape,  ///< how it acts: within a tenth to ten times its starts
    Stated  ///< not free: the first start is what it is
  };
  const char* name;
  NaturalUnit unit;
  std::vector<double> starts;  ///< parts of its unit
  Role role = Size;
};

/// A kind of the catalogue as a candidate.
struct KindChoice {
  const char* kind;
  std::vector<ParameterChoice> choices;
  std::vector<std::string> after = {};  ///< simpler kinds, which are named first
};

/// Between two points of a model, on its inputs, and on its outputs.
[[nodiscard]] const std::vector<KindChoice>& connection_kinds();
[[nodiscard]] const std::vector<KindChoice>& input_kinds();
[[nodiscard]] const std::vector<KindChoice>& output_kinds();

}  // namespace rths::diagnosis
