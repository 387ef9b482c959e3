// SPDX-License-Identifier: Apache-2.0
#include "dynamic_model.hpp"

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

#include "dynamic_simulator.hpp"

namespace rths::diagnosis {
namespace {

const std::string& name_of(const ModelTerm& term) {
  return term.settings.name.empty() ? term.settings.kind : term.settings.name;
}

// A term's name may be preceded by its component.
bool is_named(const ModelTerm& term, const std::string& name) {
  return name_of(term) == name || fmt::format("{}.{}", term.component, name_of(term)) == name;
}

[[noreturn]] void fail_unknown(const DynamicModel& model, const std::vector<ModelTerm>& terms,
                               const std::string& name) {
  std::vector<std::string> known;
  for (const auto& parameter : model.parameters) known.push_back(parameter.name);
  for (const auto& term : terms)
    for (const auto& parameter : sim::term_kind(term.settings.kind).parameters)
      known.push_back(fmt::format("{}.{}", name_of(term), parameter.name));
  throw Error{
      fmt::format("the model has no parameter '{}'{}", name, did_you_mean_one_of(name, known))};
}

}  // namespace

LinearSystem LinearSystem::zeros(Index states, Index inputs, Index outputs, Index connections) {
  LinearSystem system;
  system.a = MatrixXd::Zero(states, states);
  system.b = MatrixXd::Zero(states, inputs);
  system.e = MatrixXd::Zero(states, connections);
  system.c = MatrixXd::Zero(outputs, states);
  system.d = MatrixXd::Zero(outputs, inputs);
  system.h = MatrixXd::Zero(outputs, connections);
  system.p = system.r = MatrixXd::Zero(connections, states);
  system.q = system.s = system.t = MatrixXd::Zero(connections, inputs);
  system.stiffness = system.damping = VectorXd::Zero(connections);
  return system;
}

VectorXd DynamicModel::values() const {
  VectorXd result(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < result.size(); ++i)
    result[i] = parameters[static_cast<std::size_t>(i)].value;
  return result;
}

ParameterIndex find_parameter(const DynamicModel& model, const std::vector<ModelTerm>& terms,
                              const std::string& name) {
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (model.parameters[i].name == name) return {i, 0, ""};
  const auto dot = name.rfind('.');
  const std::string term = name.substr(0, dot);
  std::optional<ParameterIndex> found;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!is_named(terms[i], term)) continue;
    if (found)
      throw Error{
          fmt::format("there are several parameters '{}', expected the component before it, "
                      "as in '{}.{}'",
                      name, terms[i].component, name)};
    found = ParameterIndex{std::nullopt, i, dot == std::string::npos ? "" : name.substr(dot + 1)};
    static_cast<void>(parameter_of(sim::term_kind(terms[i].settings.kind), found->parameter));
  }
  if (!found) fail_unknown(model, terms, name);
  return *found;
}

}  // namespace rths::diagnosis
