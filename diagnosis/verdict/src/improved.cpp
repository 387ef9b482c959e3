// SPDX-License-Identifier: Apache-2.0
#include "improved.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/text.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/sim/composition.hpp>

namespace rths::diagnosis {
namespace {

// Numbers as short as their fit is exact.
double rounded(double value) {
  constexpr int kDigits = 9;
  return maths::rounded(value, kDigits);
}

std::string prefix_of(const std::string& parameter) {
  const auto dot = parameter.rfind('.');
  return dot == std::string::npos ? "" : parameter.substr(0, dot);
}

// "friction" for "friction.long" and "friction.lat".
std::string without_axis(const std::string& term) {
  for (const Axis axis : kHorizontal)
    if (term.ends_with(std::string{"."} + name_of(axis))) return term.substr(0, term.rfind('.'));
  return term;
}

// Whether the name before a parameter means a term: its own name, or that of both axes.
bool means(const std::string& name, const sim::TermSettings& term) {
  return name == term.name || name == without_axis(term.name);
}

// The free parameter that sets a parameter of a term; null if none does. A tolerance belongs to the
// recording, not to the model.
const FreeParameter* free_of(const Hypothesis& named, const sim::TermSettings& term,
                             std::string_view parameter) {
  for (const auto& free : named.free)
    if (!free.is_tolerance && last_name(free.name) == parameter &&
        means(prefix_of(free.name), term))
      return &free;
  return nullptr;
}

// Value of a parameter: fitted, else stated; nothing if it has neither.
std::optional<double> value_of(const Hypothesis& named, const sim::TermSettings& term,
                               std::string_view parameter) {
  if (const FreeParameter* free = free_of(named, term, parameter))
    return named.values[free - named.free.data()];
  for (const auto& [key, number] : term.parameters)
    if (key == parameter) return number;
  return std::nullopt;
}

// ---- models that consist of terms -----------------------------------------------------------

// Changes of one table of terms: a term, or one for each axis.
struct TermTable {
  std::string key;
  bool is_added = false;
  std::vector<const sim::TermSettings*> terms;
  Config changes;
};

const sim::TermSettings* in_base(const RelationFindings& found, const std::string& name) {
  for (const auto& [settings, component] : found.relation->base().terms)
    if (settings.name == name) return &settings;
  return nullptr;
}

std::vector<TermTable> tables_of(const RelationFindings& found, const Hypothesis& named) {
  std::vector<TermTable> tables;
  for (const auto& [settings, component] : named.terms) {
    const std::string key = without_axis(settings.name);
    auto table = std::find_if(tables.begin(), tables.end(),
                              [&](const TermTable& known) { return known.key == key; });
    if (table == tables.end())
      table = tables.insert(tables.end(), {key, in_base(found, settings.name) == nullptr, {}, {}});
    table->terms.push_back(&settings);
  }
  return tables;
}

// Writes a parameter; as [long, lat] if the axes have values of their own.
void put_parameter(const Hypothesis& named, const sim::Parameter& parameter, TermTable& table) {
  const auto& terms = table.terms;
  const auto is_free = [&](const auto* term) { return free_of(named, *term, parameter.name); };
  if (!table.is_added && std::none_of(terms.begin(), terms.end(), is_free)) return;
  std::vector<double> values;
  bool differs = false;
  for (const auto* term : terms) {
    const auto value = value_of(named, *term, parameter.name);
    if (!value && values.empty()) return;
    values.push_back(rounded(value.value_or(parameter.absent)));
    const FreeParameter* free = free_of(named, *term, parameter.name);
    differs = differs || values.back() != values.front() ||
              (free != nullptr && prefix_of(free->name) != table.key);
  }
  const std::string key = sim::parameter_key(parameter, terms[0]->channel);
  if (values.size() > 1 && differs)
    table.changes.put(key, values);
  else
    table.changes.put(key, values[0]);
}

// The tables that a fit has changed or added.
// @param named  the named model, perhaps with other values
std::vector<TermTable> changed_tables(const RelationFindings& found, const Hypothesis& named) {
  std::vector<TermTable> tables = tables_of(found, named);
  for (auto& table : tables) {
    const sim::TermSettings& term = *table.terms[0];
    const sim::TermKind& kind = sim::term_kind(term.kind);
    const sim::TermSettings* stated = in_base(found, term.name);
    if (table.is_added || stated->kind != term.kind)
      table.changes.put("kind", std::string{kind.name});
    if (table.is_added && table.terms.size() == 1 && term.axes != sim::kBothAxes)
      table.changes.put("axes",
                        std::vector<std::string>{name_of(kHorizontal[term.axes == 1 ? 0 : 1])});
    if (table.is_added && (kind.traits & sim::kPerChannel) != 0)
      table.changes.put("channel", std::string{name_of(term.channel).channel});
    for (const auto& parameter : kind.parameters) put_parameter(named, parameter, table);
  }
  std::erase_if(tables, [](const TermTable& table) { return table.changes.keys().empty(); });
  return tables;
}

// ---- parameters that a second fit may change ------------------------------------------------

// Adds a parameter of a named term to `fitted` and `bounds`.
// @param known  bounds that it has anyway; null: of a model in its own units
void free_in(Config& model, const FreeParameter& free, const std::string& name,
             const sim::Parameter* known) {
  auto fitted = model.texts("fitted", {});
  if (contains(fitted, name)) return;
  fitted.push_back(name);
  model.put("fitted", fitted);
  constexpr double kNoBound = 1e12;
  const bool is_confined = known != nullptr ? free.low > known->low || free.high < known->high
                                            : free.low > -kNoBound || free.high < kNoBound;
  if (!is_confined || !std::isfinite(free.low) || !std::isfinite(free.high)) return;
  Config bounds = model.table_or_empty("bounds");
  bounds.put(name, std::vector<double>{rounded(free.low), rounded(free.high)});
  model.set("bounds", bounds);
}

const sim::Parameter* parameter_of(const std::string& kind, const std::string& name) {
  for (const auto& parameter : sim::term_kind(kind).parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

// An offset among the fitted parameters would be that of each record, not of the model.
bool may_be_fitted(const Candidate& candidate) { return !is_offset_of_sensor(candidate); }

void improve_composition(const RelationFindings& found, Config& model) {
  for (const auto& table : changed_tables(found, found.selection.named)) {
    const bool replaces = table.is_added || !model.is_table(table.key);
    model.set(table.key, replaces ? table.changes : model.table(table.key).overlaid(table.changes));
  }
  for (const auto& round : found.selection.rounds) {
    const Candidate& candidate = round.chosen.candidate;
    for (const auto& free : candidate.frees)
      if (may_be_fitted(candidate) && !free.is_tolerance)
        free_in(model, free, free.name,
                parameter_of(candidate.kind, std::string{last_name(free.name)}));
  }
}

// ---- models of the user's own system --------------------------------------------------------

struct AddedTerm {
  const ModelTerm* term;
  std::string key;  ///< of its table, within its component
};

bool is_same_term(const ModelTerm& one, const ModelTerm& other) {
  return one.component == other.component && one.settings.name == other.settings.name;
}

// The terms that the fit has added, with keys that no other term of their component has.
std::vector<AddedTerm> added_terms(const RelationFindings& found) {
  const auto& base = found.relation->base().terms;
  std::vector<AddedTerm> added;
  for (const auto& term : found.selection.named.terms) {
    if (std::any_of(base.begin(), base.end(), [&](const auto& b) { return is_same_term(term, b); }))
      continue;
    const auto is_taken = [&](const std::string& key) {
      return std::any_of(base.begin(), base.end(),
                         [&](const ModelTerm& other) {
                           return other.component == term.component && other.settings.name == key;
                         }) ||
             std::any_of(added.begin(), added.end(), [&](const AddedTerm& other) {
               return other.term->component == term.component && other.key == key;
             });
    };
    std::string key = term.settings.kind;
    for (int count = 2; is_taken(key); ++count)
      key = fmt::format("{}_{}", term.settings.kind, count);
    added.push_back({&term, key});
  }
  return added;
}

Config table_of(const Hypothesis& named, const AddedTerm& added) {
  const sim::TermSettings& settings = added.term->settings;
  Config table;
  if (added.key != settings.kind) table.put("kind", settings.kind);
  for (const auto& parameter : sim::term_kind(settings.kind).parameters)
    if (const auto value = value_of(named, settings, parameter.name))
      table.put(sim::parameter_key(parameter, settings.channel), rounded(*value));
  return table;
}

// Adds a table to the terms of a component.
void add_term(Config& model, const std::string& component, const std::string& key,
              const Config& table) {
  Config terms = model.table_or_empty("terms");
  Config own = terms.table_or_empty(component);
  own.set(key, table);
  terms.set(component, own);
  model.set("terms", terms);
}

void improve_system(const RelationFindings& found, Config& model) {
  const Hypothesis& named = found.selection.named;
  const auto added = added_terms(found);
  for (const auto& one : added) add_term(model, one.term->component, one.key, table_of(named, one));
  const auto of_added = [&](const FreeParameter& free) {
    return std::find_if(added.begin(), added.end(), [&](const AddedTerm& one) {
      return means(prefix_of(free.name), one.term->settings);
    });
  };
  Config values = model.table_or_empty("values");
  for (std::size_t i = 0; i < named.free.size(); ++i)
    if (!named.free[i].is_tolerance && of_added(named.free[i]) == added.end())
      values.put(named.free[i].name, rounded(named.values[static_cast<Index>(i)]));
  if (!values.keys().empty()) model.set("values", values);
  for (const auto& round : found.selection.rounds) {
    const Candidate& candidate = round.chosen.candidate;
    if (!may_be_fitted(candidate)) continue;
    for (const auto& free : candidate.frees) {
      const auto term = of_added(free);
      const bool is_of_term = term != added.end();
      free_in(model, free,
              is_of_term
                  ? fmt::format("{}.{}.{}", term->term->component, term->key, last_name(free.name))
                  : free.name,
              nullptr);
    }
  }
}

// ---- coarse steps of sensors ----------------------------------------------------------------

sim::SensorChannel channel_of(const std::string& role) {
  for (const auto channel : {sim::SensorChannel::Displacement, sim::SensorChannel::Acceleration})
    if (role.starts_with(name_of(channel).channel)) return channel;
  return role == "vertical_force" ? sim::SensorChannel::AxialLoad : sim::SensorChannel::Force;
}

// Whether a model of the user's own system has terms at a channel.
bool has_component(const Relation& relation, const std::string& role) {
  const auto inputs = relation.drivers();
  const auto& outputs = relation.outputs();
  return contains(inputs, role) ||
         std::any_of(outputs.begin(), outputs.end(),
                     [&](const auto& output) { return output.first == role; });
}

Config rounding_of(const Lattice& lattice, sim::SensorChannel channel) {
  Config table;
  for (const auto& parameter : sim::term_kind("quantisation").parameters)
    if (parameter.name == "step")
      table.put(sim::parameter_key(parameter, channel), rounded(lattice.step));
  return table;
}

void add_rounding(const Lattice& lattice, Config& model) {
  const sim::SensorChannel channel = channel_of(lattice.role);
  // No term changes a temperature.
  if (!lattice.role.starts_with(channel == sim::SensorChannel::AxialLoad
                                    ? std::string_view{"vertical_force"}
                                    : name_of(channel).channel))
    return;
  Config table = rounding_of(lattice, channel);
  table.put("kind", std::string{"quantisation"});
  table.put("channel", std::string{name_of(channel).channel});
  if (const auto dot = lattice.role.find('.'); dot != std::string::npos)
    table.put("axes", std::vector<std::string>{lattice.role.substr(dot + 1)});
  std::string key = lattice.role + ".quantisation";
  std::replace(key.begin(), key.end(), '.', '_');
  model.set(key, table);
}

bool is_of_specimen(const sim::TermKind& kind) {
  return kind.stage >= sim::Stage::Motion && kind.stage <= sim::Stage::Restoring;
}

const char* side_of(const sim::TermKind& kind) {
  return is_of_specimen(kind) ? "specimen" : "machine";
}

}  // namespace

std::string fragment_of(const RelationFindings& found) {
  return fragment_of(found, found.selection.named);
}

std::string fragment_of(const RelationFindings& found, const Hypothesis& named) {
  if (!found.is_named()) return "";
  std::string text;
  for (const auto& table : changed_tables(found, named)) {
    text += fmt::format("[{}.{}]\n", side_of(sim::term_kind(table.terms[0]->kind)), table.key);
    if (table.changes.has("kind"))
      text += fmt::format("kind = \"{}\"\n", table.changes.text("kind"));
    text += table.changes.without("kind").to_toml();
    text += '\n';
  }
  return text;
}

std::vector<Index> specimen_parameters(const Hypothesis& named) {
  std::vector<Index> found;
  for (std::size_t i = 0; i < named.free.size(); ++i)
    if (std::any_of(named.terms.begin(), named.terms.end(), [&](const ModelTerm& term) {
          return !named.free[i].is_tolerance &&
                 means(prefix_of(named.free[i].name), term.settings) &&
                 is_of_specimen(sim::term_kind(term.settings.kind));
        }))
      found.push_back(static_cast<Index>(i));
  return found;
}

bool has_rounding(const Case& c, const std::string& role) {
  const auto is_rounding = [](const sim::TermSettings& term) {
    return sim::has_trait(term.kind, sim::kRounds);
  };
  if (!is_composition(c.model.kind)) {
    const auto terms = sim::read_terms(c.model.table.table_or_empty("terms").table_or_empty(role),
                                       sim::TermOwner::Any, sim::ParameterBounds::None);
    return std::any_of(terms.begin(), terms.end(), is_rounding);
  }
  const auto terms = sim::read_terms(c.model.table.without("bounds"));
  return std::any_of(terms.begin(), terms.end(), [&](const sim::TermSettings& term) {
    const bool acts = role.find('.') == std::string::npos ||
                      (term.axes & (role.ends_with(".long") ? 1U : 2U)) != 0;
    return is_rounding(term) && acts && term.channel == channel_of(role);
  });
}

Config improved_model(const Case& c, const std::vector<std::unique_ptr<RelationFindings>>& all,
                      const std::vector<Lattice>& lattices) {
  Config model = c.model.table;
  model.put("kind", name_of(c.model.kind));
  for (const auto& found : all)
    is_composition(c.model.kind) ? improve_composition(*found, model)
                                 : improve_system(*found, model);
  for (const auto& lattice : lattices) {
    if (is_composition(c.model.kind))
      add_rounding(lattice, model);
    else if (has_component(*all[0]->relation, lattice.role))
      add_term(model, lattice.role, "quantisation",
               rounding_of(lattice, sim::SensorChannel::Force));
  }
  return model;
}

CaseSource improved_case(const Case& c, const Config& model) {
  CaseSource improved = c.source;
  if (improved.file.keys().empty()) return {};
  improved.file.put("name", c.name + ", improved");
  improved.file.set("model", model);
  if (!improved.experiment.keys().empty())
    improved.experiment.put("name", improved.experiment.text("name") + "_improved");
  return improved;
}

}  // namespace rths::diagnosis
