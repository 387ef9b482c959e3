// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <rths/identification/hypothesis.hpp>
#include <rths/sim/term.hpp>

#include "candidate_terms.hpp"

namespace rths::diagnosis {

/// Typical sizes in a recording, or of a place in a model. They are the units of a candidate's
/// parameters, so that one table serves a bearing of 1.5 MN and a guide of 20 N.
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
  double time = 1;  ///< unit of times: 1 s, a time step or a period [s]
  bool has_time = true;
  std::string auxiliary_unit = "A", auxiliary_name = "current";
};

/// SI value of a parameter's natural unit, from its unit in the catalogue.
/// @throws Error if the unit has an unknown symbol   @setup
[[nodiscard]] double natural_unit(std::string_view unit, const NaturalScale& scale);

/// Returns true for a specimen with a loop, whose strength modifiers change.
[[nodiscard]] bool is_hysteretic(std::string_view kind);

/// Candidates of a composition: all terms of the table that are not in the model yet and whose
/// needs the recording meets.
/// @param axes  predicted axes
/// @param axis_scales  of each predicted axis, for effects on that axis alone; in the order of axes
/// @param without  kinds that may not be named
[[nodiscard]] std::vector<Candidate> candidates_of(Place place, const Hypothesis& base,
                                                   const NaturalScale& scale,
                                                   const std::vector<std::size_t>& axes,
                                                   const std::vector<NaturalScale>& axis_scales,
                                                   const std::vector<std::string>& without);

/// The fitted sizes of a model that an effect includes as special cases.
[[nodiscard]] std::vector<std::string> replaced_by(const CandidateTerm& entry,
                                                   const Hypothesis& base);

/// Indices of the terms to which a parameter's name refers, and the parameter's own name. The name
/// "friction.force" refers to the term "friction", or to "friction.long" and "friction.lat".
[[nodiscard]] std::pair<std::vector<std::size_t>, std::string> meant_by(
    const std::string& parameter, const std::vector<ModelTerm>& terms);

}  // namespace rths::diagnosis
