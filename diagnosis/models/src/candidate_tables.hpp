// SPDX-License-Identifier: Apache-2.0
//
// The tables of candidate_terms.cpp, and the constructors of their rows.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "candidate_terms.hpp"

namespace rths::diagnosis::candidate_tables {

using Parameter = CandidateParameter;

inline constexpr auto kSize = Parameter::Role::Size;
inline constexpr auto kShape = Parameter::Role::Shape;
inline constexpr auto kFixed = Parameter::Role::Fixed;
inline constexpr auto kTypical = Parameter::Role::Typical;
inline constexpr bool kEachAxis = true;
using enum CandidateTerm::Needs;

inline Parameter size(std::string_view parameter, double start, bool each_axis = false) {
  return {parameter, kSize, {start}, 0, 0, each_axis};
}
inline Parameter size(std::string_view parameter, std::vector<double> starts, double low = 0,
                      double high = 0) {
  return {parameter, kSize, std::move(starts), low, high, false};
}
inline Parameter shape(std::string_view parameter, double low, double high,
                       std::vector<double> starts) {
  return {parameter, kShape, std::move(starts), low, high, false};
}
// From a tenth of the smallest start to ten times the largest one.
inline Parameter shape_near(std::string_view parameter, std::vector<double> starts) {
  constexpr double kRange = 10;
  const auto [least, most] = std::minmax_element(starts.begin(), starts.end());
  const double low = *least / kRange, high = *most * kRange;
  return shape(parameter, low, high, std::move(starts));
}
inline Parameter fixed(std::string_view parameter, double value) {
  return {parameter, kFixed, {value}, 0, 0, false};
}

inline Parameter typical(std::string_view parameter) {
  return {parameter, kTypical, {}, 0, 0, false};
}

/// A row: a kind under its own name.
inline CandidateTerm term(std::string_view kind, unsigned places, unsigned needs,
                          std::vector<Parameter> parameters) {
  return {kind, "", places, needs, std::move(parameters)};
}
inline CandidateTerm term(std::string_view kind, unsigned places,
                          std::vector<Parameter> parameters) {
  return term(kind, places, kNothing, std::move(parameters));
}
inline CandidateTerm named(std::string_view name, std::string_view title, CandidateTerm row) {
  row.name = name, row.title = title;
  return row;
}
/// A row with special cases.
inline CandidateTerm including(std::vector<std::string_view> cases, CandidateTerm row) {
  row.contains = std::move(cases);
  return row;
}
/// A row that is named only if none of its special cases is acceptable.
inline CandidateTerm after(std::vector<std::string_view> cases, CandidateTerm row) {
  row.waits = true;
  return including(std::move(cases), std::move(row));
}
/// A row that may also stand in the place of terms that the model has.
inline CandidateTerm replacing(std::vector<std::string_view> kinds, CandidateTerm row) {
  row.replaces = std::move(kinds);
  return row;
}
inline CandidateTerm exact(CandidateTerm row) {
  row.is_exact = true;
  return row;
}

// Share of a loss of strength that also softens the bearing before it yields: unknown, so it is
// fitted.
inline const Parameter kElasticShare = shape("elastic_share", 0, 1, {0.5});

// Elastic displacement of a guide before it slides.
inline const Parameter kPresliding = shape("presliding", 1e-5, 0.3, {0.002});

// In a composition that measured motion drives:
[[nodiscard]] const std::vector<CandidateTerm>& bearing_entries();
[[nodiscard]] const std::vector<CandidateTerm>& rule_and_device_entries();
[[nodiscard]] const std::vector<CandidateTerm>& machine_entries();
[[nodiscard]] const std::vector<CandidateTerm>& sensor_entries();
[[nodiscard]] const std::vector<CandidateTerm>& actuator_entries();
// In a model that runs freely:
[[nodiscard]] const std::vector<CandidateTerm>& connection_entries();
[[nodiscard]] const std::vector<CandidateTerm>& signal_entries();

}  // namespace rths::diagnosis::candidate_tables
