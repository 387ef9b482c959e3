// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include <rths/sim/term.hpp>

#include "hypothesis.hpp"

namespace rths::diagnosis {

/// What is large and small in a recording: units to measure a term's parameters by, so that one
/// library serves a bearing of 1.5 MN and a guide of 20 N.
struct NaturalScale {
  double displacement = 1;  ///< peak [m]
  double velocity = 1;      ///< peak [m/s]
  double acceleration = 1;  ///< peak [m/s²]
  double force = 1;         ///< peak of what is predicted [N]
  double axial_load = 0;    ///< mean; 0: not recorded [N]
  double duration = 1;      ///< [s]
  double output = 1;        ///< peak of the channel that is predicted [its unit]
  double auxiliary = 0;     ///< peak; 0: not recorded
  bool has_temperature = false;
};

/// Where a kind of the catalogue is looked for.
enum class Place { Force, Actuator, Accelerometer };

/// A parameter of a kind as the library uses it. Values are in natural units, but for those in
/// seconds or without a unit.
struct Knob {
  std::string_view parameter;
  enum class Role { Size, Shape, Fixed } role = Role::Size;
  std::array<double, 3> starts{};  ///< where fits begin; of Fixed: the value
  int start_count = 1;
  double low = 0, high = 0;  ///< bounds; low = high: those of the catalogue
  bool each_axis = false;    ///< one for each axis
};

/// One kind that may be missing.
struct Entry {
  std::string_view kind;
  std::string_view name;  ///< in verdicts; empty: that of the kind
  Place place;
  enum Needs : unsigned {
    kNothing = 0,
    kAxialLoad = 1,
    kTwoAxes = 2,
    kTemperature = 4,
    kAuxiliary = 8,
    kAcceleration = 16,
    kHysteresis = 32,  ///< in the model: something that the modifier modifies
    kSlider = 64,
    kKindInModel = 128,   ///< a parameter of something that is there is not what was assumed
    kNoHysteresis = 256,  ///< in the model
    kLoadCell = 512,      ///< the forces of actuators are known
    kNoServoLoop = 1024,  ///< in the model: an actuator whose loop has limits of its own
    kHidden = 2048,       ///< (no need) see Candidate::is_hidden
    kRule = 4096,         ///< bouc_wen in the model, whose rule is not what was assumed
    kInstead = 8192,      ///< (no need) takes bouc_wen's place, with its parameters and more
    kBeside = 16384       ///< (no need) one more of a kind that is there
  };
  unsigned needs;
  std::vector<Knob> knobs;
  std::string_view title = {};  ///< empty: that of the kind
};

[[nodiscard]] std::span<const Entry> library();

/// Size of a parameter's natural unit, from its unit in the catalogue.
[[nodiscard]] double natural_unit(std::string_view unit, const NaturalScale& scale);

/// Those entries that are not in the model yet and whose needs the recording meets.
/// @param axes  that are predicted
/// @param without  kinds that are left out
[[nodiscard]] std::vector<Candidate> candidates_of(Place place, const Hypothesis& base,
                                                   const NaturalScale& scale,
                                                   const std::vector<std::size_t>& axes,
                                                   const std::vector<std::string>& without);

/// Positions of those terms that a parameter's name means, and the parameter's own name: a term
/// "friction", or "friction.long" and "friction.lat".
[[nodiscard]] std::pair<std::vector<std::size_t>, std::string> meant_by(
    const std::string& parameter, const std::vector<ModelTerm>& terms);

}  // namespace rths::diagnosis
