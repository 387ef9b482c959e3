// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <rths/identification/scores.hpp>
#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// How many candidates a round tries, and how hard.
struct Effort {
  std::size_t starts = 2;                            ///< of a candidate
  std::size_t tried = 10, kept = 5, most_kept = 10;  ///< candidates: in short fits, in long fits
  int short_fit = 3;                                 ///< iterations of a short fit
  double least = 6;  ///< screened gain below which a candidate is not fitted [nat]
};
/// Where a fit may have stalled.
inline constexpr Effort kThorough{4, 16, 6, 10, 5};

/// One round of the forward selection. It screens the candidates, tries short fits of the best
/// ones, fits the remaining ones on one fold and scores them on the other, then with the folds
/// exchanged.
class Round {
 public:
  /// A model that gets one more term.
  struct Extended {
    const Hypothesis& model;
    const VectorXd& stated;  ///< values of its own free parameters in the case
  };
  Round(Problem& problem, const Folds& folds, const Extended& extended,
        const std::vector<Candidate>& candidates, std::uint64_t seed, const Effort& effort = {});
  /// A term that the model has already.
  struct Defended {
    const Candidate& holder;  ///< the term, one of the candidates
    const Hypothesis& rest;   ///< the model without it
    const Hypothesis& whole;  ///< the model with it
  };
  /// A round for the place of such a term. The fits of all candidates start at the values of the
  /// whole model.
  Round(Problem& problem, const Folds& folds, const Defended& term,
        const std::vector<Candidate>& candidates, std::uint64_t seed);

  /// The hypothesis without any candidate, fitted on the first fold.
  [[nodiscard]] const Hypothesis& base() const { return base_; }
  [[nodiscard]] std::vector<ScoredCandidate>& ranked() { return ranked_; }  ///< best first
  /// Of the best candidate on rows that it was not fitted to, see scatter_of [-].
  [[nodiscard]] double scatter() const { return scatter_; }
  /// Energy beyond the noise that the best candidate leaves on these rows [nat].
  [[nodiscard]] double rest() const { return rest_; }
  /// The candidate that fits the first fold best, however it predicts the second one; none if no
  /// candidate was fitted.
  [[nodiscard]] std::optional<ScoredCandidate>& best_fit() { return best_fit_; }

 private:
  /// A candidate after a short fit from its best start.
  struct ShortFit {
    const Candidate* candidate;
    Hypothesis hypothesis;
    double least;  ///< sum of squares on the first fold
  };

  void compare(double base, std::vector<ShortFit> fits);
  void try_best(const Hypothesis& from, const std::vector<Candidate>& candidates, double base,
                std::vector<ShortFit>& fits) const;
  void try_rivals(const Defended& term, const std::vector<Candidate>& candidates, double base,
                  std::vector<ShortFit>& fits) const;
  void fit_shortly(Hypothesis hypothesis, ShortFit& best) const;
  void keep_best(double base, std::vector<ShortFit>& fits) const;
  void finish(ShortFit& fit);
  void score(ScoredCandidate& scored) const;
  void sort();
  void allow_for_noise();
  void reverse();
  void rank();
  void measure_rest();

  Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
  Effort effort_;
  Hypothesis base_;
  std::vector<double> base_scores_;
  double scatter_ = 1, rest_ = 0;
  std::vector<ScoredCandidate> ranked_;
  std::optional<ScoredCandidate> best_fit_;
};

}  // namespace rths::diagnosis
