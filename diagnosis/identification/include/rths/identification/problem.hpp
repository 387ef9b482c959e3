// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <rths/identification/least_squares.hpp>
#include <rths/identification/noise.hpp>
#include <rths/identification/progress.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// A selection of rows from some of the records.
struct Fold {
  struct Share {
    std::size_t record;
    ArrayXd weight;  ///< 0 or 1 for each row; empty: all of them
  };
  std::vector<Share> shares;
};

/// A relation, the records on which it is checked, and their noise.
class Problem {
 public:
  /// @param draws  smallest number of noise draws
  /// @throws Error if a record lacks a channel that the relation needs
  Problem(const Relation& relation, const std::vector<const Record*>& records,
          const SensorNoise& noise, std::uint64_t seed, std::size_t draws = 24);
  /// A problem of tests that were not run yet, with the noise of the first record of `like` at its
  /// median size.
  Problem(const Problem& like, const std::vector<const Record*>& tests);

  [[nodiscard]] const Relation& relation() const { return *relation_; }
  [[nodiscard]] std::size_t records() const { return records_.size(); }
  [[nodiscard]] const Record& record(std::size_t i) const { return *records_[i].record; }
  [[nodiscard]] const Drive& drive(std::size_t i) const { return *records_[i].drive; }
  [[nodiscard]] const ResidualNoise& noise(std::size_t i) const { return *records_[i].noise; }
  /// Residuals due to noise alone, at the hypothesis of the last renewal.
  [[nodiscard]] const std::vector<MatrixXd>& draws(std::size_t i) const {
    return records_[i].draws;
  }
  [[nodiscard]] bool has_colour() const { return has_colour_; }
  /// Whether the noise of all sensors is known; else only the shape of a residual tells.
  [[nodiscard]] bool is_noise_known() const { return is_noise_known_; }

  /// The problem with one more realisation of the sensors' noise in every record, and the same
  /// noise model.
  /// @param draw  any number: realisations repeat
  [[nodiscard]] Problem disturbed(std::size_t draw) const;

  /// Counts fits, and the steps of the selection. Must outlive the problem.
  void report_to(DiagnosisProgress& progress) { progress_ = &progress; }
  [[nodiscard]] DiagnosisProgress& progress() const { return *progress_; }

  /// Computes the noise of the residual again for another hypothesis, by sending the sensors' noise
  /// through its model. A record that the model cannot predict keeps its noise.
  void renew_noise(const Hypothesis& hypothesis);
  /// Residuals of a record due to noise alone at a hypothesis, from a few draws.
  [[nodiscard]] std::vector<MatrixXd> draws_at(const Hypothesis& hypothesis,
                                               std::size_t record) const;
  /// Level of the residual noise at a hypothesis, see ResidualNoise::log_size; from a few draws.
  /// None if it does not predict every record.
  [[nodiscard]] std::optional<double> log_noise(const Hypothesis& hypothesis) const;

 private:
  Problem() = default;
  struct RecordData {
    const Record* record;
    std::shared_ptr<const Drive> drive;
    std::vector<std::shared_ptr<const Drive>> disturbed;
    std::vector<MatrixXd> draws;
    std::shared_ptr<const ResidualNoise> noise;
  };

  [[nodiscard]] std::vector<MatrixXd> draws_of(const RecordData& data, const Hypothesis& hypothesis,
                                               std::size_t most) const;
  /// None if the model has no prediction.
  [[nodiscard]] std::optional<std::vector<MatrixXd>> possible_draws(const RecordData& data,
                                                                    const Hypothesis& hypothesis,
                                                                    std::size_t most) const;

  const Relation* relation_ = nullptr;
  bool has_colour_ = false, is_noise_known_ = true;
  DiagnosisProgress* progress_ = nullptr;  ///< never null
  std::vector<RecordData> records_;
};

/// A hypothesis applied to the records of a problem. Its whitened residuals are white if it is
/// right.
class TestedHypothesis {
 public:
  /// @throws Error if there is no prediction at the hypothesis' values
  TestedHypothesis(const Problem& problem, Hypothesis hypothesis);
  /// The same, with what the simulators of another tested about the problem keep.
  TestedHypothesis(const TestedHypothesis& like, Hypothesis hypothesis);

  [[nodiscard]] const Hypothesis& hypothesis() const { return hypothesis_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }

  /// Prediction for a record at the hypothesis' values, rows × outputs; empty if there is none.
  [[nodiscard]] MatrixXd prediction(std::size_t record) const;
  /// Whitened residual of a record, without its offset if that is free: rows × outputs. Rows that
  /// are not compared are zero.
  [[nodiscard]] MatrixXd whitened(std::size_t record) const;
  /// Residual and its derivatives, stacked over the shares of a fold, outputs and rows.
  /// @returns false if there is no prediction
  [[nodiscard]] bool evaluate(const Fold& fold, const VectorXd& values,
                              const std::vector<Index>& wanted, VectorXd& residual,
                              MatrixXd& jacobian) const;
  /// The fit of all free parameters to a fold, from the hypothesis' values.
  /// @param ridge  adds (ridge · (value − start))² of every parameter to the squares; empty:
  /// nothing
  [[nodiscard]] Fit fit(const Fold& fold, int most_iterations, const VectorXd& ridge = {}) const;
  /// ½ Σ w² of every second of a fold's records [nat].
  [[nodiscard]] std::vector<double> blocks(const Fold& fold) const;
  /// The part of `blocks` that noise is expected to cause at this hypothesis: a model that reacts
  /// less to the noise of the measured motion fits it better, without being more right [nat].
  [[nodiscard]] std::vector<double> noise_blocks(const Fold& fold) const;
  /// Mean of w² over a fold [-].
  [[nodiscard]] double variance(const Fold& fold) const;

  /// Keeps what predictions for the records of a fold near the hypothesis' values have in common.
  void keep(const Fold& fold);
  void set_values(const VectorXd& values) { hypothesis_.values = values; }

 private:
  bool stack(const Fold::Share& share, const VectorXd& values, const std::vector<Index>& wanted,
             Index first, VectorXd& residual, MatrixXd& jacobian) const;

  const Problem* problem_;
  Hypothesis hypothesis_;
  std::vector<std::unique_ptr<Simulator>> simulators_;
};

/// Number of compared samples of a fold: rows times outputs.
[[nodiscard]] double observations(const Problem& problem, const Fold& fold);
/// All compared rows of some records.
[[nodiscard]] Fold compared(const Problem& problem, const std::vector<std::size_t>& records);

}  // namespace rths::diagnosis
