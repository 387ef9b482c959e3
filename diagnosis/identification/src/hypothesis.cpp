// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/hypothesis.hpp>

#include <algorithm>
#include <numeric>

#include <rths/core/text.hpp>
#include <rths/sim/term.hpp>

namespace rths::diagnosis {

std::string name_of(Part part) {
  switch (part) {
    case Part::Numerical:
      return "numerical";
    case Part::Actuator:
      return "actuator";
    case Part::Machine:
      return "machine";
    case Part::Bearing:
      return "bearing";
    case Part::Structure:
      return "structure";
    case Part::Sensor:
      break;
  }
  return "sensor";
}

std::string_view last_name(std::string_view parameter) {
  return parameter.substr(parameter.rfind('.') + 1);
}

std::vector<Index> all_of(const Hypothesis& hypothesis) {
  std::vector<Index> all(hypothesis.free.size());
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

std::vector<Index> movable_of(const Hypothesis& hypothesis) {
  std::vector<Index> movable = all_of(hypothesis);
  std::erase_if(movable, [&](Index i) {
    const FreeParameter& free = hypothesis.free[static_cast<std::size_t>(i)];
    return !(free.low < free.high);
  });
  return movable;
}

bool is_same(const Candidate& one, const Candidate& other) {
  return one.name == other.name && one.channel == other.channel;
}

bool is_offset_of_sensor(const Candidate& candidate) {
  return candidate.part == Part::Sensor && !candidate.kind.empty() &&
         sim::has_trait(candidate.kind, sim::kConstant);
}

bool depends_on(const Candidate& candidate, const Candidate& other) {
  return std::any_of(other.adds.begin(), other.adds.end(), [&](const ModelTerm& added) {
    const std::string& name = added.settings.name;
    return std::any_of(candidate.becomes.begin(), candidate.becomes.end(),
                       [&](const auto& becomes) { return becomes.first == name; }) ||
           std::any_of(candidate.frees.begin(), candidate.frees.end(), [&](const auto& free) {
             return free.name.starts_with(name + ".") &&
                    free.name.find('.', name.size() + 1) == std::string::npos &&
                    std::none_of(candidate.adds.begin(), candidate.adds.end(),
                                 [&](const ModelTerm& own) { return own.settings.name == name; });
           });
  });
}

Hypothesis extended(const Hypothesis& hypothesis, const Candidate& candidate,
                    const VectorXd& start) {
  Hypothesis result = hypothesis;
  result.terms.insert(result.terms.end(), candidate.adds.begin(), candidate.adds.end());
  for (const auto& [name, kind] : candidate.becomes)
    for (auto& term : result.terms)
      if (term.settings.name == name) term.settings.kind = kind;
  std::vector<double> values(hypothesis.values.begin(), hypothesis.values.end());
  for (std::size_t i = 0; i < result.free.size(); ++i)
    if (contains(candidate.replaces, result.free[i].name))
      result.free[i].low = result.free[i].high = values[i] = 0;
  for (std::size_t i = 0; i < candidate.frees.size(); ++i) {
    const auto& wanted = candidate.frees[i];
    const auto known = std::find_if(result.free.begin(), result.free.end(),
                                    [&](const auto& free) { return free.name == wanted.name; });
    if (known != result.free.end()) {
      if (known->is_tolerance) *known = wanted;
      continue;
    }
    result.free.push_back(wanted);
    values.push_back(start[static_cast<Index>(i)]);
  }
  result.values = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
  return result;
}

void take_values(const Hypothesis& from, Hypothesis& to) {
  for (std::size_t i = 0; i < to.free.size(); ++i)
    for (std::size_t k = 0; k < from.free.size(); ++k)
      if (to.free[i].name == from.free[k].name)
        to.values[static_cast<Index>(i)] = from.values[static_cast<Index>(k)];
}

bool may_extend(const Hypothesis& hypothesis, const Candidate& candidate) {
  const Hypothesis result = extended(hypothesis, candidate, candidate.starts[0]);
  const auto is_known = [&](const FreeParameter& free) {
    const auto dot = std::min(free.name.rfind('.'), free.name.size());
    return std::all_of(result.terms.begin(), result.terms.end(), [&](const ModelTerm& term) {
      if (term.settings.name != free.name.substr(0, dot)) return true;
      const auto& known = sim::term_kind(term.settings.kind).parameters;
      return std::any_of(known.begin(), known.end(), [&](const auto& parameter) {
        return parameter.name == free.name.substr(dot + 1);
      });
    });
  };
  return std::all_of(result.free.begin(), result.free.end(), is_known);
}

}  // namespace rths::diagnosis
