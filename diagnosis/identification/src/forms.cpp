// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/forms.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <rths/core/error.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/scores.hpp>
#include <rths/identification/screening.hpp>
#include <rths/maths/statistics.hpp>

#include "form_search.hpp"

namespace rths::diagnosis {
namespace {

// Holds back values at knots that the motion hardly reaches. Their steps would exceed by far those
// of all others, so that no step reduced the error. Relative to the effect of all sizes of the
// form, so that it depends on no unit.
VectorXd ridge_of(const Problem& problem, const Fold& fold, const Hypothesis& hypothesis) {
  const auto count = static_cast<Index>(hypothesis.free.size());
  VectorXd ridge = VectorXd::Zero(count);
  std::vector<Index> sizes;
  for (Index i = 0; i < count; ++i)
    if (hypothesis.free[static_cast<std::size_t>(i)].absent) sizes.push_back(i);
  VectorXd residual;
  MatrixXd columns;
  if (!TestedHypothesis{problem, hypothesis}.evaluate(fold, hypothesis.values, sizes, residual,
                                                      columns))
    return ridge;
  double mean = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    mean += std::pow(columns.col(static_cast<Index>(k)).norm() *
                         hypothesis.free[static_cast<std::size_t>(sizes[k])].scale,
                     2) /
            static_cast<double>(sizes.size());
  for (const Index i : sizes)
    ridge[i] = std::sqrt(kRidge * mean) / hypothesis.free[static_cast<std::size_t>(i)].scale;
  return ridge;
}

std::optional<Fit> fit_of(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold,
                          int iterations) {
  try {
    return TestedHypothesis{problem, hypothesis}.fit(fold, iterations,
                                                     ridge_of(problem, fold, hypothesis));
  } catch (const Error&) {  // no prediction
    return std::nullopt;
  }
}

// The model with a free form, fitted to a fold: the best of short fits from several starts goes on.
// After a search that has done as much as it may, one short fit is made.
std::optional<Hypothesis> with_form(const TestedHypothesis& base, const Screened& screened,
                                    const Fold& fold) {
  const bool is_brief = base.problem().progress().is_search_over();
  const std::size_t starts = is_brief ? 1 : kStartsOfForm;
  std::optional<Hypothesis> best;
  double least = 0;
  for (std::size_t i = 0; i < std::min(starts, screened.starts.size()); ++i) {
    Hypothesis tried = extended(base.hypothesis(), *screened.candidate, screened.starts[i]);
    const auto fit = fit_of(base.problem(), tried, fold, kShortFit);
    if (!fit || (best && fit->sum_of_squares >= least)) continue;
    least = fit->sum_of_squares;
    tried.values = fit->parameters;
    best = std::move(tried);
  }
  if (!best) return std::nullopt;
  if (is_brief) return best;
  if (const auto fit = fit_of(base.problem(), *best, fold, kLongFit))
    best->values = fit->parameters;
  return best;
}

Description described_by(const FreeForm& form, const Problem& problem, const Fold& fold,
                         const Hypothesis& fitted, double share) {
  Description description{form.term.name, share, form.label, form.knots, {}, {}};
  for (const auto& estimate : estimates_of(fitted, covariance_of(problem, fold, fitted)))
    for (const auto& free : form.term.frees)
      if (free.name == estimate.name) {
        description.y.push_back(estimate.value);
        description.band.push_back((estimate.high - estimate.low) / 2 / maths::kNormal95);
      }
  return description;
}

// Curves and surfaces.
std::vector<Description> laws(const TestedHypothesis& tested, const Folds& folds) {
  std::vector<Description> found;
  const Relation& relation = tested.problem().relation();
  const auto free_forms = relation.forms(tested.hypothesis());
  if (!free_forms.empty())
    fit_forms(tested, folds, free_forms, found);
  else if (tested.problem().drive(0).displacement.size() > 0 && !relation.runs_freely())
    regress_forms(tested, folds, found);
  return found;
}

bool share_a_record(const Folds& folds) {
  const auto& first = folds.first.shares;
  return std::any_of(first.begin(), first.end(), [&](const Fold::Share& one) {
    const auto& second = folds.second.shares;
    return std::any_of(second.begin(), second.end(),
                       [&](const Fold::Share& other) { return other.record == one.record; });
  });
}

}  // namespace

double excess_on(const TestedHypothesis& tested, const Fold& fold) {
  return observations(tested.problem(), fold) * std::max(kLeastExcess, tested.variance(fold) - 1);
}

std::vector<Description> describe(const TestedHypothesis& tested, const Folds& folds) {
  const Problem& problem = tested.problem();
  const bool has_states = problem.drive(0).displacement.size() > 0;
  std::vector<Description> found = laws(tested, folds);
  if (has_states) {
    find_periodic_force(tested, folds, found);
    find_held_samples(tested, folds, found);
  }
  find_change(tested, folds, found);
  for (auto& one : found) one.is_of_pieces = share_a_record(folds);
  // A surface contains every curve over one of its arguments, and a curve of many knots those of
  // few, so it must explain more than the curve.
  const auto worth = [](const Description& one) {
    const bool contains_curves = one.form == "g(u, v)" || one.form == "f(u_long, u_lat)" ||
                                 one.form == "periodic in displacement";
    return one.share - (contains_curves ? kPriceOfSurface : 0);
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Description& a, const Description& b) { return worth(a) > worth(b); });
  // A form may follow a part of the noise, too.
  for (auto& one : found) one.share = std::min(one.share, 1.0);
  return found;
}

double least_left(const TestedHypothesis& tested, const Fold& fold) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& law : laws(tested, {fold, fold, fold})) least = std::min(least, law.left);
  return least;
}

void fit_forms(const TestedHypothesis& tested, const Folds& folds,
               const std::vector<FreeForm>& forms, std::vector<Description>& found) {
  const Problem& problem = tested.problem();
  const TestedHypothesis base{problem,
                              fitted(problem, tested.hypothesis(), folds.first, kShortFit)};
  const double excess = excess_on(base, folds.second);
  std::vector<Candidate> terms;
  for (const auto& form : forms) terms.push_back(form.term);
  const auto screened = screen(base, folds.first, terms);
  for (std::size_t i = 0; i < std::min(kFittedForms, screened.size()); ++i) {
    if (i > 0 && problem.progress().is_search_over()) break;
    const FreeForm& form = forms[static_cast<std::size_t>(screened[i].candidate - terms.data())];
    const auto with = with_form(base, screened[i], folds.first);
    if (!with) continue;
    const auto after = TestedHypothesis{problem, *with}.blocks(folds.second);
    if (after.empty()) continue;  // no prediction
    const double gain = 2 * (sum(base.blocks(folds.second)) - sum(after));
    found.push_back(described_by(form, problem, folds.first, *with, gain / excess));
    found.back().left = 2 * sum(after) - observations(problem, folds.second);
  }
}

}  // namespace rths::diagnosis
