// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scores.hpp"
#include "selection.hpp"

namespace rths::diagnosis {

/// One step of the forward selection: candidates are screened, the best of them fitted in heats,
/// and those that are left fitted on one fold and scored on the other, both ways.
class Round {
 public:
  /// @param stated  values of the model's own free parameters as the case states them
  Round(Problem& problem, const Folds& folds, const Hypothesis& current,
        const Eigen::VectorXd& stated, const std::vector<Candidate>& candidates,
        std::uint64_t seed);

  /// What they are compared with, fitted on the first fold.
  [[nodiscard]] const Hypothesis& base() const { return base_; }
  [[nodiscard]] std::vector<Contender>& contenders() { return contenders_; }  ///< best first

 private:
  /// A candidate after a short fit from its best start.
  struct Entrant {
    const Candidate* candidate;
    Hypothesis hypothesis;
    double least;  ///< sum of squares on the first fold
  };

  void enter(const Hypothesis& from, const std::vector<Candidate>& candidates, double base,
             std::vector<Entrant>& entrants) const;
  void warm_up(Hypothesis hypothesis, Entrant& entrant) const;
  static void keep_best(double base, std::vector<Entrant>& entrants);
  void finish(Entrant& entrant);
  void score(Contender& contender) const;
  void sort();
  void allow_for_noise();
  void reverse();
  void rank();

  Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
  Hypothesis base_;
  std::vector<double> base_scores_;
  std::vector<Contender> contenders_;
};

}  // namespace rths::diagnosis
