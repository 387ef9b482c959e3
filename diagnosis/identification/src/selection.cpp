// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/selection.hpp>

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

#include "acceptance.hpp"
#include "model_comparison.hpp"
#include "named_model.hpp"
#include "round.hpp"

namespace rths::diagnosis {
namespace {

class Selector {
 public:
  Selector(Problem& problem, const Folds& folds, std::uint64_t seed, Selection selection = {})
      : problem_{problem},
        folds_{folds},
        seed_{seed},
        comparison_{problem, folds, seed},
        stated_{problem.relation().base()},
        selection_{std::move(selection)} {}

  Selection select() {
    fit_base();
    bool goes_on = true;
    while (goes_on && !is_over() && effects() < kMostTerms) goes_on = add_term();
    drop_redundant();
    if (!is_over()) join_parts();
    if (settle()) drop_redundant();
    if (!is_over()) replace_parts_of_model();
    selection_.is_complete = !is_over();
    drop_named(selection_.rounds);
    std::stable_partition(selection_.rounds.begin(), selection_.rounds.end(), std::not_fn(is_rule));
    selection_.named = fitted(problem_, current_, folds_.both, kLongFit);
    finish(problem_, folds_, selection_);
    return std::move(selection_);
  }

  Selection with_new_ties(const std::vector<Candidate>& withdrawn) {
    current_ = fitted(problem_, selection_.named, folds_.first, kShortFit);
    for (std::size_t index = 0; index < selection_.rounds.size(); ++index) {
      SelectionRound& round = selection_.rounds[index];
      const Candidate holder = round.chosen.candidate;
      auto won = comparison_at(index, withdrawn);
      if (!won) continue;
      keep_in_tie(*won, holder);
      if (is_same(won->chosen.candidate, holder)) round = std::move(*won);
    }
    return std::move(selection_);
  }

 private:
  // Number of accepted candidates that are not rules.
  [[nodiscard]] std::ptrdiff_t effects() const {
    return std::count_if(selection_.rounds.begin(), selection_.rounds.end(), std::not_fn(is_rule));
  }

  // Whether the search has done as much as it may. It then keeps what it has found.
  [[nodiscard]] bool is_over() const { return problem_.progress().is_search_over(); }

  void begin_stage(const std::string& stage) const { problem_.progress().begin_stage(stage); }

  void fit_base() {
    begin_stage("fit without missing terms");
    // The noise of the residual depends on the fitted model, not on the stated one.
    current_ = fitted(problem_, stated_, folds_.first, kShortFit);
    problem_.renew_noise(current_);
    selection_.base = fitted(problem_, current_, folds_.both, kLongFit);
    current_ = fitted(problem_, current_, folds_.first, kShortFit);
    unexplained_ = current_;
  }

  // Runs one round. @returns whether another may follow
  bool add_term() {
    begin_stage(fmt::format("search for term {}", selection_.rounds.size() + 1));
    auto won = round_with(usual_effort());
    if (explains_little(won) && !is_over()) {
      auto other = round_with(kThorough);
      if (other && (!won || other->chosen.gain > won->chosen.gain)) won = std::move(other);
    }
    if (!won) return add_pair();
    add(std::move(*won));
    // Further terms are measured by the excess that the right rule leaves, or an effect of exact
    // form.
    if (hides_nothing(selection_.rounds.back())) unexplained_ = current_;
    return true;
  }

  void add(SelectionRound round) {
    if (selection_.rounds.empty()) selection_.first = ranked_of(round);
    selection_.rounds.push_back(std::move(round));
    current_ = selection_.rounds.back().chosen.fitted;
    problem_.renew_noise(current_);
  }

  // Of two large effects, a fit with one alone imitates the other, which fails on another record.
  // So a candidate of a round without a winner may be accepted together with the winner of the next
  // round, if the two leave little: the one of the largest gain, or else the one that fits best.
  // @returns whether any was accepted
  bool add_pair() {
    if (is_over() || selection_.last.empty() || effects() + 2 > kMostTerms ||
        !explains_little(std::nullopt))
      return false;
    const ScoredCandidate first = selection_.last[0], best_fit = *best_fit_;
    return add_pair_with(first) ||
           (!is_over() && !is_same(best_fit.candidate, first.candidate) && add_pair_with(best_fit));
  }

  bool add_pair_with(const ScoredCandidate& one) {
    if (!comparison_.predicts(one.fitted)) return false;
    const Selection selection = selection_;
    const Hypothesis before = current_;
    add({one, {}, {}});
    begin_stage(fmt::format("search beside {}", one.candidate.name));
    auto won = round_with({});
    if (won && explain_the_rest(before, won->chosen.fitted)) {
      add(std::move(*won));
      defend(selection_.rounds.size() - 2, false);
      if (selection.rounds.empty()) selection_.first = selection.last;
      return true;
    }
    selection_ = selection;
    current_ = before;
    problem_.renew_noise(current_);
    return won && !depends_on(won->chosen.candidate, one.candidate) && add_alone(std::move(*won));
  }

  // The winner beside a candidate that was not accepted may be acceptable without it: its own fit
  // may have failed from far away. @returns whether it was accepted
  bool add_alone(SelectionRound won) {
    auto rounds = selection_.rounds;
    rounds.push_back(won);
    const auto is_any = [](const SelectionRound&) { return true; };
    const Hypothesis with = with_rounds(selection_.base, rounds, is_any, won.chosen.fitted);
    won.chosen.fitted = fitted(problem_, with, folds_.first, kLongFit);
    if (!comparison_.predicts(won.chosen.fitted) || !gains_enough(current_, won.chosen.fitted))
      return false;
    add(std::move(won));
    settle();
    return true;
  }

  // Whether a model with more terms leaves little beside errors of their form, and gains by them as
  // much as one term must.
  [[nodiscard]] bool explain_the_rest(const Hypothesis& before, const Hypothesis& after) const {
    const double most = kMuchLeft + kFormShare * std::max(0.0, comparison_.variance(before) - 1);
    return comparison_.variance(after) - 1 < most && gains_enough(before, after);
  }

  // Whether a model with more terms gains by them as much as one term must.
  [[nodiscard]] bool gains_enough(const Hypothesis& before, const Hypothesis& after) const {
    return comparison_.gains(comparison_.scores(before), comparison_.scores(after),
                             accepted(before, true, comparison_.scatter(after)));
  }

  // A residual that is noise as a whole may still contain a small effect, which the test of one
  // candidate shows. As the whole says that there is none, twice the usual gain is asked for, and
  // half of it in screening, on one fold.
  [[nodiscard]] Effort usual_effort() const {
    Effort effort;
    if (selection_.rounds.empty() || !comparison_.is_noise(current_)) return effort;
    double largest = 0;
    for (const auto& round : selection_.rounds) largest = std::max(largest, round.chosen.gain);
    effort.least = std::max(accepted(current_, true, 1).gain, 0.5 * kFormShare * largest);
    return effort;
  }

  // A round of this effort. Without a winner, its candidates are kept as evidence.
  std::optional<SelectionRound> round_with(const Effort& effort) {
    Round round{problem_,
                folds_,
                Round::Extended{current_, stated_.values},
                left_for(current_, selection_.rounds),
                seed_,
                effort};
    auto won = winner(round, nullptr);
    if (won && won->chosen.gain < 2 * effort.least) return std::nullopt;
    if (!won) {
      selection_.last = std::move(round.ranked());
      best_fit_ = std::move(round.best_fit());
    }
    return won;
  }

  // Whether far more is left to explain than a round has explained: a fit may have stalled.
  [[nodiscard]] bool explains_little(const std::optional<SelectionRound>& won) const {
    const double excess = comparison_.variance(current_) - 1;
    const double left = 0.5 * observations(problem_, folds_.both) * excess;
    return excess > kMuchLeft && (!won || won->chosen.gain < kLittleOfLeft * left);
  }

  // Smallest gain of a term that is accepted beside the others, in the noise of the round [nat].
  // @param is_alone  no other candidate gains half as much
  // @param scatter   of the scores, over that by noise
  [[nodiscard]] Threshold accepted(const Hypothesis& rest, bool is_alone, double scatter) const {
    const double n = observations(problem_, folds_.both);
    const auto excess = [&](const Hypothesis& model) {
      return 0.5 * n * std::max(0.0, comparison_.variance(model) - 1);
    };
    // A large effect leaves small errors of its own form, which are no effects: many terms explain
    // a little of them. A term that explains most of what is left is one, or much of it alone.
    const double share = std::min(kAcceptedShare * excess(unexplained_),
                                  (is_alone ? kAloneOfRest : kMostOfRest) * excess(rest));
    return {std::max(scatter * std::max(kLeastAcceptedGain, kAcceptedDensity * n), share),
            scatter * kLeastGainOfAnEvent};
  }

  // Takes the best candidate of a round, if it accepts one. A term may have to wait for another
  // one; a holder that is compared with its rivals has waited already.
  std::optional<SelectionRound> winner(Round& round, const Candidate* holder) const {
    auto& ranked = round.ranked();
    const Threshold least = accepted(round.base(), ranked.size() == 1, round.scatter());
    const std::vector<ScoredCandidate> waiting = held_back(ranked, holder, least, seed_);
    if (ranked.empty() || !is_acceptable(ranked[0], least, seed_) ||
        !comparison_.is_material(round.base(), ranked[0].fitted))
      return std::nullopt;
    SelectionRound won = chosen(std::move(ranked), round.rest(), seed_);
    // Waiting candidates contain the chosen one as a special case, so they support it.
    for (const auto& scored : waiting) won.chosen.confidence += scored.confidence;
    won.others.insert(won.others.begin(), waiting.begin(), waiting.end());
    return won;
  }

  // Compares each named term with its rivals in the final model, from the last term to the first,
  // until every term has been compared since the last one was replaced.
  // @returns true if a term was replaced
  bool settle() {
    const std::size_t count = selection_.rounds.size();
    bool replaced = false;
    std::size_t settled = 0;
    for (std::size_t k = 0; settled < count && k < kMostPasses * count; ++k) {
      const bool holds = defend(count - 1 - k % count);
      settled = holds ? settled + 1 : 1;
      replaced = replaced || !holds;
    }
    return replaced;
  }

  // In a tie, the holder yields only to a cheaper rival that gains as much, or to one that is no
  // dearer and predicts other rows better.
  void keep_in_tie(SelectionRound& round, const Candidate& holder) const {
    const auto held = std::find_if(round.tied.begin(), round.tied.end(), [&](const auto& tied) {
      return is_same(tied.candidate, holder);
    });
    if (held == round.tied.end()) return;
    const double price = round.chosen.candidate.price;
    const bool is_better = is_beneficial(minus(round.chosen.differences, held->differences),
                                         {kLeastAcceptedGain, kLeastGainOfAnEvent}, seed_);
    if (price <= holder.price && is_better) return;
    if (price >= holder.price || held->gain > round.chosen.gain) std::swap(round.chosen, *held);
  }

  // The candidates that may extend a model and are not named yet.
  [[nodiscard]] std::vector<Candidate> left_for(const Hypothesis& model,
                                                const std::vector<SelectionRound>& rounds) const {
    auto candidates = problem_.relation().candidates(model);
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return !may_extend(model, candidate) ||
             std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& round) {
               return is_same(round.chosen.candidate, candidate);
             });
    });
    return candidates;
  }

  // A named term among its rivals in its place; nothing if it needs no comparison, or none is
  // acceptable.
  // @param barred  candidates that are no rivals
  std::optional<SelectionRound> comparison_at(std::size_t index,
                                              const std::vector<Candidate>& barred) {
    const auto& rounds = selection_.rounds;
    const Candidate& holder = rounds[index].chosen.candidate;
    begin_stage("rivals of " + holder.name);
    if (is_over() || is_needed(selection_, index)) return std::nullopt;
    const auto is_other = [&](const SelectionRound& round) { return &round != &rounds[index]; };
    std::vector<SelectionRound> others;
    std::copy_if(rounds.begin(), rounds.end(), std::back_inserter(others), is_other);
    const Hypothesis rest = with_rounds(selection_.base, rounds, is_other, current_);
    auto rivals = left_for(rest, others);
    std::erase_if(rivals, [&](const Candidate& rival) {
      return std::any_of(barred.begin(), barred.end(),
                         [&](const Candidate& one) { return is_same(one, rival); });
    });
    Round round{problem_, folds_, {holder, rest, current_}, rivals, seed_};
    return winner(round, &holder);
  }

  // Compares a named term with its rivals in its place. @returns false if a rival replaces it
  // @param holds_ties  whether a rival that gains less does not replace it in a tie
  bool defend(std::size_t index, bool holds_ties = true) {
    auto& rounds = selection_.rounds;
    const Candidate holder = rounds[index].chosen.candidate;
    auto won = comparison_at(index, {});
    if (!won) return true;
    if (holds_ties) keep_in_tie(*won, holder);
    rounds[index] = std::move(*won);
    current_ = rounds[index].chosen.fitted;
    problem_.renew_noise(current_);
    return is_same(rounds[index].chosen.candidate, holder);
  }

  // A law may have been found in parts: friction and viscous damping imitate a power of velocity.
  // It takes their place if it predicts other rows better than they do together. One that is their
  // sum need not: one cause is likelier than two.
  void join_parts() {
    const auto candidates = problem_.relation().candidates(selection_.base);
    for (const Candidate& law : candidates) {
      auto& rounds = selection_.rounds;
      const bool is_sum =
          !law.sum_of.empty() &&
          std::all_of(law.sum_of.begin(), law.sum_of.end(), [&](const auto& part) {
            return std::any_of(rounds.begin(), rounds.end(), [&](const auto& round) {
              return round.chosen.candidate.name == part;
            });
          });
      const auto is_part = [&](const SelectionRound& round) {
        const Candidate& part = round.chosen.candidate;
        return part.channel == law.channel &&
               contains(is_sum ? law.sum_of : law.contains, part.name);
      };
      const auto is_law = [&](const SelectionRound& round) {
        return is_same(round.chosen.candidate, law);
      };
      if (std::none_of(rounds.begin(), rounds.end(), is_part) ||
          std::any_of(rounds.begin(), rounds.end(), is_law))
        continue;
      begin_stage("parts of " + law.name);
      const Hypothesis rest = with_rounds(selection_.base, rounds, std::not_fn(is_part), current_);
      if (!may_extend(rest, law)) continue;
      Round round{problem_, folds_, Round::Extended{rest, stated_.values}, {law}, seed_, kThorough};
      if (round.ranked().empty()) continue;
      ScoredCandidate whole = std::move(round.ranked()[0]);
      if (!comparison_.predicts(whole.fitted) ||
          (is_sum ? gains_enough(whole.fitted, current_) : !gains_enough(current_, whole.fitted)))
        continue;
      std::erase_if(rounds, is_part);
      current_ = whole.fitted;
      rounds.push_back({std::move(whole), {}, {}});
      problem_.renew_noise(current_);
    }
  }

  // A law may compensate its special case in the model: of damping with a power of velocity and
  // friction, the power and the model's own viscous friction imitate both. The law without that
  // special case, and beside it another candidate, replace it if they predict other rows better.
  void replace_parts_of_model() {
    std::vector<Candidate> replacing = problem_.relation().candidates(selection_.base);
    std::erase_if(replacing, [](const Candidate& candidate) { return candidate.replaces.empty(); });
    for (std::size_t i = 0; i < selection_.rounds.size(); ++i) {
      if (!selection_.rounds[i].chosen.candidate.replaces.empty()) continue;
      for (const Candidate& law : replacing)
        if (is_same(law, selection_.rounds[i].chosen.candidate) && replace_parts(i, law)) break;
    }
  }

  // @returns whether the law, which stands for parts of the model, took the place of a round
  bool replace_parts(std::size_t index, const Candidate& law) {
    auto& rounds = selection_.rounds;
    const auto is_other = [&](const SelectionRound& round) { return &round != &rounds[index]; };
    Hypothesis rest =
        extended(with_rounds(selection_.base, rounds, is_other, current_), law, law.starts[0]);
    take_values(current_, rest);
    begin_stage("parts of the model in " + law.name);
    Round round{problem_, folds_, Round::Extended{rest, stated_.values}, left_for(rest, rounds),
                seed_};
    if (round.ranked().empty()) return false;
    ScoredCandidate more = std::move(round.ranked()[0]);
    if (!comparison_.predicts(more.fitted) ||
        !comparison_.gains(
            comparison_.scores(current_), comparison_.scores(more.fitted),
            {comparison_.scatter(more.fitted) * kLeastAcceptedGain / 2, kLeastGainOfAnEvent}))
      return false;
    rounds[index].chosen.candidate = law;
    rounds[index].chosen.fitted = current_ = more.fitted;
    rounds.push_back({std::move(more), {}, {}});
    problem_.renew_noise(current_);
    return true;
  }

  // Backward selection: removes candidates that later ones have made redundant.
  void drop_redundant() {
    auto& rounds = selection_.rounds;
    if (rounds.size() < 2) return;
    auto with = comparison_.scores(current_);
    double scatter = comparison_.scatter(current_);
    for (std::size_t i = 0; rounds.size() > 1 && i < rounds.size();) {
      if (is_needed(selection_, i)) {
        ++i;
        continue;
      }
      const auto is_other = [&](const SelectionRound& round) { return &round != &rounds[i]; };
      const Hypothesis rest =
          fitted(problem_, with_rounds(selection_.base, rounds, is_other, current_), folds_.first,
                 kLongFit);
      auto without = comparison_.scores(rest);
      if (comparison_.gains(without, with,
                            {scatter * kLeastAcceptedGain / 2, scatter * kLeastGainOfAnEvent})) {
        ++i;
        continue;
      }
      rounds.erase(rounds.begin() + static_cast<std::ptrdiff_t>(i));
      current_ = rest;
      with = std::move(without);
      scatter = comparison_.scatter(current_);
      i = 0;
    }
  }

  Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
  ModelComparison comparison_;
  Hypothesis stated_, current_;
  Hypothesis unexplained_;                   // without the terms that are still to be found
  std::optional<ScoredCandidate> best_fit_;  // of the round without a winner that `last` describes
  Selection selection_;
};

}  // namespace

Selection select(Problem& problem, const Folds& folds, std::uint64_t seed) {
  return Selector{problem, folds, seed}.select();
}

void renew_ties(Problem& problem, const Folds& folds, std::uint64_t seed,
                const std::vector<Candidate>& withdrawn, Selection& selection) {
  selection = Selector{problem, folds, seed, selection}.with_new_ties(withdrawn);
}

}  // namespace rths::diagnosis
