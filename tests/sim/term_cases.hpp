// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::sim {
/// The parameter of a test, in its name.
inline void PrintTo(const TermKind& kind, std::ostream* out) { *out << kind.name; }
}  // namespace rths::sim

namespace rths::sim::test_support {

/// Test motion of the terms: a sum of sines with incommensurate frequencies per axis, so that
/// directions and amplitudes vary. Load and vertical motion vary too.
struct Motion {
  double amplitude = 0.15;            ///< of each axis, at most [m]
  double frequency = 0.4;             ///< of the slowest sine [Hz]
  double axial_load = 9.7e6;          ///< mean [N]
  double axial_load_variation = 0.3;  ///< of the mean [-]
  double vertical_offset = -2e-3;     ///< [m]
  double vertical_amplitude = 1e-3;   ///< [m]
  double temperature = 0;             ///< amplitude of the ambient temperature [°C]
  double auxiliary = 0.5;             ///< mean and amplitude of the control current [A]
  double time_step = 5e-3;            ///< [s]
  int steps = 800;
};

/// Inputs at step `i`; everything else zero.
[[nodiscard]] Quantities<double> motion_at(const Motion& motion, int i);

/// Test case of a kind: the term with typical parameters and companions that make its effect
/// visible.
struct TermCase {
  std::string kind;
  TermSettings term;                     ///< omitted parameters are typical, not absent
  std::vector<TermSettings> companions;  ///< other terms of the composition
  std::vector<std::string> fixed;        ///< parameters that a fit does not vary, e.g. dimensions
  Motion motion;
  double noise = 0.01;  ///< standard deviation relative to that of each output
  double start = 0.1;   ///< relative error of a fit's start values
};

/// The paper's lead-rubber bearing, a usual companion.
[[nodiscard]] TermSettings lead_rubber();

/// The case of a kind: from its group's file, or a default for its stage.
[[nodiscard]] TermCase case_of(const TermKind& kind);

/// Cases that differ from the default, one list per group of terms.
[[nodiscard]] std::vector<TermCase> actuator_cases();
[[nodiscard]] std::vector<TermCase> elastomeric_cases();
[[nodiscard]] std::vector<TermCase> hysteresis_cases();
[[nodiscard]] std::vector<TermCase> machine_cases();
[[nodiscard]] std::vector<TermCase> sensor_cases();
[[nodiscard]] std::vector<TermCase> sliding_cases();

/// The term of a case and its companions.
[[nodiscard]] Composition composition_of(const TermCase& c);

/// Outputs of a run, step after step: displacement, acceleration, force of both axes, axial load.
inline constexpr int kOutputs = 7;
template <class Real>
[[nodiscard]] std::vector<Real> outputs_of(const Composition& composition,
                                           std::span<const Real> parameters, const Motion& motion);

}  // namespace rths::sim::test_support
