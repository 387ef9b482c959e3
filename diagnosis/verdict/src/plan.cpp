// SPDX-License-Identifier: Apache-2.0
#include <rths/verdict/plan.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include <rths/cases/bounded.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/identification/folds.hpp>
#include <rths/identification/lattice.hpp>
#include <rths/identification/problem.hpp>
#include <rths/identification/screening.hpp>
#include <rths/identification/signal.hpp>
#include <rths/sim/term.hpp>

#include "check_records.hpp"
#include "limits.hpp"
#include "relations_of_case.hpp"

namespace rths::diagnosis {
namespace {

constexpr std::size_t kExamined = 2;  // whose motion is examined: enough for sizes
constexpr std::size_t kMostConfusions = 20;

std::vector<std::unique_ptr<Relation>> checked_relations(const Case& c,
                                                         const std::vector<std::string>& without) {
  check_case(c, without);
  std::vector<std::unique_ptr<Relation>> relations;
  for (const RelationOf relation_of : relations_of_kind(c.model.kind))
    if (auto relation = relation_of(c, without)) relations.push_back(std::move(relation));
  for (const auto& relation : relations) check_outputs(*relation, moving_records(c));
  if (relations.empty()) throw_without_relation(c);
  return relations;
}

std::vector<Plan::PlannedRecord> records_of(const Case& c, const Split& split) {
  std::vector<Plan::PlannedRecord> planned;
  for (const auto& record : c.records) {
    const auto position = std::find(split.held.begin(), split.held.end(), &record);
    std::string role = "fits and scores";
    if (record.use == Use::Reference)
      role = "noise";
    else if (position != split.held.end())
      role = position + 1 == split.held.end() ? "proof" : "held out, error reported";
    else if (split.by_record)
      role = record.use == Use::Fit ? "fits; scores in exchange" : "scores; fits in exchange";
    if (record.quiet && record.use != Use::Reference) role += "; noise at rest";
    planned.push_back({record.name, role, static_cast<double>(record.samples()) * record.time_step,
                       record.has_time ? 1 / record.time_step : 0});
  }
  return planned;
}

// Frequencies that bound the middle 90 % of a signal's energy [Hz].
std::pair<double, double> band_of(const VectorXd& signal, double time_step) {
  constexpr double kTail = 0.05;
  constexpr Index kWindow = 1024;
  Index window = 2;
  while (window < kWindow && 2 * window <= signal.size()) window *= 2;
  const Spectrum spectrum = power_spectrum(signal, static_cast<int>(window), time_step);
  const double total = spectrum.density.sum();
  const auto frequency_at = [&](double share) {
    double sum = 0;
    for (Index i = 0; i < spectrum.density.size(); ++i) {
      sum += spectrum.density[i];
      if (sum >= share * total) return spectrum.frequency[i];
    }
    return 0.5 / time_step;
  };
  return {frequency_at(kTail), frequency_at(1 - kTail)};
}

std::vector<std::string> visited_states(const Problem& problem) {
  std::vector<std::string> texts;
  const Drive& first = problem.drive(0);
  for (std::size_t i = 0; i < first.state_names.size(); ++i) {
    double u = 0, v = 0;
    for (std::size_t record = 0; record < problem.records(); ++record) {
      const auto output = static_cast<Index>(i);
      u = std::max(u, problem.drive(record).displacement.col(output).cwiseAbs().maxCoeff());
      v = std::max(v, problem.drive(record).velocity.col(output).cwiseAbs().maxCoeff());
    }
    const auto& [name, unit] = first.state_names[i];
    if (!first.has_time) {
      texts.push_back(fmt::format("{} ({}): up to {:.3g} {}", problem.relation().outputs()[i].first,
                                  name, u, unit));
      continue;
    }
    const auto [low, high] =
        band_of(first.displacement.col(static_cast<Index>(i)), first.time_step);
    texts.push_back(
        fmt::format("{} ({}): up to {:.3g} {} and {:.3g} {}/s; 90 % of its energy from "
                    "{:.2g} to {:.2g} Hz",
                    problem.relation().outputs()[i].first, name, u, unit, v, unit, low, high));
  }
  return texts;
}

// An effect of typical size: its visible part, and the directions that its parameters can move it.
struct Visible {
  const Candidate* candidate;
  VectorXd effect;      // without the part that the fitted parameters reproduce
  MatrixXd directions;  // likewise; the effect is the last column
  Plan::Effect planned;
};

class PlannedExamination {
 public:
  PlannedExamination(const Problem& problem, Fold fold)
      : fold_{std::move(fold)}, base_{problem, problem.relation().base()} {
    const std::vector<Index> all = all_of(base_.hypothesis());
    MatrixXd jacobian;
    if (!base_.evaluate(fold_, base_.hypothesis().values, all, residual_, jacobian))
      throw Error{fmt::format("{}: the model as stated has no prediction ({})",
                              problem.record(0).name, problem.relation().name())};
    fitted_.emplace(jacobian);
  }

  /// Predictions with derivatives so far.
  [[nodiscard]] double predictions() const { return predictions_; }

  [[nodiscard]] std::optional<Visible> at_typical_size(const Candidate& candidate) const {
    const VectorXd& start = candidate.starts[0];
    const auto whole = seen_at(candidate, start);
    if (!whole) return std::nullopt;
    Visible visible{&candidate, whole->effect, whole->directions, {}};
    Plan::Effect& planned = visible.planned;
    planned.name = candidate.name;
    planned.title = candidate.title;
    planned.channel = candidate.channel;
    planned.part = candidate.part;
    planned.parameter = candidate.frees[0].name;
    planned.unit = candidate.frees[0].unit;
    planned.size = start[0];
    planned.information = whole->effect.squaredNorm() / 2;
    planned.smallest = smallest_size(candidate, planned.information);
    return visible;
  }

 private:
  struct Seen {
    VectorXd effect;
    MatrixXd directions;
  };

  // The effect at values of a candidate's parameters; nothing if there is no prediction.
  [[nodiscard]] std::optional<Seen> seen_at(const Candidate& candidate,
                                            const VectorXd& start) const {
    const TestedHypothesis beside{base_.problem(), extended(base_.hypothesis(), candidate, start)};
    const Hypothesis& whole = beside.hypothesis();
    const std::size_t known = base_.hypothesis().free.size();
    std::vector<Index> added(whole.free.size() - known);
    std::iota(added.begin(), added.end(), static_cast<Index>(known));
    VectorXd there;
    MatrixXd columns;
    ++predictions_;
    if (added.empty() || !beside.evaluate(fold_, whole.values, added, there, columns))
      return std::nullopt;
    Seen seen{there - residual_, MatrixXd(there.size(), columns.cols() + 1)};
    for (std::size_t i = 0; i < added.size(); ++i)
      columns.col(static_cast<Index>(i)) *= whole.free[known + i].scale;
    // A parameter of the model that is wrong by its scale.
    if (candidate.adds.empty() && candidate.becomes.empty()) seen.effect = columns.col(0);
    fitted_->take_out(seen.effect);
    for (Index i = 0; i < columns.cols(); ++i) fitted_->take_out(columns.col(i));
    seen.directions << columns, seen.effect;
    return seen;
  }

  // Size of the first parameter at which an effect has kDetectable: from the typical size by
  // secants in logarithms. 0: not found, or the effect has no size.
  [[nodiscard]] double smallest_size(const Candidate& candidate, double typical) const {
    constexpr int kSteps = 8;
    constexpr double kWithin = 1.3, kLargestStep = 1e3;
    if (candidate.adds.empty() && candidate.becomes.empty()) return 0;
    double factor = 1, information = typical, next = 0.5;
    for (int step = 0; step < kSteps; ++step) {
      const auto seen = seen_at(candidate, scaled(candidate, next));
      if (!seen) return 0;
      const double there = seen->effect.squaredNorm() / 2;
      if (there < kWithin * kDetectable && there > kDetectable / kWithin)
        return scaled(candidate, next)[0];
      const double power = std::log(there / information) / std::log(next / factor);
      if (!std::isfinite(power) || power == 0) return 0;
      const double ratio = std::pow(kDetectable / there, 1 / power);
      if (!std::isfinite(ratio)) return 0;
      factor = next;
      information = there;
      next *= std::clamp(ratio, 1 / kLargestStep, kLargestStep);
    }
    return 0;
  }

  // The start of a candidate with the sizes of its effect times a factor. Sizes are parameters that
  // are 0, or for a gain 1, where the effect is absent; the first parameter is always one.
  static VectorXd scaled(const Candidate& candidate, double factor) {
    VectorXd values = candidate.starts[0];
    const auto& known = sim::term_kind(candidate.kind).parameters;
    for (Index i = 0; i < values.size(); ++i) {
      const auto& free = candidate.frees[static_cast<std::size_t>(i)];
      const auto parameter = std::find_if(known.begin(), known.end(), [&](const auto& one) {
        return free.name.ends_with("." + std::string{one.name});
      });
      const double absent = parameter == known.end() ? 0 : parameter->absent;
      if (i > 0 && absent != 0) continue;
      const double zero = absent == 1 ? 1 : 0;
      values[i] = std::clamp(zero + factor * (values[i] - zero), free.low, free.high);
    }
    return values;
  }

  Fold fold_;
  TestedHypothesis base_;
  mutable double predictions_ = 0;
  VectorXd residual_;
  std::optional<Complement> fitted_;
};

// Effects that another one reproduces so well that the records cannot tell them apart. A special
// case of the other is told apart by its simplicity.
std::vector<Plan::Confusion> confusions_of(const std::vector<Visible>& all) {
  std::vector<Plan::Confusion> found;
  for (const auto& rival : all) {
    if (rival.planned.information < kDetectable) continue;
    const Complement other{rival.directions};
    for (const auto& one : all) {
      const bool is_special = contains(rival.candidate->contains, one.candidate->name) ||
                              contains(rival.candidate->after, one.candidate->name);
      if (&one == &rival || is_special || one.planned.information < kDetectable) continue;
      VectorXd rest = one.effect;
      other.take_out(rest);
      const double left = rest.squaredNorm() / 2;
      if (left < kDistinguishable)
        found.push_back({one.planned.name + " at " + one.planned.channel,
                         rival.planned.name + " at " + rival.planned.channel,
                         1 - left / one.planned.information, left});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share; });
  if (found.size() > kMostConfusions) found.resize(kMostConfusions);
  return found;
}

// Unit of a role, or of the first member of a family.
std::string unit_of(const Record* record, const std::string& role) {
  for (const auto& channel : record->channels)
    if (channel.role == role || channel.role.starts_with(role + ".")) return channel.unit;
  return "-";
}

// Processor time of this program [s].
double processor_seconds() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

// @param seconds  of a prediction of the examined records with derivatives
Plan::Cost cost_of(const Relation& relation, const Split& split,
                   const std::vector<Candidate>& candidates, double seconds) {
  constexpr double kNoiseDraws = 24, kColumns = 16;  // of noise; of derivatives and residuals
  constexpr double kFits = 300;  // predictions of the fits of a round: some of them twice as long
  constexpr double kRounds = 20;
  Plan::Cost cost;
  double examined = 0;
  for (std::size_t i = 0; i < split.records.size(); ++i) {
    const Record& record = *split.records[i];
    const double values = static_cast<double>(relation.prepare(record)->measured.size());
    cost.values += values;
    if (i < kExamined) examined += values;
    cost.memory +=
        sizeof(double) *
        (kColumns * values +
         kNoiseDraws * (values + static_cast<double>(record.samples() * record.channels.size())));
  }
  double starts = 0;
  for (const auto& candidate : candidates) starts += static_cast<double>(candidate.starts.size());
  cost.shortest = seconds * cost.values / examined * (starts + kFits);
  cost.longest = kRounds * cost.shortest;
  return cost;
}

Plan::Examined examined(const Relation& relation, const Split& split, const SensorNoise& noise,
                        std::uint64_t seed) {
  std::vector<const Record*> records{split.records.begin(),
                                     split.records.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                 kExamined, split.records.size()))};
  const Problem problem{relation, records, noise, seed};
  Plan::Examined result;
  result.relation = relation.name();
  for (const auto& [role, unit] : relation.outputs()) result.outputs.push_back(role);
  result.rate = problem.drive(0).has_time ? 1 / problem.drive(0).time_step : 0;
  result.cutoff = problem.drive(0).cutoff;
  result.visited = visited_states(problem);
  for (const auto& free : relation.base().free) result.fitted.push_back(free.name);
  const PlannedExamination examination{problem, folds_of(split, problem).both};
  const auto candidates = relation.candidates(relation.base());
  std::vector<Visible> visible;
  const double begin = processor_seconds();
  for (const auto& candidate : candidates)
    if (!candidate.is_hidden)
      if (auto one = examination.at_typical_size(candidate)) visible.push_back(std::move(*one));
  const double each = (processor_seconds() - begin) / std::max(1.0, examination.predictions());
  result.cost = cost_of(relation, split, candidates, each);
  std::stable_sort(visible.begin(), visible.end(), [](const auto& a, const auto& b) {
    return a.planned.information > b.planned.information;
  });
  for (auto& one : visible) {
    if (one.planned.unit.starts_with(sim::kChannelUnit))
      one.planned.unit.replace(0, sim::kChannelUnit.size(),
                               unit_of(records[0], one.planned.channel));
    result.effects.push_back(one.planned);
  }
  result.confusions = confusions_of(visible);
  return result;
}

}  // namespace

void check_model(const Case& c) { static_cast<void>(checked_relations(c, {})); }

Plan plan(const Case& given, const DiagnosisOptions& options) {
  Case c = given;
  const std::vector<std::string> lost = bound_records(c);
  const auto relations = checked_relations(c, options.without);
  std::vector<const Record*> noisy;
  for (const auto& record : c.records) noisy.push_back(&record);
  const SensorNoise noise{noisy, c.noise, rounding_of(coarse_lattices(moving_records(c)))};
  const Split split = split_of(c.records);
  Plan plan;
  plan.case_name = c.name;
  plan.kind = name_of(c.model.kind);
  plan.records = records_of(c, split);
  plan.noise = noise_basis(c, noise);
  plan.limits = limits_of_channels(c);
  plan.limits.insert(plan.limits.end(), lost.begin(), lost.end());
  if (!split.undetermined.empty()) plan.limits.push_back(pieces_for(split));
  if (split.held.empty()) plan.limits.emplace_back("No record is held out for a proof.");
  for (const auto& relation : relations) {
    plan.relations.push_back(examined(*relation, split, noise, options.seed));
    for (auto& note : relation->notes()) plan.limits.push_back(std::move(note));
    for (auto& opposed : opposed_outputs(*relation, moving_records(c)))
      plan.limits.push_back(std::move(opposed));
  }
  return plan;
}

}  // namespace rths::diagnosis
