// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "dynamic_simulator.hpp"

namespace rths::diagnosis {

ParameterIndex find_parameter(const DynamicModel& model, const std::vector<ModelTerm>& terms,
                              const std::string& name) {
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (model.parameters[i].name == name) return {i, 0, ""};
  const auto dot = name.rfind('.');
  const std::string term = name.substr(0, dot);
  std::optional<ParameterIndex> found;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto& [settings, component] = terms[i];
    const std::string& own = settings.name.empty() ? settings.kind : settings.name;
    if (own != term && component + "." + own != term) continue;
    if (found)
      throw Error{
          fmt::format("there are several parameters '{}', expected the component before it, "
                      "as in '{}.{}'",
                      name, component, name)};
    found = ParameterIndex{std::nullopt, i, dot == std::string::npos ? "" : name.substr(dot + 1)};
    static_cast<void>(parameter_of(sim::term_kind(settings.kind), found->parameter));
  }
  if (found) return *found;
  std::vector<std::string> known;
  for (const auto& parameter : model.parameters) known.push_back(parameter.name);
  for (const auto& [settings, component] : terms)
    for (const auto& parameter : sim::term_kind(settings.kind).parameters)
      known.push_back(fmt::format("{}.{}", settings.name.empty() ? settings.kind : settings.name,
                                  parameter.name));
  throw Error{fmt::format("the model has no parameter '{}', expected one of {}", name,
                          fmt::join(known, ", "))};
}

}  // namespace rths::diagnosis
