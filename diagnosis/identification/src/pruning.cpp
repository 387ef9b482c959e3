// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/pruning.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/identification/constants.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/proof.hpp>
#include <rths/identification/scores.hpp>

#include "form_search.hpp"
#include "named_model.hpp"

namespace rths::diagnosis {
namespace {

// A candidate that no other one depends on.
// @param rest  the fitted model without it
Withdrawn withdraw(Problem& problem, const Folds& folds, Selection& selection, std::size_t index,
                   Hypothesis rest, const std::string& reason) {
  auto& rounds = selection.rounds;
  Withdrawn one{rounds[index].chosen.candidate, reason};
  selection.named = std::move(rest);
  rounds.erase(rounds.begin() + static_cast<std::ptrdiff_t>(index));
  finish(problem, folds, selection);
  return one;
}

// The last candidate to withdraw where only rules of the model itself may stay: a rule of a
// withdrawn term goes before the term.
std::optional<std::size_t> last_to_withdraw(const Selection& selection) {
  const auto& rounds = selection.rounds;
  for (std::size_t i = rounds.size(); i-- > 0;)
    if ((!is_rule(rounds[i]) || changes_named(rounds, rounds[i])) && !is_needed(selection, i))
      return i;
  return std::nullopt;
}

// Share of the residual that a form explains.
double share_of(const std::string& form, const std::vector<Description>& descriptions) {
  const auto found = std::find_if(descriptions.begin(), descriptions.end(),
                                  [&](const Description& one) { return one.form == form; });
  return found == descriptions.end() ? 0 : found->share;
}

bool is_gap(const FreeParameter& free) {
  const std::string_view name = last_name(free.name);
  return free.unit == "m" && (name == "gap" || name == "slack" || name == "play");
}

// Whether the shape of its law is fitted, and not only its size.
bool has_shape(const Candidate& candidate) {
  return std::any_of(candidate.frees.begin(), candidate.frees.end(), [](const FreeParameter& free) {
    return !free.absent && last_name(free.name) != "presliding";
  });
}

class Pruning {
 public:
  Pruning(Problem& problem, const Problem* held_out, const Folds& folds, const SensorNoise& noise,
          Selection& selection)
      : problem_{problem},
        held_out_{held_out},
        folds_{folds},
        noise_{noise},
        selection_{selection} {}

  std::vector<Withdrawn> run() {
    std::vector<Withdrawn> withdrawn;
    while (auto one = weakest())
      withdrawn.push_back(withdraw(problem_, folds_, selection_, one->first,
                                   without(problem_, folds_, selection_, one->first), one->second));
    return withdrawn;
  }

 private:
  using Weak = std::optional<std::pair<std::size_t, std::string>>;

  Weak weakest() {
    if (selection_.rounds.empty()) return std::nullopt;
    reference_ = reference();
    if (auto weak = absent()) return weak;
    return held_out_ != nullptr ? unproven() : std::nullopt;
  }

  // The last candidate that may as well not be there.
  Weak absent() const {
    const MatrixXd covariance =
        covariance_of(problem_, folds_.both, selection_.named,
                      fold_disagreement(problem_, folds_, selection_.named));
    const auto estimates = estimates_of(selection_.named, covariance);
    for (std::size_t i = selection_.rounds.size(); i-- > 0;) {
      const Candidate& candidate = selection_.rounds[i].chosen.candidate;
      if (is_needed(selection_, i)) continue;
      if (is_within_noise(candidate, estimates) &&
          fit_share(without(problem_, folds_, selection_, i)) < kSeenShare)
        return {{i, "its size lies within the noise of the displacement"}};
      if (is_within_sample(candidate, estimates))
        return {{i, "it shifts signals by less than a tenth of the time between samples"}};
      if (may_be_absent(candidate, selection_.named, covariance))
        return {{i, "its size may be zero"}};
      if (is_contradicted(candidate, estimates))
        return {{i, "its channel has read more than this limit"}};
      if (is_at_bound(candidate))
        return {{i, "its size lies on a bound of the search, as that of another effect would"}};
    }
    return std::nullopt;
  }

  static const Estimate* estimate_of(const std::string& name,
                                     const std::vector<Estimate>& estimates) {
    const auto found = std::find_if(estimates.begin(), estimates.end(),
                                    [&](const Estimate& one) { return one.name == name; });
    return found == estimates.end() ? nullptr : &*found;
  }

  bool is_within_noise(const Candidate& candidate, const std::vector<Estimate>& estimates) const {
    const auto drivers = problem_.relation().drivers();
    if (drivers.empty() || !drivers[0].starts_with("displacement.")) return false;
    const double deviation = noise_.deviation("displacement");
    const double peak = problem_.drive(0).measured.cwiseAbs().maxCoeff();
    return std::any_of(candidate.frees.begin(), candidate.frees.end(), [&](const auto& free) {
      const Estimate* size = estimate_of(free.name, estimates);
      if (size == nullptr) return false;
      if (free.unit == "m/N") return std::abs(size->value) * peak < kLeastFlexion * deviation;
      return is_gap(free) && size->value < kLeastGap * deviation;
    });
  }

  // A recording code's own integration shifts signals by a fraction of its time step. A drift of
  // the clock has a rate beside its shift, and grows.
  bool is_within_sample(const Candidate& candidate, const std::vector<Estimate>& estimates) const {
    const double least = kLeastShift * problem_.record(0).time_step;
    bool has_size = false;
    for (const auto& free : candidate.frees) {
      const Estimate* size = estimate_of(free.name, estimates);
      if (!free.absent || size == nullptr) continue;
      has_size = true;
      if (free.unit != "s" || std::abs(size->value - *free.absent) >= least) return false;
    }
    return has_size;
  }

  // A sensor that has read more than a limit does not saturate there.
  bool is_contradicted(const Candidate& candidate, const std::vector<Estimate>& estimates) const {
    if (candidate.kind != "saturation" || candidate.part != Part::Sensor) return false;
    const Estimate* limit = estimate_of(candidate.frees[0].name, estimates);
    if (limit == nullptr) return false;
    double largest = 0;
    for (const Problem* problem : {&std::as_const(problem_), held_out_})
      for (std::size_t i = 0; problem != nullptr && i < problem->records(); ++i)
        for (const auto& channel : problem->record(i).channels)
          if ((channel.role == candidate.channel || family_of(channel.role) == candidate.channel) &&
              channel.role.ends_with(candidate.axis))
            largest = std::max(largest, values_of(channel).cwiseAbs().maxCoeff());
    const double noise = kNoisyReading * noise_.deviation(family_of(candidate.channel));
    return limit->value + noise < kReadRange * largest;
  }

  // Whether a size ended at a bound that does not mean its absence. All of a share is a size, too.
  bool is_at_bound(const Candidate& candidate) const {
    const Hypothesis& named = selection_.named;
    for (std::size_t i = 0; i < named.free.size(); ++i) {
      const FreeParameter& free = named.free[i];
      const auto index = static_cast<Index>(i);
      if (free.absent && free.unit != "-" && is_on_bound(named, index, kOnBound) &&
          std::abs(named.values[index] - *free.absent) > kOnBound * free.scale &&
          std::any_of(candidate.frees.begin(), candidate.frees.end(),
                      [&](const FreeParameter& own) { return own.name == free.name; }))
        return true;
    }
    return false;
  }

  // Shares are those of the error that the right rule and effects of exact form leave.
  [[nodiscard]] Hypothesis reference() const {
    const auto& rounds = selection_.rounds;
    const auto is_kept = [&](const SelectionRound& round) {
      return hides_nothing(round) && !changes_named(rounds, round);
    };
    if (std::none_of(rounds.begin(), rounds.end(), is_kept)) return selection_.base;
    return fitted(problem_, with_rounds(selection_.base, rounds, is_kept, selection_.named),
                  folds_.both, kLongFit);
  }

  // Energies of the errors on the held-out records.
  struct HeldOutErrors {
    std::vector<double> with, base, noise;
  };

  // Why a candidate is as good as absent on the held-out records, without which their errors are
  // `bare`; empty if it is not.
  [[nodiscard]] std::string reason_against(const Candidate& candidate, const HeldOutErrors& held,
                                           const std::vector<double>& bare,
                                           const Hypothesis& rest) const {
    for (std::size_t k = bare.size(); k-- > 0;)
      if (held.with[k] - bare[k] > kWorse * std::max(bare[k], held.noise[k]))
        return fmt::format("with it, {} is predicted worse", held_out_->record(k).name);
    const double gain = sum(bare) - sum(held.with);
    // An error of the form of the others is explained in part. What explains most is an effect.
    const double excess = sum(bare) - sum(held.noise);
    const bool explains_rest =
        !candidate.corrects_form && excess > sum(held.noise) && gain > kRestShare * excess;
    const double least = candidate.corrects_form ? kLeastShareOfCorrection : kLeastShare;
    const bool is_small =
        !explains_rest && gain < least * sum(held.base) && fit_share(rest) < kFitShare;
    return is_small ? fmt::format("it explains less than {:g} % of the unseen records' error",
                                  100 * least)
                    : "";
  }

  // The candidate without which the held-out records are predicted best, if that is better than
  // with it, or hardly worse.
  Weak unproven() {
    HeldOutErrors held{errors(*held_out_, selection_.named), errors(*held_out_, reference_), {}};
    for (std::size_t k = 0; k < held.with.size(); ++k)
      held.noise.push_back(std::pow(nrmse_of_noise(*held_out_, k), 2));
    Weak worst;
    double best = 0;
    for (std::size_t i = 0; i < selection_.rounds.size(); ++i) {
      if (is_needed(selection_, i)) continue;
      const Hypothesis rest = without(problem_, folds_, selection_, i);
      const auto bare = errors(*held_out_, rest);
      const std::string reason =
          reason_against(selection_.rounds[i].chosen.candidate, held, bare, rest);
      const double gain = sum(bare) - sum(held.with);
      if (reason.empty() || (worst && gain >= best)) continue;
      best = gain;
      worst = {{i, reason}};
    }
    return worst;
  }

  // What a candidate explains of the error of the records that were fitted, in energy. A rare event
  // on a held-out record may hide it there.
  [[nodiscard]] double fit_share(const Hypothesis& rest) const {
    const auto with = errors(problem_, selection_.named), bare = errors(problem_, rest),
               base = errors(problem_, reference_);
    return (sum(bare) - sum(with)) / sum(base);
  }

  // Squares of NRMSE; infinite where there is no prediction.
  [[nodiscard]] std::vector<double> errors(const Problem& problem,
                                           const Hypothesis& hypothesis) const {
    std::vector<double> all;
    const Zeros zeros = zeros_of({problem, selection_.named});
    const TestedHypothesis tested{problem, hypothesis};
    for (std::size_t i = 0; i < problem.records(); ++i) {
      const double error = nrmse(tested, i, zeros);
      all.push_back(std::isfinite(error) ? error * error : 1e300);
    }
    return all;
  }

  Problem& problem_;
  const Problem* held_out_;
  const Folds& folds_;
  const SensorNoise& noise_;
  Selection& selection_;
  Hypothesis reference_;
};

}  // namespace

std::vector<Withdrawn> prune(Problem& problem, const Problem* held_out, const Folds& folds,
                             const SensorNoise& noise, Selection& selection) {
  return Pruning{problem, held_out, folds, noise, selection}.run();
}

std::vector<Withdrawn> withdraw_all(Problem& problem, const Folds& folds, const std::string& reason,
                                    Selection& selection) {
  std::vector<Withdrawn> withdrawn;
  while (const auto last = last_to_withdraw(selection))
    withdrawn.push_back(withdraw(problem, folds, selection, *last,
                                 without(problem, folds, selection, *last), reason));
  return withdrawn;
}

std::optional<Withdrawn> withdraw_for_form(Problem& problem, const Folds& folds,
                                           const std::vector<Description>& forms,
                                           Selection& selection) {
  if (forms.empty()) return std::nullopt;
  // Energies beyond the noise on the second fold.
  const double rest = excess_on({problem, selection.named}, folds.second);
  const double of_form = forms[0].share * rest;
  for (std::size_t i = selection.rounds.size(); i-- > 0;) {
    if (is_needed(selection, i)) continue;
    Hypothesis without_it = without(problem, folds, selection, i);
    const TestedHypothesis bare{problem, without_it};
    const double bare_rest = excess_on(bare, folds.second), explained = bare_rest - rest;
    if (explained > of_form) continue;
    const double of_form_alone = share_of(forms[0].form, describe(bare, folds)) * bare_rest;
    if (of_form_alone - of_form > kTakenOver * explained)
      return withdraw(problem, folds, selection, i, std::move(without_it),
                      "the residual's form explains it too");
  }
  return std::nullopt;
}

std::optional<Withdrawn> withdraw_for_law(Problem& problem, const Folds& folds,
                                          Selection& selection) {
  const double rest = excess_on({problem, selection.named}, folds.both);
  if (rest < kPlain * observations(problem, folds.both)) return std::nullopt;
  for (std::size_t i = selection.rounds.size(); i-- > 0;) {
    if (is_needed(selection, i) || !has_shape(selection.rounds[i].chosen.candidate)) continue;
    Hypothesis bare = without(problem, folds, selection, i);
    const double left = least_left({problem, bare}, folds.both);
    if (left < kLawLeaves * rest)
      return withdraw(problem, folds, selection, i, std::move(bare),
                      "a drawn law in its place leaves far less");
  }
  return std::nullopt;
}

}  // namespace rths::diagnosis
