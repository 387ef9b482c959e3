// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::diagnosis {

/// Natural sizes of a component of a dynamic model: units of its terms' parameters [SI].
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
  PerWork,  ///< 1 per force and displacement
  Peak,     ///< of the signal
  Rms,
  Rate,  ///< largest rate of the signal
  TimeStep,
  Period,  ///< of the component's motion
  One
};
[[nodiscard]] double size_of(NaturalUnit unit, const Natural& natural);

/// A parameter that a candidate frees or fixes.
struct ParameterChoice {
  enum Role {
    Size,   ///< the term has no effect at 0, or for a gain at 1
    Shape,  ///< form of the effect: from a tenth to ten times its starts
    Stated  ///< not free: has the first start as its value
  };
  const char* name;
  NaturalUnit unit;
  std::vector<double> starts;  ///< in its natural unit
  Role role = Size;
};

/// A kind of the catalogue as a candidate.
struct KindChoice {
  const char* kind;
  std::vector<ParameterChoice> choices;
  /// Simpler kinds, which are named first.
  std::vector<std::string> after = {};  // NOLINT(readability-redundant-member-init)
};

/// Kinds between two points of a model, on its inputs, and on its outputs.
[[nodiscard]] const std::vector<KindChoice>& connection_kinds();
[[nodiscard]] const std::vector<KindChoice>& input_kinds();
[[nodiscard]] const std::vector<KindChoice>& output_kinds();

}  // namespace rths::diagnosis
