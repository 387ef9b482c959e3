// SPDX-License-Identifier: Apache-2.0
#include "next_test.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "designs.hpp"
#include "separation.hpp"
#include "state_coverage.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTold = 12;            // [nat] that tell two terms apart
constexpr std::size_t kTried = 4;       // tests that are looked at with all that a refit can hide,
constexpr std::size_t kTriedEmpty = 2;  // and of those on the empty table
constexpr std::size_t kMostRivals = 3;  // of a tie
constexpr double kWorthLooking = 0.02;  // of what is unexplained, that a form explains

// What is named, with another candidate in the place of one step's.
Hypothesis with_rival(const Investigation& found, std::size_t step, const Contender& rival) {
  const auto& steps = found.selection.steps;
  Hypothesis result = found.relation->base();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Candidate& candidate = i == step ? rival.candidate : steps[i].chosen.candidate;
    result = extended(result, candidate, candidate.starts[0]);
  }
  for (const Hypothesis* known : {&found.selection.named, &rival.fitted})
    for (std::size_t i = 0; i < result.free.size(); ++i)
      for (std::size_t k = 0; k < known->free.size(); ++k)
        if (result.free[i].name == known->free[k].name)
          result.values[static_cast<Index>(i)] = known->values[static_cast<Index>(k)];
  return result;
}

bool predicts_force(const Investigation& found) {
  return found.relation->outputs()[0].first.starts_with("force.");
}

// Whether there is a specimen that a laboratory can take out: a bearing, or what stands on a platen
// with a mass of its own.
bool is_removable(const Investigation& found, const Case& c) {
  if (!predicts_force(found)) return false;
  const auto& terms = found.relation->base().terms;
  return c.model.kind == "bearing" ||
         std::any_of(terms.begin(), terms.end(),
                     [](const ModelTerm& term) { return term.settings.kind == "platen_inertia"; });
}

// The tests of one investigation, and who is tied in it.
class Proposal {
 public:
  Proposal(const Investigation& found, const Case& c)
      : found_{found}, tests_{*found.problem, is_removable(found, c)} {}

  // @returns whether some test tells at least one alternative apart
  bool settle(std::size_t step, Cause& cause, Verdict& verdict) {
    const auto tied = rivals_of(found_.selection.steps[step]);
    Side chosen{found_, tests_, found_.selection.named};
    std::vector<Side> rivals;
    for (const std::size_t rival : tied)
      rivals.emplace_back(found_, tests_,
                          with_rival(found_, step, found_.selection.steps[step].tied[rival]));
    const auto tried = farthest(chosen, rivals);
    // What remains besides noise is no better known than it was.
    const double variance = std::max(1.0, found_.selection.variance_named);
    MatrixXd gain(static_cast<Index>(rivals.size()), static_cast<Index>(tried.size()));
    for (Index i = 0; i < gain.rows(); ++i)
      for (Index k = 0; k < gain.cols(); ++k)
        gain(i, k) =
            told(chosen, rivals[static_cast<std::size_t>(i)], tried[static_cast<std::size_t>(k)]) /
            variance;
    for (Index i = 0; i < gain.rows(); ++i)
      note(gain.row(i), tried, cause.alternatives[tied[static_cast<std::size_t>(i)]]);
    return name_best(gain, tried, step, tied, verdict);
  }

  void visit(const Description& what, Verdict& verdict) {
    if (tests_.designs.empty()) return;
    if (repeat(what.form, verdict)) return;
    const auto best = widest(*found_.problem, tests_.problem, found_.selection.named, what.form);
    if (!best) return;
    verdict.next_test =
        fmt::format("{}: visits {} most evenly, over which what is unexplained lies",
                    tests_.designs[best->test].text, best->state);
    take_motion(best->test, verdict);
  }

 private:
  // What depends on time alone: does it come without motion, does it come again?
  bool repeat(const std::string& form, Verdict& verdict) const {
    const auto run = [&](const char* beginning, const std::string& why) {
      for (std::size_t test = 0; test < tests_.designs.size(); ++test) {
        if (!tests_.designs[test].text.starts_with(beginning)) continue;
        verdict.next_test = fmt::format("{}: {}", tests_.designs[test].text, why);
        take_motion(test, verdict);
        return true;
      }
      return false;
    };
    if (form.find("periodic force") != std::string::npos)
      return run(kNothingMoving, "shows whether the force comes from outside");
    if (form.find("change of") != std::string::npos)
      return run(kSameAgain, "shows whether it changes again, and at what amplitude");
    return false;
  }

  // Simple ones first: what has more parameters often holds the others as special cases, which no
  // test excludes. Positions among those that are tied.
  static std::vector<std::size_t> rivals_of(const Step& step) {
    std::vector<std::size_t> rivals(step.tied.size());
    std::iota(rivals.begin(), rivals.end(), std::size_t{0});
    std::stable_sort(rivals.begin(), rivals.end(), [&](std::size_t a, std::size_t b) {
      return step.tied[a].candidate.price < step.tied[b].candidate.price;
    });
    rivals.resize(std::min(rivals.size(), kMostRivals));
    return rivals;
  }

  // Those in which the sides differ most before a refit, which is an upper bound.
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

  // The test that tells one alternative best.
  void note(const VectorXd& gain, const std::vector<std::size_t>& tried,
            Alternative& alternative) const {
    Index best = 0;
    if (gain.size() == 0 || gain.maxCoeff(&best) < kTold) return;
    alternative.test = tests_.designs[tried[static_cast<std::size_t>(best)]].text;
    alternative.sigma = std::sqrt(2 * gain[best]);
  }

  // Among those that can be told at all, the test that tells most of the worst told.
  static Index best_of(const MatrixXd& gain) {
    Index best = -1;
    double most = 0;
    for (Index k = 0; k < gain.cols(); ++k) {
      double least = 1e300;
      for (Index i = 0; i < gain.rows(); ++i)
        if (gain.row(i).maxCoeff() >= kTold) least = std::min(least, gain(i, k));
      if (least < 1e300 && least > most) most = least, best = k;
    }
    return best;
  }

  bool name_best(const MatrixXd& gain, const std::vector<std::size_t>& tried, std::size_t step,
                 const std::vector<std::size_t>& tied, Verdict& verdict) const {
    const Index best = best_of(gain);
    if (best < 0) return false;
    if (!verdict.next_test.empty()) return true;
    const Step& at = found_.selection.steps[step];
    const std::size_t test = tried[static_cast<std::size_t>(best)];
    std::string from;
    for (Index i = 0; i < gain.rows(); ++i)
      if (gain(i, best) >= kTold)
        from += fmt::format("{}{} by {:.3g} nat ({:.3g} standard deviations)",
                            from.empty() ? "" : " and ",
                            name_of(at.tied[tied[static_cast<std::size_t>(i)]].candidate, at),
                            gain(i, best), std::sqrt(2 * gain(i, best)));
    verdict.next_test = fmt::format("{}: tells {} from {}", tests_.designs[test].text,
                                    name_of(at.chosen.candidate, at), from);
    take_motion(test, verdict);
    return true;
  }

  // With its channel where another of the tie has the same name.
  static std::string name_of(const Candidate& candidate, const Step& step) {
    const auto is_like_it = [&](const Contender& other) {
      return other.candidate.name == candidate.name && other.candidate.channel != candidate.channel;
    };
    const bool is_double =
        is_like_it(step.chosen) || std::any_of(step.tied.begin(), step.tied.end(), is_like_it);
    return is_double ? fmt::format("{} ({})", candidate.name, candidate.channel) : candidate.name;
  }

  void take_motion(std::size_t test, Verdict& verdict) const {
    const Record& record = tests_.designs[test].record;
    const auto drivers = found_.relation->drivers();
    verdict.next_motion.time_step = record.time_step;
    for (const auto& channel : record.channels)
      if (channel.role == "vertical_force" || channel.role.starts_with("auxiliary.") ||
          std::find(drivers.begin(), drivers.end(), channel.role) != drivers.end())
        verdict.next_motion.channels.emplace_back(channel.role, channel.values);
  }

  const Investigation& found_;
  Tests tests_;
};

void settle_ties(const Investigation& found, const Case& c, Verdict& verdict) {
  std::unique_ptr<Proposal> proposal;
  for (std::size_t i = 0; i < found.selection.steps.size(); ++i) {
    const Step& step = found.selection.steps[i];
    if (step.tied.empty()) continue;
    const auto cause =
        std::find_if(verdict.causes.begin(), verdict.causes.end(), [&](const Cause& one) {
          return one.name == step.chosen.candidate.name &&
                 one.channel == step.chosen.candidate.channel;
        });
    if (cause == verdict.causes.end()) continue;
    if (!proposal) proposal = std::make_unique<Proposal>(found, c);
    if (!proposal->settle(i, *cause, verdict) && !found.relation->drivers().empty())
      verdict.limits.push_back(
          fmt::format("No test of the catalogue, within {} times the amplitude, the rate and the "
                      "acceleration that were visited, tells {} from what else it could be.",
                      kReach, cause->name));
  }
}

// Channels that a relation of motion and force could have used, had they been recorded.
std::string unrecorded(const Investigation& found) {
  const Record& record = found.problem->record(0);
  std::string roles;
  if (!predicts_force(found)) return roles;
  for (const char* family : {"vertical_force", "temperature", "acceleration"})
    if (std::none_of(record.channels.begin(), record.channels.end(),
                     [&](const auto& channel) { return channel.role.starts_with(family); }))
      roles += fmt::format("{}{}", roles.empty() ? "" : ", ", family);
  return roles;
}

// The relation that is shown of several is the last.
void visit_unknown(const std::vector<std::unique_ptr<Investigation>>& all, const Case& c,
                   Verdict& verdict) {
  const auto found = std::find_if(all.rbegin(), all.rend(), [](const auto& one) {
    return one->is_unknown() && !one->descriptions.empty() &&
           one->descriptions[0].share > kWorthLooking;
  });
  if (found == all.rend()) return;
  Proposal{**found, c}.visit((*found)->descriptions[0], verdict);
  const std::string roles = unrecorded(**found);
  if (!verdict.next_test.empty() && !roles.empty())
    verdict.next_test += fmt::format("; record {} with it", roles);
}

}  // namespace

void propose_next_test(const std::vector<std::unique_ptr<Investigation>>& all, const Case& c,
                       Verdict& verdict) {
  if (verdict.outcome == Outcome::Unknown) visit_unknown(all, c, verdict);
  for (const auto& found : all) settle_ties(*found, c, verdict);
}

}  // namespace rths::diagnosis
