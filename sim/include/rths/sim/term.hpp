// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include <rths/core/realtime.hpp>
#include <rths/sim/dual.hpp>

namespace rths::sim {

inline constexpr int kHorizontalAxes = 2;  ///< long, lat

template <class Real>
using Horizontal = std::array<Real, kHorizontalAxes>;  ///< long, lat

/// Inputs and outputs of terms in one time step. `Real` is double, or Dual for derivatives with
/// respect to parameters.
///
/// A composition passes one of these through its terms in the catalogue's order: actuator, mount,
/// specimen, machine, sensors. Each term reads the results of the terms before it.
template <class Real>
struct Quantities {
  double time = 0;                                              ///< any origin [s]
  Horizontal<Real> displacement{}, velocity{}, acceleration{};  ///< [m], [m/s], [m/s²]
  Real vertical_displacement{}, vertical_velocity{};  ///< > 0 lengthens the specimen [m], [m/s]
  Real axial_load{};   ///< > 0 compresses [N]; an input, or computed by a vertical term
  Real temperature{};  ///< ambient, above the reference [°C]
  Real auxiliary{};    ///< control input of a device: the current of a damper [A]

  // Effects of modifiers on the specimen.
  /// Factor on characteristic strength or friction; the stiffness before yield has its own [-].
  Real strength{1};
  Real stiffness{1};           ///< factor on the stiffness after yield [-]
  Real elastic_stiffness{1};   ///< factor on the stiffness before yield [-]
  Real vertical_stiffness{1};  ///< factor [-]
  Real buckling_load{};        ///< critical axial load, > 0 [N]; 0: none

  Horizontal<Real> force{};                  ///< resisting the motion, of all terms so far [N]
  Horizontal<Real> hysteretic_force{};       ///< dissipative component: lead plug, slider [N]
  Horizontal<Real> last_hysteretic_force{};  ///< the same, one step before [N]
  Horizontal<Real> last_specimen_force{};    ///< `force` after the specimen, one step before [N]
};

/// Position of a term in the composition. Motion terms change the specimen's motion only; Machine
/// and Sensor terms act on the platen's motion, which drives the guides and is measured.
enum class Stage {
  Actuator,   ///< command → displacement
  Motion,     ///< displacement of the platen → displacement of the specimen
  Vertical,   ///< vertical displacement → axial load
  Modifier,   ///< factors on the specimen's strength and stiffness
  Restoring,  ///< the specimen's force
  Machine,    ///< forces between specimen and load cell
  Sensor,     ///< physical quantity → measurement
};

/// The measured quantity that a sensor term acts on.
enum class SensorChannel { Force, Displacement, Acceleration, AxialLoad };

/// A parameter of a term. In a configuration its key is name_unit: "characteristic_strength_N".
struct Parameter {
  std::string_view name;
  std::string_view unit;  ///< "N/m", "-", or one that begins with kChannelUnit: "channel/s"
  double low, high;       ///< bounds
  double absent;          ///< default: no effect, or the usual shape
  double typical;         ///< start value of a fit
};
inline constexpr std::string_view kChannelUnit = "channel";

/// Properties of a kind. Tests verify them.
enum Trait : unsigned {
  kPlain = 0,
  kDissipative = 1,       ///< from rest, it never returns more work than it absorbed
  kFrameIndifferent = 2,  ///< rotating the motion rotates its force
  kPerAxis = 4,           ///< the axes are independent; the term may act on one of them alone
  kPerChannel = 8,        ///< a sensor term that acts on one channel
  kControlled = 16,       ///< reads `auxiliary`
  kMount = 32,            ///< the specimen moves by its own force, that of the step before
  kInertial = 64,         ///< a mass that moves with the platen: a machine adds it to its own
  kDelaysCommand = 128,   ///< shifts the motion in time
  kConstant = 256,        ///< adds a constant to a measurement
  kRounds = 512,          ///< its error is part of the noise
  kOverflows = 1024,      ///< begins again beyond its range, after all other effects
};

/// Parameters, constants and state of one term of a composition.
template <class Real>
struct TermView {
  const Real* parameters;   ///< in the order of the kind's table
  const double* constants;  ///< made by `prepare`
  Real* state;              ///< all zeros in the virgin state
  double time_step;         ///< [s]
  unsigned axes;            ///< bit 0: long, bit 1: lat
  SensorChannel channel;

  [[nodiscard]] bool acts_on(std::size_t axis) const { return (axes >> axis & 1U) != 0; }
};

/// Inputs for sizing and preparing a term.
struct TermSetup {
  std::span<const double> parameters;
  std::span<const Parameter> table;  ///< of the kind, with bounds
  double time_step;                  ///< [s]
};

/// Number of states and constants of a term.
struct TermSize {
  std::size_t states = 0, constants = 0;
};

/// One kind of physics: its name, equation, parameters and step functions.
struct TermKind {
  std::string_view name;   ///< in configurations and verdicts: "lead_heating"
  std::string_view title;  ///< "lead-core heating"
  std::string_view equation;
  std::string_view source;
  Stage stage;
  unsigned traits;
  std::span<const Parameter> parameters;
  TermSize (*size)(const TermSetup&);
  void (*prepare)(const TermSetup&, std::span<double> constants);  ///< @setup
  void (*step)(const TermView<double>&, Quantities<double>&) RTHS_REALTIME;
  void (*step_dual)(const TermView<Dual>&, Quantities<Dual>&) RTHS_REALTIME;
};

/// Every kind, in the order in which terms act.
[[nodiscard]] std::span<const TermKind> catalogue();

/// @throws Error naming the nearest known kind   @setup
[[nodiscard]] const TermKind& term_kind(std::string_view name);
/// Whether a kind has a trait. @throws Error as `term_kind`   @setup
[[nodiscard]] bool has_trait(std::string_view kind, Trait trait);
/// Whether a term may be limited to one axis: the axes are independent, or it is a law of the
/// specimen's force, which then sees the motion of this axis alone.
[[nodiscard]] bool may_act_on_one_axis(const TermKind& kind);
/// @throws Error if the kind has no parameter of this name   @setup
[[nodiscard]] const Parameter& parameter_of(const TermKind& kind, std::string_view name);

}  // namespace rths::sim
