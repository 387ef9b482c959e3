// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <rths/identification/vectors.hpp>
#include <rths/sim/composition.hpp>

#include "unit_scales.hpp"

namespace rths::diagnosis {

/// Terms at one component of a model, with their free parameters. They form a composition on one
/// axis, in the component's own units.
class ComponentTerms {
 public:
  struct Free {
    std::size_t parameter;  ///< of the composition
    Index free;             ///< of the hypothesis
    double scale;           ///< SI per unit
  };

  ComponentTerms() = default;
  /// @param terms  in SI; their names must differ
  /// @throws Error if the terms do not form a composition   @setup
  ComponentTerms(const std::vector<sim::TermSettings>& terms, const UnitScales& scales,
                 double time_step);

  [[nodiscard]] const sim::Composition& composition() const { return composition_; }
  [[nodiscard]] const UnitScales& scales() const { return scales_; }
  /// Binds a parameter to a free one. @throws Error if no parameter has this name   @setup
  void bind(const std::string& term, const std::string& parameter, Index free);
  [[nodiscard]] const std::vector<Free>& free() const { return free_; }

  /// Parameters of the composition for values of the hypothesis' free parameters [SI].
  template <class Real>
  [[nodiscard]] std::vector<Real> parameters(const std::vector<Real>& values) const {
    std::vector<Real> result(composition_.parameters().begin(), composition_.parameters().end());
    for (const auto& [parameter, free, scale] : free_)
      result[parameter] = values[static_cast<std::size_t>(free)] * (1 / scale);
    return result;
  }

 private:
  UnitScales scales_;
  sim::Composition composition_;
  std::vector<Free> free_;
};

/// Applies a chain of terms to a signal, one after the other. The signal is a displacement for
/// terms of the stages actuator and motion, and a force for sensor terms.
/// @param signal  changed in place [SI]
/// @param values  of the hypothesis' free parameters [SI]
void pass(const ComponentTerms& chain, const std::vector<double>& values, double start,
          std::vector<double>& signal);
void pass(const ComponentTerms& chain, const std::vector<sim::Dual>& values, double start,
          std::vector<sim::Dual>& signal);

/// Prepares the terms of a chain for `ComponentTerms`: limits them to one axis, and adds a unit
/// spring that turns the signal from a displacement into a force.
[[nodiscard]] std::vector<sim::TermSettings> as_chain(std::vector<sim::TermSettings> terms);

/// Terms of a connection whose linear spring and damper belong to the linear system.
struct ConnectionTerms {
  std::vector<sim::TermSettings> terms;
  /// The terms include the spring and damper. A term that changes the motion (play) must act on
  /// them too, so they become terms, named kLinearSpring and kLinearDamper.
  bool holds_linear = false;
};
/// Prepares the terms of a connection. @throws Error for a term that is not a force between two
/// points   @setup
[[nodiscard]] ConnectionTerms as_connection(std::vector<sim::TermSettings> terms);

inline constexpr std::string_view kLinearSpring = "its stiffness";
inline constexpr std::string_view kLinearDamper = "its damping";

}  // namespace rths::diagnosis
