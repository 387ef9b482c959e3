// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <rths/sim/composition.hpp>

namespace rths::diagnosis {

/// How a candidate fits a parameter of its kind. Values are in the natural units of the place where
/// it acts (natural_unit).
struct CandidateParameter {
  enum class Role {
    Size,    ///< the term has no effect at 0, or for a gain at 1
    Shape,   ///< form of the effect
    Fixed,   ///< not fitted: has the first start as its value
    Typical  ///< not fitted: has the catalogue's typical value
  };
  std::string_view name;
  Role role = Role::Size;
  std::vector<double> starts;  ///< initial values of fits
  double low = 0, high = 0;    ///< bounds; low = high: those of the catalogue
  bool each_axis = false;      ///< one value for each axis
};

/// Where a candidate acts.
enum Place : unsigned {
  // In a composition that measured motion drives:
  kOnForce = 1,          ///< of specimen, machine and load cell
  kOnActuator = 2,       ///< between command and displacement
  kOnAccelerometer = 4,  ///< between displacement and acceleration
  // In a model that runs freely:
  kOnConnection = 8,  ///< between two of its points
  kOnInput = 16,
  kOnOutput = 32
};

/// A kind of the catalogue that may be missing at some places, with all that its search needs.
struct CandidateTerm {
  std::string_view kind;
  std::string_view name;  ///< in verdicts; empty: that of the kind
  unsigned places;
  enum Needs : unsigned {
    kNothing = 0,
    kAxialLoad = 1,
    kTwoAxes = 2,
    kTemperature = 4,
    kAuxiliary = 8,
    kAcceleration = 16,  ///< a moving mass
    kHysteresis = 32,    ///< a hysteretic term in the model, for a modifier
    kSlider = 64,
    kKindInModel = 128,       ///< a term of this kind in the model, with a wrong parameter
    kNoHysteresis = 256,      ///< no hysteretic term in the model
    kLoadCell = 512,          ///< recorded forces of the actuators
    kNoServoLoop = 1024,      ///< no actuator in the model whose loop has limits of its own
    kHidden = 2048,           ///< (no need) see Candidate::is_hidden
    kRule = 4096,             ///< bouc_wen in the model, with a wrong hysteresis rule
    kInstead = 8192,          ///< (no need) replaces bouc_wen, with its parameters and more
    kBeside = 16384,          ///< (no need) a second term of a kind that the model has
    kControlledTerm = 32768,  ///< a term in the model that reads the control input
    kSpring = 65536,          ///< a linear spring: play in series with it is possible
    kBucklingLoad = 131072,   ///< a term in the model that computes the buckling load
    kCorrectsForm = 262144    ///< (no need) see Candidate::corrects_form
  };
  unsigned needs;
  std::vector<CandidateParameter> parameters;
  // NOLINTBEGIN(readability-redundant-member-init): entries may omit these
  std::string_view title = {};  ///< empty: that of the kind
  /// Special cases of it: no alternatives to it.
  std::vector<std::string_view> contains = {};
  // NOLINTEND(readability-redundant-member-init)
  bool waits = false;     ///< it is named only if none of its special cases is acceptable
  bool is_exact = false;  ///< its form has no error, such as that of a wrapped number
  /// Kinds whose fitted sizes in the model it may replace: they are special cases of it.
  std::vector<std::string_view> replaces = {};  // NOLINT(readability-redundant-member-init)
};

[[nodiscard]] std::span<const CandidateTerm> candidate_terms();

/// Whether an effect depends on rates or times, so that rows without time cannot show it.
[[nodiscard]] bool needs_time(const CandidateTerm& entry);
/// The same of a term with its values.
[[nodiscard]] bool needs_time(const sim::TermSettings& term);
/// The speed at which friction turns: without time it turns at once.
inline constexpr std::string_view kCreepVelocity = "creep_velocity";

/// Kinds of the catalogue that are not searched for, and why.
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>> terms_not_searched();

/// Candidates of compositions that are not searched for in models that run freely, and why.
[[nodiscard]] std::span<const std::pair<std::string_view, std::string_view>>
terms_not_searched_freely();

}  // namespace rths::diagnosis
