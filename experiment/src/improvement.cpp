// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/improvement.hpp>

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::experiment {
namespace {

// Terms of a diagnosis for "specimen" or "machine". Added terms are enabled even if the model
// disables them.
Config found_in(const Config& improvement, const char* side) {
  Config terms = improvement.table_or_empty(side);
  for (const auto& name : terms.keys()) {
    if (!terms.is_table(name)) continue;
    Config term = terms.table(name);
    if (term.has("kind") && !term.has("enabled")) term.set("enabled", "true");
    terms.set(name, term);
  }
  return terms;
}

// A parameter of the machine that is a term of the model. `parameter` has one number for both axes,
// or [long, lat].
struct AxisTerm {
  const char* term;
  const char* parameter;
  const char* key;  ///< of the machine
};
constexpr AxisTerm kAxisTerms[] = {{"platen_inertia", "mass_kg", "effective_mass_kg"},
                                   {"force_offset", "offset_N", "force_offset_N"}};

const AxisTerm* axis_term(const std::string& name) {
  const auto known = std::find_if(std::begin(kAxisTerms), std::end(kAxisTerms),
                                  [&](const AxisTerm& one) { return one.term == name; });
  return known == std::end(kAxisTerms) ? nullptr : known;
}

std::vector<double> of_both_axes(const Config& term, const std::string& parameter) {
  if (!term.is_array(parameter))
    return std::vector<double>(sim::kHorizontalAxes, term.number(parameter));
  const auto values = term.numbers(parameter);
  if (values.size() != sim::kHorizontalAxes)
    term.fail(parameter,
              fmt::format("{} has {} numbers, expected [long, lat]", parameter, values.size()));
  return values;
}

// Converts refitted terms of the machine from names of the model. There, inertia and force offset
// are terms, and terms whose names the specimen uses have a prefix.
Config as_machine(const Config& found) {
  Config machine = found;
  for (const auto& name : found.keys()) {
    if (!found.is_table(name) || found.table(name).has("kind")) continue;
    const Config term = found.table(name);
    const AxisTerm* of_axes = axis_term(name);
    const bool is_renamed = name.starts_with(kMachinePrefix);
    if (of_axes == nullptr && !is_renamed) continue;
    machine = machine.without(name);
    if (of_axes != nullptr)
      machine.put(of_axes->key, of_both_axes(term, of_axes->parameter));
    else
      machine.set(name.substr(kMachinePrefix.size()), term);
  }
  return machine;
}

// Overlays the improved.toml files of `improvement`; later files override earlier ones.
Config files_of(const Config& table) {
  Config improvement;
  for (const auto& file : table.texts("improvement", {})) {
    const Config found = Config::load(table.resolve(file));
    const Config terms = Config{}
                             .overlaid(found.table_or_empty("specimen"))
                             .overlaid(found.table_or_empty("machine"));
    if (terms.keys().empty())
      throw Error{
          fmt::format("{}: found no term, expected a term in [specimen] or [machine]", file)};
    found.reject_unknown_keys();
    improvement = improvement.overlaid(found);
  }
  return improvement;
}

}  // namespace

Improvement read_improvement(const Config& model, const std::string& text) {
  Config terms = files_of(model);
  if (!text.empty()) terms = terms.overlaid(Config::parse(text, "improved.toml"));
  return {found_in(terms, "specimen"), as_machine(found_in(terms, "machine"))};
}

std::vector<std::filesystem::path> improvements_of(const std::filesystem::path& experiment,
                                                   const Overrides& changes) {
  const Config model = changed_experiment(experiment, changes).table_or_empty("model");
  std::vector<std::filesystem::path> files;
  for (const auto& file : model.texts("improvement", {})) files.push_back(model.resolve(file));
  return files;
}

Overrides improved_by(const std::vector<std::filesystem::path>& files,
                      const std::filesystem::path& experiment, Overrides changes) {
  if (files.empty()) return changes;
  auto all = improvements_of(experiment, changes);
  all.insert(all.end(), files.begin(), files.end());
  std::vector<std::string> paths;
  for (const auto& file : all) paths.push_back(std::filesystem::weakly_canonical(file).string());
  changes.emplace_back("model.improvement", toml_list(paths));
  return changes;
}

}  // namespace rths::experiment
