// SPDX-License-Identifier: Apache-2.0
#include "dynamic_reading.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

Hold read_hold(const Config& table) {
  const std::string hold = table.text("hold", "linear");
  if (hold == "linear") return Hold::Linear;
  if (hold == "zero") return Hold::Zero;
  if (hold == "smooth") return Hold::Smooth;
  table.fail("hold", fmt::format("hold is '{}', expected linear, zero or smooth", hold));
}

bool is_free(const Config& table) {
  const std::string initial = table.text("initial", "rest");
  if (initial != "rest" && initial != "free")
    table.fail("initial", fmt::format("initial is '{}', expected rest or free", initial));
  return initial == "free";
}

}  // namespace

std::vector<ModelTerm> read_model_terms(const Config& table, const std::string& component) {
  std::vector<ModelTerm> terms;
  for (auto& term : sim::read_terms(table, sim::TermOwner::Any, sim::ParameterBounds::None))
    terms.push_back({std::move(term), component});
  return terms;
}

void read_common(const Config& table, DynamicModel& model) {
  model.hold = read_hold(table);
  model.has_free_start = is_free(table);
  model.substeps = static_cast<int>(table.integer_in("steps_per_sample", 0, 1024, 0));
  std::vector<std::string> components = model.inputs;
  components.insert(components.end(), model.outputs.begin(), model.outputs.end());
  for (const auto& connection : model.connections) components.push_back(connection.component);
  const Config terms = table.table_or_empty("terms");
  for (const auto& component : terms.keys()) {
    if (std::find(components.begin(), components.end(), component) == components.end())
      terms.fail(component,
                 fmt::format("there is no component '{}' for terms, expected one of \"{}\"",
                             component, fmt::join(components, "\", \"")));
    const auto own = read_model_terms(terms.table(component), component);
    model.terms.insert(model.terms.end(), own.begin(), own.end());
  }
  finish(table);
}

std::vector<RoleAssignment> read_assignments(const Config& table) {
  std::vector<RoleAssignment> assignments;
  for (const auto& key : table.keys()) {
    std::istringstream text{table.text(key)};
    assignments.push_back({key, {}});
    for (std::string word; std::getline(text, word, '.');) assignments.back().words.push_back(word);
    if (assignments.back().words.empty()) table.fail(key, fmt::format("{} is empty", key));
  }
  if (assignments.empty()) throw Error{fmt::format("{}: the table is empty", table.where())};
  return assignments;
}

Index read_index(const Config& table, const std::string& key, const std::string& word,
                 std::size_t most, const std::string& name) {
  std::size_t number = 0;
  const auto [end, trouble] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (trouble != std::errc{} || end != word.data() + word.size() || number < 1 || number > most)
    table.fail(key, fmt::format("'{}' is not a {}, expected 1 to {}", word, name, most));
  return static_cast<Index>(number) - 1;
}

void finish(const Config& table) {
  static_cast<void>(table.text("kind", ""));
  static_cast<void>(table.text("anchor", ""));
  static_cast<void>(table.texts("fitted", {}));
  static_cast<void>(table.table_or_empty("bounds"));
  static_cast<void>(table.table_or_empty("values"));
  table.reject_unknown_keys();
}

}  // namespace rths::diagnosis
