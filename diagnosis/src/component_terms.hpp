// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <rths/sim/composition.hpp>

#include "unit_scales.hpp"

namespace rths::diagnosis {

/// Terms at one component of a model, as a composition on one axis in units of its own, and which
/// of their parameters are free.
class ComponentTerms {
 public:
  struct Free {
    std::size_t parameter;  ///< of the composition
    Eigen::Index free;      ///< of the hypothesis
    double scale;           ///< SI per unit
  };

  ComponentTerms() = default;
  /// @param terms  in SI; their names must differ
  /// @throws Error if they cannot stand here   @setup
  ComponentTerms(const std::vector<sim::TermSettings>& terms, const UnitScales& scales,
                 double time_step);

  [[nodiscard]] const sim::Composition& composition() const { return composition_; }
  [[nodiscard]] const UnitScales& scales() const { return scales_; }
  /// Lets a parameter follow a free one. @throws Error if there is none of this name   @setup
  void bind(const std::string& term, const std::string& parameter, Eigen::Index free);
  [[nodiscard]] const std::vector<Free>& free() const { return free_; }

  /// Parameters of the composition at values of the hypothesis' free ones [SI].
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

/// Terms through which a signal passes, one after the other. It poses as a displacement where the
/// catalogue's terms move things, and as a force where they measure.
/// @param signal  changed in place [SI]
/// @param values  of the hypothesis' free parameters [SI]
void pass(const ComponentTerms& chain, const std::vector<double>& values, double start,
          std::vector<double>& signal);
void pass(const ComponentTerms& chain, const std::vector<sim::Dual>& values, double start,
          std::vector<sim::Dual>& signal);

/// The terms of a chain, ready for `ComponentTerms`: on one axis, the signal made a force in the
/// middle.
[[nodiscard]] std::vector<sim::TermSettings> as_chain(std::vector<sim::TermSettings> terms);

/// The terms of a connection whose linear spring and damper are known elsewhere. If one of them
/// changes the motion itself (play), spring and damper must see that too: they are put in here, as
/// the first two bound parameters, and `holds_linear` says so.
struct ConnectionTerms {
  std::vector<sim::TermSettings> terms;
  bool holds_linear = false;
};
[[nodiscard]] ConnectionTerms as_connection(std::vector<sim::TermSettings> terms);

inline constexpr std::string_view kLinearSpring = "its stiffness";
inline constexpr std::string_view kLinearDamper = "its damping";

}  // namespace rths::diagnosis
