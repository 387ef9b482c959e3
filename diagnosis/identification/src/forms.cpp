// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/forms.hpp>

#include <algorithm>

#include <rths/identification/constants.hpp>

#include "form_search.hpp"

namespace rths::diagnosis {

double excess_on(const TestedHypothesis& tested, const Fold& fold) {
  return observations(tested.problem(), fold) * std::max(kLeastExcess, tested.variance(fold) - 1);
}

namespace {

bool share_a_record(const Folds& folds) {
  const auto& first = folds.first.shares;
  return std::any_of(first.begin(), first.end(), [&](const Fold::Share& one) {
    const auto& second = folds.second.shares;
    return std::any_of(second.begin(), second.end(),
                       [&](const Fold::Share& other) { return other.record == one.record; });
  });
}

}  // namespace

std::vector<Description> describe(const TestedHypothesis& tested, const Folds& folds) {
  std::vector<Description> found;
  const Problem& problem = tested.problem();
  const bool has_states = problem.drive(0).displacement.size() > 0;
  const auto free_forms = problem.relation().forms(tested.hypothesis());
  if (!free_forms.empty())
    fit_forms(tested, folds, free_forms, found);
  else if (has_states && !problem.relation().runs_freely())
    regress_forms(tested, folds, found);
  if (has_states) {
    find_periodic_force(tested, folds, found);
    find_held_samples(tested, folds, found);
  }
  find_change(tested, folds, found);
  for (auto& one : found) one.is_of_pieces = share_a_record(folds);
  // A surface contains every curve over one of its arguments, so it must explain more than the
  // curve.
  const auto worth = [](const Description& one) {
    const bool is_surface = one.form == "g(u, v)" || one.form == "f(u_long, u_lat)";
    return one.share - (is_surface ? kPriceOfSurface : 0);
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Description& a, const Description& b) { return worth(a) > worth(b); });
  return found;
}

}  // namespace rths::diagnosis
