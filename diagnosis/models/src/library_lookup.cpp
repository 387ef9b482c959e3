// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "library.hpp"
#include "motion_drive.hpp"
#include "unit_scales.hpp"

namespace rths::diagnosis {

double natural_unit(std::string_view unit, const NaturalScale& scale) {
  if (unit == "s") return scale.time;
  if (unit == "kg") return scale.force / scale.acceleration;
  if (unit == "channel/s") return scale.output / scale.duration;
  return UnitScales{scale.displacement, scale.force, scale.displacement / scale.velocity,
                    scale.output, scale.auxiliary}
      .of(unit);
}

std::vector<std::string> replaced_by(const CandidateTerm& entry, const Hypothesis& base) {
  std::vector<std::string> replaced;
  for (const FreeParameter& free : base.free) {
    if (free.is_tolerance || !(free.low < free.high)) continue;
    const auto meant = meant_by(free.name, base.terms).first;
    const sim::TermKind& kind = sim::term_kind(base.terms[meant[0]].settings.kind);
    if (std::find(entry.replaces.begin(), entry.replaces.end(), kind.name) == entry.replaces.end())
      continue;
    if (parameter_of(kind, last_name(free.name)).absent == 0) replaced.push_back(free.name);
  }
  return replaced;
}

std::pair<std::vector<std::size_t>, std::string> meant_by(const std::string& parameter,
                                                          const std::vector<ModelTerm>& terms) {
  const auto dot = parameter.rfind('.');
  if (dot == std::string::npos)
    throw Error{fmt::format("'{}' is not a parameter, expected term.parameter", parameter)};
  const std::string term = parameter.substr(0, dot);
  std::pair<std::vector<std::size_t>, std::string> meant{{}, parameter.substr(dot + 1)};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const std::string& name = terms[i].settings.name;
    bool is_meant = name == term;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
      is_meant = is_meant || name == term + "." + axis_name(axis);
    if (is_meant) meant.first.push_back(i);
  }
  if (meant.first.empty()) throw Error{fmt::format("'{}': there is no term '{}'", parameter, term)};
  return meant;
}

}  // namespace rths::diagnosis
