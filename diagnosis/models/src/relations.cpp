// SPDX-License-Identifier: Apache-2.0
#include <rths/models/relations.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "anchored_relation.hpp"
#include "candidate_terms.hpp"
#include "composition_relation.hpp"

namespace rths::diagnosis {
namespace {

using sim::Stage;

// Steps of 2 ms integrate hysteresis and dry friction with errors below a sensor's noise. What
// moves the specimen above 90 Hz is noise.
constexpr SampleRates kForcePace{500, 25, 62.5, 0, 90};
constexpr SampleRates kActuatorPace{500, 45, 125};
// Above a few hertz, an accelerometer measures an acceleration better than the displacement implies
// it.
constexpr SampleRates kAccelerometerPace{250, 5, 15.625};

// The rates that the case states; 2.5 rows per period at the cutoff of the filter.
SampleRates pace_of(const Case& c, SampleRates usual) {
  if (c.comparison.model_rate) usual.model_rate = *c.comparison.model_rate;
  if (c.comparison.cutoff) {
    usual.compare_rate *= *c.comparison.cutoff / usual.cutoff;
    usual.drive_cutoff *= *c.comparison.cutoff / usual.cutoff;
    usual.cutoff = *c.comparison.cutoff;
  }
  return usual;
}

std::vector<std::size_t> axes_with(const Case& c, const std::vector<std::string>& families) {
  const auto records = moving_records(c);
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
    const bool is_whole = std::all_of(records.begin(), records.end(), [&](const Record* record) {
      return std::all_of(families.begin(), families.end(), [&](const std::string& family) {
        return record->find(family + "." + axis_name(axis)) != nullptr;
      });
    });
    if (is_whole) axes.push_back(axis);
  }
  return axes;
}

bool belongs_to(const sim::TermSettings& term, const std::string& predicted) {
  const sim::TermKind& kind = sim::term_kind(term.kind);
  if (predicted == "displacement")
    return kind.stage == Stage::Actuator ||
           (kind.stage == Stage::Sensor && term.channel == sim::SensorChannel::Displacement);
  if (predicted == "acceleration")
    return kind.stage == Stage::Sensor && term.channel == sim::SensorChannel::Acceleration;
  return kind.stage != Stage::Actuator &&
         !(kind.stage == Stage::Sensor && term.channel != sim::SensorChannel::Force);
}

FreeParameter free_parameter(const FittedParameter& fitted, const std::vector<ModelTerm>& terms,
                             double& value) {
  const auto [meant, name] = meant_by(fitted.name, terms);
  const sim::TermSettings& term = terms[meant[0]].settings;
  for (const auto& parameter : sim::term_kind(term.kind).parameters) {
    if (parameter.name != name) continue;
    value = parameter.absent;
    for (const auto& [key, number] : term.parameters)
      if (key == name) value = number;
    FreeParameter free{fitted.name, std::string{parameter.unit}, parameter.low, parameter.high, 1};
    if (fitted.bounds) {
      free.low = std::max(free.low, fitted.bounds->first);
      free.high = std::min(free.high, fitted.bounds->second);
    }
    const double typical = std::abs(value) > 0 ? std::abs(value) : std::abs(parameter.typical);
    free.scale = 0.1 * (typical > 0 ? typical : 1);
    return free;
  }
  throw Error{"fitted: term '" + term.kind + "' has no parameter '" + name + "'"};
}

std::optional<double> stated_value(const sim::TermSettings& term, const std::string& parameter) {
  for (const auto& [key, number] : term.parameters)
    if (key == parameter) return number;
  return std::nullopt;
}

// One name for both axes means a parameter of each, if the case states two values.
std::vector<FittedParameter> by_axis(const FittedParameter& fitted,
                                     const std::vector<ModelTerm>& terms) {
  const auto [meant, name] = meant_by(fitted.name, terms);
  std::vector<FittedParameter> all;
  for (const std::size_t i : meant)
    all.push_back({terms[i].settings.name + "." + name, fitted.bounds});
  const bool differ = meant.size() > 1 && stated_value(terms[meant[0]].settings, name) !=
                                              stated_value(terms[meant[1]].settings, name);
  return differ ? all : std::vector{fitted};
}

// The terms of the model that predict a channel, and the parameters of them that were fitted.
Hypothesis base_of(const Case& c, const std::string& predicted, bool& has_free_offsets) {
  Hypothesis base;
  const auto all = sim::read_terms(c.model.table.without("bounds"));
  for (const auto& term : all)
    // Rounding is known: it is part of the noise.
    if (belongs_to(term, predicted) && !sim::has_trait(term.kind, sim::kRounds))
      base.terms.push_back({term, ""});
  std::vector<double> values;
  for (const auto& fitted : c.model.fitted) {
    const std::string term = fitted.name.substr(0, fitted.name.rfind('.'));
    const auto is_it = [&](const ModelTerm& placed) {
      return placed.settings.name == term || placed.settings.name.starts_with(term + ".");
    };
    const auto found = std::find_if(base.terms.begin(), base.terms.end(), is_it);
    if (found == base.terms.end()) continue;
    // Offsets differ between records, so each record has its own removed.
    if (sim::has_trait(found->settings.kind, sim::kConstant)) {
      has_free_offsets = true;
      continue;
    }
    for (const auto& one : by_axis(fitted, base.terms)) {
      double value = 0;
      base.free.push_back(free_parameter(one, base.terms, value));
      values.push_back(value);
    }
  }
  if (has_free_offsets)
    std::erase_if(base.terms, [](const ModelTerm& placed) {
      return sim::has_trait(placed.settings.kind, sim::kConstant);
    });
  base.values = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
  return base;
}

// A recording does not tell when within a sample a command took effect or a reading was taken.
void allow_half_a_sample(Hypothesis& base, double time_step) {
  for (const auto& [settings, component] : base.terms) {
    const std::string name = settings.name + ".delay";
    const bool is_free = std::any_of(base.free.begin(), base.free.end(),
                                     [&](const auto& free) { return free.name == name; });
    if (!sim::has_trait(settings.kind, sim::kDelaysCommand) || is_free) continue;
    double delay = 0;
    for (const auto& [key, value] : settings.parameters)
      if (key == "delay") delay = value;
    base.free.push_back({name, "s", std::max(0.0, delay - time_step / 2), delay + time_step / 2,
                         time_step / 10, true});
    base.values.conservativeResize(base.values.size() + 1);
    base.values[base.values.size() - 1] = delay;
    return;
  }
}

// "term.parameter" of all terms of the model.
std::vector<std::string> parameters_of(const Case& c) {
  std::vector<std::string> known;
  const auto add = [&](const std::string& name) {
    if (!contains(known, name)) known.push_back(name);
  };
  for (const auto& term : sim::read_terms(c.model.table.without("bounds")))
    for (const auto& parameter : sim::term_kind(term.kind).parameters) {
      add(fmt::format("{}.{}", term.name, parameter.name));
      // One name for the values of both axes.
      for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
        if (term.name.ends_with("." + axis_name(axis)))
          add(fmt::format("{}.{}", term.name.substr(0, term.name.rfind('.')), parameter.name));
    }
  return known;
}

// Of the axes that have its channels; null: none has.
std::unique_ptr<Relation> relation_of(const Case& c, CompositionSetup setup) {
  const auto& predicted = setup.channels.predicted;
  setup.axes = axes_with(c, {setup.channels.motion, predicted});
  if (setup.axes.empty()) return nullptr;
  setup.base = base_of(c, predicted, setup.has_free_offsets);
  if (predicted == "displacement") allow_half_a_sample(setup.base, moving_records(c)[0]->time_step);
  return anchored(std::make_unique<CompositionRelation>(std::move(setup), moving_records(c)), c);
}

}  // namespace

bool has_actuator(const Case& c) {
  if (c.model.kind == ModelKind::ServoAxis) return true;
  const auto terms = sim::read_terms(c.model.table.without("bounds"));
  return std::any_of(terms.begin(), terms.end(), [](const auto& term) {
    return sim::term_kind(term.kind).stage == Stage::Actuator;
  });
}

bool has_terms_of_time(const Case& c) {
  const auto terms = sim::read_terms(c.model.table.without("bounds"));
  return std::any_of(terms.begin(), terms.end(), [](const sim::TermSettings& term) {
    return needs_time(term) || sim::term_kind(term.kind).stage == Stage::Actuator;
  });
}

void check_composed_model(const Case& c) {
  const std::vector<std::string> keys{"anchor", "kind", "fitted", "bounds"};
  for (const auto& key : c.model.table.keys())
    if (!c.model.table.is_table(key) && !contains(keys, key))
      c.model.table.fail(key,
                         fmt::format("unknown key '{}'{}", key, did_you_mean_one_of(key, keys)));
  if (!moving_records(c)[0]->has_time)
    for (const auto& term : sim::read_terms(c.model.table.without("bounds")))
      if (needs_time(term) || sim::term_kind(term.kind).stage == Stage::Actuator)
        c.model.table.fail(
            term.name,
            fmt::format("the term '{}' needs a time, but the records have none", term.name));
  const auto known = parameters_of(c);
  for (const auto& fitted : c.model.fitted)
    if (!contains(known, fitted.name))
      c.model.table.fail("fitted", fmt::format("the model has no parameter '{}'{}", fitted.name,
                                               did_you_mean_one_of(fitted.name, known)));
}

std::unique_ptr<Relation> accelerometer_relation(const Case& c,
                                                 const std::vector<std::string>& without) {
  if (!moving_records(c)[0]->has_time) return nullptr;
  return relation_of(c, {.name = "displacement to acceleration",
                         .part = Part::Sensor,
                         .channels = {"displacement", "acceleration", false, false},
                         .pace = kAccelerometerPace,
                         .has_free_offsets = true,
                         .without = without});
}

std::unique_ptr<Relation> actuator_relation(const Case& c,
                                            const std::vector<std::string>& without) {
  if (!has_actuator(c)) return nullptr;
  return relation_of(c, {.name = "command to displacement",
                         .part = Part::Actuator,
                         .channels = {"command", "displacement", false, true},
                         .pace = pace_of(c, kActuatorPace),
                         .has_free_offsets = true,
                         .without = without});
}

std::unique_ptr<Relation> force_relation(const Case& c, const std::vector<std::string>& without) {
  if (c.model.kind == ModelKind::ServoAxis) return nullptr;
  auto relation = relation_of(c, {.name = "motion to force",
                                  .part = Part::Bearing,
                                  .channels = {"displacement", "force", true, false},
                                  .pace = pace_of(c, kForcePace),
                                  .without = without});
  if (relation) return relation;
  throw Error{"no axis has both displacement and force, which a model of kind '" +
              name_of(c.model.kind) + "' needs"};
}

}  // namespace rths::diagnosis
