// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment_design/proposal.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <rths/identification/constants.hpp>
#include <rths/sim/term.hpp>

#include "designs.hpp"
#include "separation.hpp"
#include "state_coverage.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kSeparates = 12;       // [nat]: gain that separates two terms
constexpr std::size_t kTried = 4;       // tests with the specimen that are scored with a refit
constexpr std::size_t kTriedEmpty = 2;  // the same on the empty table
constexpr double kCertain = 100;        // [standard deviations]: larger separations say no more

// Distance of two predictions with this expected gain.
double separation_of(double gain) { return std::min(kCertain, std::sqrt(2 * gain)); }

// The named terms, with a rival in place of the candidate of one round.
Hypothesis with_rival(const RelationFindings& found, std::size_t round,
                      const ScoredCandidate& rival) {
  const auto& rounds = found.selection.rounds;
  Hypothesis result = found.relation->base();
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const Candidate& candidate = i == round ? rival.candidate : rounds[i].chosen.candidate;
    result = extended(result, candidate, candidate.starts[0]);
  }
  for (const Hypothesis* known : {&found.selection.named, &rival.fitted})
    for (std::size_t i = 0; i < result.free.size(); ++i)
      for (std::size_t k = 0; k < known->free.size(); ++k)
        if (result.free[i].name == known->free[k].name)
          result.values[static_cast<Index>(i)] = known->values[static_cast<Index>(k)];
  return result;
}

bool predicts_force(const RelationFindings& found) {
  return found.relation->outputs()[0].first.starts_with("force.");
}

// Whether the laboratory can remove the specimen: a bearing, or an object on a platen with a mass
// of its own.
bool is_removable(const RelationFindings& found, bool is_bearing) {
  if (!predicts_force(found)) return false;
  const auto& terms = found.relation->base().terms;
  return is_bearing || std::any_of(terms.begin(), terms.end(), [](const ModelTerm& term) {
           return sim::has_trait(term.settings.kind, sim::kInertial);
         });
}

// Possible tests of a relation, and its ties.
class Proposal {
 public:
  Proposal(const RelationFindings& found, bool is_bearing)
      : found_{found}, tests_{*found.problem, is_removable(found, is_bearing)} {}

  // @returns whether some test separates at least one alternative
  bool separate(std::size_t round, TestProposal& next) const {
    const auto tied = rivals_of(found_.selection.rounds[round]);
    Side chosen{found_, tests_, found_.selection.named};
    std::vector<Side> rivals;
    for (const std::size_t rival : tied)
      rivals.emplace_back(found_, tests_,
                          with_rival(found_, round, found_.selection.rounds[round].tied[rival]));
    const auto tried = farthest(chosen, rivals);
    // A residual beyond the noise counts as noise of the test.
    const double variance = std::max(1.0, found_.selection.variance_named);
    MatrixXd gain(static_cast<Index>(rivals.size()), static_cast<Index>(tried.size()));
    for (Index i = 0; i < gain.rows(); ++i)
      for (Index k = 0; k < gain.cols(); ++k)
        gain(i, k) = expected_gain(chosen, rivals[static_cast<std::size_t>(i)],
                                   tried[static_cast<std::size_t>(k)]) /
                     variance;
    for (Index i = 0; i < gain.rows(); ++i)
      add_best_test(gain.row(i), tried, round, tied[static_cast<std::size_t>(i)], next);
    return propose_best(gain, tried, round, tied, next);
  }

  void cover(const Description& form, TestProposal& next) const {
    if (tests_.designs.empty()) return;
    if (repeat(form.form, next)) return;
    const auto best = widest(*found_.problem, tests_.problem, found_.selection.named, form.form);
    if (!best) return;
    next.text = fmt::format("{}: covers {} most evenly, on which the residual depends",
                            tests_.designs[best->test].text, best->state);
    take_motion(best->test, next);
  }

 private:
  // For residuals that depend on time alone: a test without motion, or the same test again.
  bool repeat(const std::string& form, TestProposal& next) const {
    const auto run = [&](const char* beginning, const std::string& why) {
      for (std::size_t test = 0; test < tests_.designs.size(); ++test) {
        if (!tests_.designs[test].text.starts_with(beginning)) continue;
        next.text = fmt::format("{}: {}", tests_.designs[test].text, why);
        take_motion(test, next);
        return true;
      }
      return false;
    };
    if (form.find("periodic force") != std::string::npos)
      return run(kNothingMoving, "shows whether the force comes from outside");
    if (form.find("change of") != std::string::npos)
      return run(kSameAgain, "shows whether it changes again, and at which amplitude");
    return false;
  }

  // Indices of tied candidates, those with the fewest parameters first. One with more parameters
  // often contains the others as special cases, which no test excludes.
  static std::vector<std::size_t> rivals_of(const SelectionRound& round) {
    std::vector<std::size_t> rivals(round.tied.size());
    std::iota(rivals.begin(), rivals.end(), std::size_t{0});
    std::stable_sort(rivals.begin(), rivals.end(), [&](std::size_t a, std::size_t b) {
      return round.tied[a].candidate.price < round.tied[b].candidate.price;
    });
    rivals.resize(std::min(rivals.size(), kMostRivals));
    return rivals;
  }

  // Tests in which the predictions differ most before a refit, which is an upper bound.
  std::vector<std::size_t> farthest(Side& chosen, std::vector<Side>& rivals) const {
    std::vector<double> apart(tests_.designs.size(), 0.0);
    for (std::size_t test = 0; test < apart.size(); ++test)
      for (auto& rival : rivals) apart[test] += distance(chosen, rival, test);
    std::vector<std::size_t> order(tests_.designs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return apart[a] > apart[b]; });
    std::vector<std::size_t> tried;
    for (const bool is_empty : {false, true}) {
      std::size_t free = is_empty ? kTriedEmpty : kTried;
      for (const std::size_t test : order)
        if (tests_.designs[test].is_empty == is_empty && free > 0) tried.push_back(test), --free;
    }
    return tried;
  }

  // Adds the test that best separates a tied candidate.
  void add_best_test(const VectorXd& gain, const std::vector<std::size_t>& tried, std::size_t round,
                     std::size_t tied, TestProposal& next) const {
    Index best = 0;
    if (gain.size() == 0 || gain.maxCoeff(&best) < kSeparates) return;
    next.separating.push_back({&found_.selection.rounds[round], tied,
                               tests_.designs[tried[static_cast<std::size_t>(best)]].text,
                               separation_of(gain[best])});
  }

  // Of the rivals that some test separates: the test with the largest gain for the worst of them.
  static Index best_of(const MatrixXd& gain) {
    Index best = -1;
    double most = 0;
    for (Index k = 0; k < gain.cols(); ++k) {
      double least = 1e300;
      for (Index i = 0; i < gain.rows(); ++i)
        if (gain.row(i).maxCoeff() >= kSeparates) least = std::min(least, gain(i, k));
      if (least < 1e300 && least > most) most = least, best = k;
    }
    return best;
  }

  bool propose_best(const MatrixXd& gain, const std::vector<std::size_t>& tried, std::size_t round,
                    const std::vector<std::size_t>& tied, TestProposal& next) const {
    const Index best = best_of(gain);
    if (best < 0) return false;
    if (!next.text.empty()) return true;
    const SelectionRound& selected = found_.selection.rounds[round];
    const std::size_t test = tried[static_cast<std::size_t>(best)];
    std::string from;
    for (Index i = 0; i < gain.rows(); ++i)
      if (gain(i, best) >= kSeparates)
        from += fmt::format(
            "{}{} by {}{:.3g} standard deviations", from.empty() ? "" : " and ",
            name_of(selected.tied[tied[static_cast<std::size_t>(i)]].candidate, selected),
            separation_of(gain(i, best)) < kCertain ? "" : "more than ",
            separation_of(gain(i, best)));
    next.text = fmt::format("{}: separates {} from {}", tests_.designs[test].text,
                            name_of(selected.chosen.candidate, selected), from);
    take_motion(test, next);
    return true;
  }

  // Name of a candidate, with its channel where another of the tie has the same name.
  static std::string name_of(const Candidate& candidate, const SelectionRound& round) {
    const auto is_like_it = [&](const ScoredCandidate& other) {
      return other.candidate.name == candidate.name && other.candidate.channel != candidate.channel;
    };
    const bool is_double =
        is_like_it(round.chosen) || std::any_of(round.tied.begin(), round.tied.end(), is_like_it);
    return is_double ? fmt::format("{} ({})", candidate.name, candidate.channel) : candidate.name;
  }

  void take_motion(std::size_t test, TestProposal& next) const {
    const Record& record = tests_.designs[test].record;
    const auto drivers = found_.relation->drivers();
    next.motion.time_step = record.time_step;
    for (const auto& channel : record.channels)
      if (channel.role == "vertical_force" || channel.role.starts_with("auxiliary.") ||
          std::find(drivers.begin(), drivers.end(), channel.role) != drivers.end())
        next.motion.channels.emplace_back(channel.role, channel.values);
  }

  const RelationFindings& found_;
  Tests tests_;
};

void separate_ties(const RelationFindings& found, bool is_bearing, TestProposal& next) {
  std::unique_ptr<Proposal> proposal;
  for (std::size_t i = 0; i < found.selection.rounds.size(); ++i) {
    const SelectionRound& round = found.selection.rounds[i];
    if (round.tied.empty()) continue;
    if (!proposal) proposal = std::make_unique<Proposal>(found, is_bearing);
    if (!proposal->separate(i, next) && !found.relation->drivers().empty())
      next.inseparable.push_back(&round);
  }
}

// Unrecorded channels that a relation of motion and force can use.
std::string unrecorded(const RelationFindings& found) {
  const Record& record = found.problem->record(0);
  std::string roles;
  if (!predicts_force(found)) return roles;
  for (const char* family : {"vertical_force", "temperature", "acceleration"})
    if (std::none_of(record.channels.begin(), record.channels.end(),
                     [&](const auto& channel) { return channel.role.starts_with(family); }))
      roles += fmt::format("{}{}", roles.empty() ? "" : ", ", family);
  return roles;
}

// Of several unknown relations, the verdict shows the last.
void cover_unknown(const std::vector<std::unique_ptr<RelationFindings>>& all, bool is_bearing,
                   TestProposal& next) {
  const auto found = std::find_if(all.rbegin(), all.rend(), [](const auto& one) {
    return one->is_unknown() && !one->descriptions.empty() &&
           one->descriptions[0].share > kLeastShareOfForm;
  });
  if (found == all.rend()) return;
  Proposal{**found, is_bearing}.cover((*found)->descriptions[0], next);
  const std::string roles = unrecorded(**found);
  if (!next.text.empty() && !roles.empty()) next.text += fmt::format("; also record {}", roles);
}

}  // namespace

TestProposal propose_test(const std::vector<std::unique_ptr<RelationFindings>>& all,
                          bool is_bearing, bool is_unknown) {
  TestProposal next;
  // A test is a motion over time.
  if (!all[0]->first.has_time) return next;
  if (is_unknown) cover_unknown(all, is_bearing, next);
  for (const auto& found : all) separate_ties(*found, is_bearing, next);
  return next;
}

}  // namespace rths::diagnosis
