// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <rths/diagnosis/least_squares.hpp>

#include "noise.hpp"
#include "relation.hpp"

namespace rths::diagnosis {

/// A part of the records: some rows of some of them.
struct Fold {
  struct Share {
    std::size_t record;
    Eigen::ArrayXd weight;  ///< 0 or 1 for each row; empty: all of them
  };
  std::vector<Share> shares;
};

/// A relation, the records that it is checked on, and the noise in them.
class Problem {
 public:
  /// @param draws  of the noise, at least
  /// @throws Error if a record lacks a channel that the relation needs
  Problem(const Relation& relation, const std::vector<const Record*>& records,
          const SensorNoise& noise, std::uint64_t seed, std::size_t draws = 8);
  /// Tests that were not run yet, with the noise of another problem's first record at its median
  /// size.
  Problem(const Problem& like, const std::vector<const Record*>& tests);

  [[nodiscard]] const Relation& relation() const { return *relation_; }
  [[nodiscard]] std::size_t records() const { return parts_.size(); }
  [[nodiscard]] const Record& record(std::size_t i) const { return *parts_[i].record; }
  [[nodiscard]] const Drive& drive(std::size_t i) const { return *parts_[i].drive; }
  [[nodiscard]] const ResidualNoise& noise(std::size_t i) const { return *parts_[i].noise; }
  /// Residuals that noise alone makes, at the hypothesis of the last renewal.
  [[nodiscard]] const std::vector<Eigen::MatrixXd>& draws(std::size_t i) const {
    return parts_[i].draws;
  }
  [[nodiscard]] bool has_colour() const { return has_colour_; }

  /// Sends the sensors' noise through the model once more: at another hypothesis it shows
  /// differently.
  void renew_noise(const Hypothesis& hypothesis);
  /// Mean of ln of what residuals would be divided by at a hypothesis, from a few of the draws.
  [[nodiscard]] double log_noise(const Hypothesis& hypothesis) const;

 private:
  struct Part {
    const Record* record;
    std::unique_ptr<Drive> drive;
    std::vector<std::unique_ptr<Drive>> disturbed;
    std::vector<Eigen::MatrixXd> draws;
    std::unique_ptr<ResidualNoise> noise;
  };

  [[nodiscard]] std::vector<Eigen::MatrixXd> draws_of(const Part& part,
                                                      const Hypothesis& hypothesis,
                                                      std::size_t most) const;

  const Relation* relation_;
  bool has_colour_;
  std::vector<Part> parts_;
};

/// A hypothesis on the records of a problem: residuals that are white if it is right.
class Supposition {
 public:
  /// @throws Error if there is no prediction at the hypothesis' values
  Supposition(const Problem& problem, Hypothesis hypothesis);

  [[nodiscard]] const Hypothesis& hypothesis() const { return hypothesis_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }

  /// Prediction for a record at the hypothesis' values, rows × outputs; empty if there is none.
  [[nodiscard]] Eigen::MatrixXd prediction(std::size_t record) const;
  /// Whitened residual of a record, offset taken out where it is free: rows × outputs.
  [[nodiscard]] Eigen::MatrixXd whitened(std::size_t record) const;
  /// Residual and its derivatives, stacked over the shares of a fold, outputs and rows.
  /// @returns false if there is no prediction
  [[nodiscard]] bool evaluate(const Fold& fold, const Eigen::VectorXd& values,
                              const std::vector<Eigen::Index>& wanted, Eigen::VectorXd& residual,
                              Eigen::MatrixXd& jacobian) const;
  /// The fit of all free parameters to a fold, from the hypothesis' values.
  [[nodiscard]] Fit fit(const Fold& fold, int most_iterations) const;
  /// ½ Σ w² of every second of a fold's records [nat].
  [[nodiscard]] std::vector<double> blocks(const Fold& fold) const;
  /// Mean of w² over a fold [-].
  [[nodiscard]] double variance(const Fold& fold) const;

  void set_values(const Eigen::VectorXd& values) { hypothesis_.values = values; }

 private:
  bool stack(const Fold::Share& share, const Eigen::VectorXd& values,
             const std::vector<Eigen::Index>& wanted, Eigen::Index first, Eigen::VectorXd& residual,
             Eigen::MatrixXd& jacobian) const;

  const Problem* problem_;
  Hypothesis hypothesis_;
  std::vector<std::unique_ptr<Simulator>> simulators_;
};

/// Rows times outputs of a fold that count.
[[nodiscard]] double observations(const Problem& problem, const Fold& fold);
[[nodiscard]] Fold whole(const std::vector<std::size_t>& records);

}  // namespace rths::diagnosis
