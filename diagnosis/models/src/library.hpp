// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include <rths/identification/hypothesis.hpp>
#include <rths/sim/term.hpp>

namespace rths::diagnosis {

/// Typical sizes in a recording. They are the units of a term's parameters in the library, so that
/// one library serves a bearing of 1.5 MN and a guide of 20 N.
struct NaturalScale {
  double displacement = 1;  ///< peak [m]
  double velocity = 1;      ///< peak [m/s]
  double acceleration = 1;  ///< peak [m/s²]
  double force = 1;         ///< peak of the predicted force [N]
  double axial_load = 0;    ///< mean; 0: not recorded [N]
  double duration = 1;      ///< [s]
  double output = 1;        ///< peak of the predicted channel [its unit]
  double auxiliary = 0;     ///< peak; 0: not recorded
  bool has_temperature = false;
};

/// Relation in which a kind of the catalogue is searched for.
enum class Target { Force, Actuator, Accelerometer };

/// How the library fits a parameter of a kind. Values are in natural units, except those in seconds
/// or without a unit.
struct ParameterSpecification {
  std::string_view parameter;
  enum class Role { Size, Shape, Fixed } role = Role::Size;
  std::array<double, 3> starts{};  ///< initial values of fits; of Fixed: the value
  int start_count = 1;
  double low = 0, high = 0;  ///< bounds; low = high: those of the catalogue
  bool each_axis = false;    ///< one value for each axis
};

/// A kind of term that may be missing.
struct Entry {
  std::string_view kind;
  std::string_view name;  ///< in verdicts; empty: that of the kind
  Target target;
  enum Needs : unsigned {
    kNothing = 0,
    kAxialLoad = 1,
    kTwoAxes = 2,
    kTemperature = 4,
    kAuxiliary = 8,
    kAcceleration = 16,
    kHysteresis = 32,  ///< a hysteretic term in the model, for a modifier
    kSlider = 64,
    kKindInModel = 128,      ///< a term of this kind in the model, with a wrong parameter
    kNoHysteresis = 256,     ///< no hysteretic term in the model
    kLoadCell = 512,         ///< recorded forces of the actuators
    kNoServoLoop = 1024,     ///< no actuator in the model whose loop has limits of its own
    kHidden = 2048,          ///< (no need) see Candidate::is_hidden
    kRule = 4096,            ///< bouc_wen in the model, with a wrong hysteresis rule
    kInstead = 8192,         ///< (no need) replaces bouc_wen, with its parameters and more
    kBeside = 16384,         ///< (no need) a second term of a kind that the model has
    kControlledTerm = 32768  ///< a term in the model that reads the control input
  };
  unsigned needs;
  std::vector<ParameterSpecification> parameters;
  // NOLINTNEXTLINE(readability-redundant-member-init): entries may omit it
  std::string_view title = {};  ///< empty: that of the kind
};

[[nodiscard]] std::span<const Entry> library();

/// SI value of a parameter's natural unit, from its unit in the catalogue.
[[nodiscard]] double natural_unit(std::string_view unit, const NaturalScale& scale);

/// Returns true for a specimen with a loop, whose strength modifiers change.
[[nodiscard]] bool is_hysteretic(std::string_view kind);

/// Candidates of all entries that are not in the model yet and whose needs the recording meets.
/// @param axes  predicted axes
/// @param axis_scales  of each predicted axis, for effects on that axis alone; in the order of axes
/// @param without  kinds that may not be named
[[nodiscard]] std::vector<Candidate> candidates_of(Target target, const Hypothesis& base,
                                                   const NaturalScale& scale,
                                                   const std::vector<std::size_t>& axes,
                                                   const std::vector<NaturalScale>& axis_scales,
                                                   const std::vector<std::string>& without);

/// Indices of the terms to which a parameter's name refers, and the parameter's own name. The name
/// "friction.force" refers to the term "friction", or to "friction.long" and "friction.lat".
[[nodiscard]] std::pair<std::vector<std::size_t>, std::string> meant_by(
    const std::string& parameter, const std::vector<ModelTerm>& terms);

}  // namespace rths::diagnosis
