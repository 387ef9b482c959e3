// SPDX-License-Identifier: Apache-2.0
#include <rths/models/dynamic_relation.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/models/barred.hpp>

#include "anchored_relation.hpp"
#include "dynamic_candidates.hpp"
#include "dynamic_drive.hpp"
#include "dynamic_simulator.hpp"
#include "foreign_model.hpp"
#include "foreign_simulator.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kWithin =
    10;  // default bounds of a parameter: from a tenth to ten times its value

std::vector<const Record*> records_to_fit(const Case& c) {
  std::vector<const Record*> records;
  for (const auto& record : c.records)
    if (record.use == Use::Fit) records.push_back(&record);
  if (records.empty()) throw Error{fmt::format("{}: there is no record to fit", c.name)};
  return records;
}

DynamicModel read_stated(const Case& c, const ForeignModel* foreign, const Record& record) {
  switch (c.model.kind) {
    case ModelKind::MassSpringDamper:
      return read_mass_spring_damper(c.model.table);
    case ModelKind::Structure:
      return read_structure(c.model.table);
    case ModelKind::Linear:
      return read_linear(c.model.table);
    case ModelKind::Data:
      return read_data(c.model.table, record);
    case ModelKind::Program:
    case ModelKind::OpenSees:
    case ModelKind::Fmu:
    case ModelKind::Plugin:
      return read_foreign(*foreign, record);
    default:
      throw Error{fmt::format("{}: a model of kind '{}' is not a dynamic system", c.name,
                              name_of(c.model.kind))};
  }
}

// [model.values]: values of parameters by name, which replace those stated elsewhere.
void take_values(const Config& values, DynamicModel& model) {
  for (const auto& name : values.keys()) {
    const double value = values.number(name);
    const auto at = values.placed(name, [&] { return find_parameter(model, model.terms, name); });
    if (at.of_model) {
      model.parameters[*at.of_model].value = value;
      continue;
    }
    auto& known = model.terms[at.term].settings.parameters;
    std::erase_if(known, [&](const auto& parameter) { return parameter.first == at.parameter; });
    known.emplace_back(at.parameter, value);
  }
}

DynamicModel read_model(const Case& c, const ForeignModel* foreign, const Record& record) {
  DynamicModel model = read_stated(c, foreign, record);
  take_values(c.model.table.table_or_empty("values"), model);
  return model;
}

struct FreedParameter {
  FreeParameter parameter;
  double value;
};

FreedParameter freed_of_model(const ModelParameter& parameter, const FittedParameter& fitted) {
  const double value = parameter.value;
  if (value == 0 && !fitted.bounds && !parameter.bounds)
    throw Error{
        fmt::format("'{}' is fitted and its value is 0, expected bounds for it", fitted.name)};
  FreeParameter free{fitted.name, parameter.unit, std::min(value / kWithin, value * kWithin),
                     std::max(value / kWithin, value * kWithin), 0.1 * std::abs(value)};
  if (parameter.bounds) std::tie(free.low, free.high) = *parameter.bounds;
  return {free, value};
}

FreedParameter freed_of_term(const sim::TermSettings& term, const std::string& name,
                             const FittedParameter& fitted) {
  const sim::Parameter& parameter = parameter_of(sim::term_kind(term.kind), name);
  double value = parameter.absent;
  for (const auto& [key, stated] : term.parameters)
    if (key == name) value = stated;
  return {free_parameter(fitted.name, parameter, {}, 0.1 * std::abs(value)), value};
}

FreedParameter freed(const DynamicModel& model, const Hypothesis& base,
                     const FittedParameter& fitted) {
  const auto at = find_parameter(model, base.terms, fitted.name);
  FreedParameter result = at.of_model
                              ? freed_of_model(model.parameters[*at.of_model], fitted)
                              : freed_of_term(base.terms[at.term].settings, at.parameter, fitted);
  auto& [parameter, value] = result;
  if (fitted.bounds) std::tie(parameter.low, parameter.high) = *fitted.bounds;
  if (!(value >= parameter.low && value <= parameter.high))
    throw Error{fmt::format("'{}' is {}, outside its bounds {} to {}", fitted.name, value,
                            parameter.low, parameter.high)};
  if (!(parameter.scale > 0)) parameter.scale = 0.05 * (parameter.high - parameter.low);
  return result;
}

// An output whose sensor overflows.
struct OverflowingChannel {
  Index output;
  double limit;               // unless it is free [SI]
  std::optional<Index> free;  // free parameter that holds the limit
};

// A reading that overflows is known but for multiples of its span. Of all values that give the same
// reading, this simulator predicts the one next to the measurement. A small error of the model then
// stays small where a reading jumps, so that fits converge.
class NearestReading final : public Simulator {
 public:
  NearestReading(std::unique_ptr<Simulator> simulator, std::vector<OverflowingChannel> overflows,
                 const MatrixXd& measured)
      : simulator_{std::move(simulator)}, overflows_{std::move(overflows)}, measured_{measured} {}

  bool run(const VectorXd& values, const std::vector<Index>& wanted, MatrixXd& prediction,
           std::vector<MatrixXd>& derivatives) const override {
    if (!simulator_->run(values, wanted, prediction, derivatives)) return false;
    for (const auto& [output, limit, free] : overflows_) {
      const double span = 2 * (free ? values[*free] : limit);
      const ArrayXd turns =
          ((measured_.col(output) - prediction.col(output)).array() / span).round();
      prediction.col(output).array() += span * turns;
      for (std::size_t i = 0; i < wanted.size(); ++i)
        if (free == wanted[i]) derivatives[i].col(output).array() += 2 * turns;
    }
    return true;
  }
  [[nodiscard]] int work_per_row() const override { return simulator_->work_per_row(); }

 private:
  std::unique_ptr<Simulator> simulator_;
  std::vector<OverflowingChannel> overflows_;
  const MatrixXd& measured_;  // rows × outputs
};

std::unique_ptr<ForeignModel> foreign_of(const Case& c) {
  if (!is_foreign(c.model.kind)) return nullptr;
  return std::make_unique<ForeignModel>(c.model);
}

std::vector<Record> predicted_records(const Case& c, const ForeignModel* foreign) {
  std::vector<Record> records;
  if (foreign != nullptr)
    for (const Record* record : records_to_fit(c))
      records.push_back(foreign->predicted(*record, records.empty()));
  return records;
}

std::vector<const Record*> pointers_to(const std::vector<Record>& records) {
  std::vector<const Record*> pointers;
  for (const auto& record : records) pointers.push_back(&record);
  return pointers;
}

class DynamicRelation : public Relation {
 public:
  DynamicRelation(const Case& c, std::vector<std::string> without)
      : foreign_{foreign_of(c)},
        predicted_{predicted_records(c, foreign_.get())},
        records_{foreign_ ? pointers_to(predicted_) : records_to_fit(c)},
        model_{read_model(c, foreign_.get(), *records_.front())},
        without_{std::move(without)} {
    for (const auto& role : model_.outputs)
      outputs_.emplace_back(role, channel_of(*records_.front(), role).unit);
    base_.terms = model_.terms;
    // Rounding is known: it is part of the noise.
    std::erase_if(base_.terms, [](const ModelTerm& term) {
      return sim::has_trait(term.settings.kind, sim::kRounds);
    });
    for (const auto& fitted : c.model.fitted) {
      // Offsets of outputs differ from record to record: each record's offset is removed.
      if (take_offset(fitted.name)) continue;
      const FreedParameter one =
          c.model.table.placed("fitted", [&] { return freed(model_, base_, fitted); });
      base_.free.push_back(one.parameter);
      base_.values.conservativeResize(base_.values.size() + 1);
      base_.values[base_.values.size() - 1] = one.value;
    }
    sizes_ = measured_sizes(model_, base_, records_);
  }

  const std::string& name() const override { return model_.name; }
  Part part() const override { return Part::Structure; }
  const std::vector<std::pair<std::string, std::string>>& outputs() const override {
    return outputs_;
  }
  bool has_free_offsets() const override { return has_free_offsets_; }
  const Hypothesis& base() const override { return base_; }
  std::vector<Candidate> candidates(const Hypothesis& model) const override {
    auto candidates = dynamic_candidates(model_, sizes_, model);
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return (has_free_offsets_ && is_offset_of_sensor(candidate)) ||
             is_barred(without_, candidate.name, candidate.kind);
    });
    return candidates;
  }

  bool runs_freely() const override { return true; }
  std::vector<FreeForm> forms(const Hypothesis& model) const override {
    return dynamic_forms(model_, measured_sizes(model_, model, records_));
  }

  std::vector<std::string> drivers() const override {
    const bool is_data = std::any_of(model_.inputs.begin(), model_.inputs.end(), is_predicted);
    return is_data ? std::vector<std::string>{} : model_.inputs;
  }

  std::vector<std::string> notes() const override {
    return foreign_ ? std::vector{foreign_->note()} : std::vector<std::string>{};
  }

  std::unique_ptr<Drive> prepare(const Record& record) const override {
    return dynamic_drive(model_, base_, foreign_ ? foreign_->predicted(record, false) : record);
  }
  std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                const Record& noise) const override {
    constexpr std::ptrdiff_t kRotations = 3;
    std::vector<std::unique_ptr<Drive>> all;
    for (std::ptrdiff_t i = 0; i < kRotations; ++i) {
      Record rotated = noise;
      for (auto& channel : rotated.channels) {
        auto& x = channel.values;
        std::rotate(x.begin(), x.begin() + i * std::ssize(x) / kRotations, x.end());
      }
      all.push_back(with_noise(model_, dynamic_cast<const DynamicDrive&>(drive), rotated));
    }
    return all;
  }
  std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                       const Drive& drive) const override {
    // A converter overflows after all other effects on its signal, in whatever order they were
    // found.
    Hypothesis ordered = hypothesis;
    std::stable_partition(ordered.terms.begin(), ordered.terms.end(), [](const ModelTerm& term) {
      return !sim::has_trait(term.settings.kind, sim::kOverflows);
    });
    const DynamicSignals& signals = dynamic_cast<const DynamicDrive&>(drive).signals;
    std::unique_ptr<Simulator> simulator;
    if (foreign_)
      simulator = std::make_unique<ForeignSimulator>(model_, *foreign_, ordered, sizes_,
                                                     drive.time_step, signals);
    else
      simulator =
          std::make_unique<DynamicSimulator>(model_, ordered, &sizes_, drive.time_step, signals);
    auto overflows = overflows_of(ordered);
    if (overflows.empty()) return simulator;
    return std::make_unique<NearestReading>(std::move(simulator), std::move(overflows),
                                            drive.measured);
  }

 private:
  std::vector<OverflowingChannel> overflows_of(const Hypothesis& hypothesis) const {
    std::vector<OverflowingChannel> overflows;
    for (std::size_t i = 0; i < hypothesis.terms.size(); ++i) {
      const auto& [settings, component] = hypothesis.terms[i];
      const auto role = std::find(model_.outputs.begin(), model_.outputs.end(), component);
      if (!sim::has_trait(settings.kind, sim::kOverflows) || role == model_.outputs.end()) continue;
      OverflowingChannel one{
          role - model_.outputs.begin(), sim::term_kind(settings.kind).parameters[0].absent, {}};
      for (const auto& [key, value] : settings.parameters)
        if (key == "limit") one.limit = value;
      for (std::size_t k = 0; k < hypothesis.free.size(); ++k) {
        const auto at = find_parameter(model_, hypothesis.terms, hypothesis.free[k].name);
        if (!at.of_model && at.term == i) one.free = static_cast<Index>(k);
      }
      overflows.push_back(one);
    }
    return overflows;
  }

  // Whether a fitted parameter is the offset of an output.
  bool take_offset(const std::string& name) {
    const auto is_offset = [&](const ModelTerm& term) {
      const bool at_output = std::find(model_.outputs.begin(), model_.outputs.end(),
                                       term.component) != model_.outputs.end();
      const std::string own = term.settings.name + ".offset";
      return at_output && sim::has_trait(term.settings.kind, sim::kConstant) &&
             (name == own || name == term.component + "." + own);
    };
    const bool found = std::erase_if(base_.terms, is_offset) > 0;
    has_free_offsets_ |= found;
    return found;
  }

  std::unique_ptr<ForeignModel> foreign_;  // null: the model computes by itself
  std::vector<Record> predicted_;          // records to fit, with what it predicts
  std::vector<const Record*> records_;     // to fit
  DynamicModel model_;
  std::vector<std::string> without_;  // excluded from candidates
  std::vector<std::pair<std::string, std::string>> outputs_;
  Hypothesis base_;
  bool has_free_offsets_ = false;
  DynamicSizes sizes_;
};

}  // namespace

std::unique_ptr<Relation> dynamic_relation(const Case& c, const std::vector<std::string>& without) {
  return anchored(std::make_unique<DynamicRelation>(c, without), c);
}

}  // namespace rths::diagnosis
