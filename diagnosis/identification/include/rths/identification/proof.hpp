// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// Prediction errors of a record: root mean squares over the standard deviation of the measurement.
/// Both pass the same filter; the zeros of the named model are removed.
struct RecordScore {
  std::string record;
  std::string use;                                 ///< "fit", "scored" in the selection, "held_out"
  double nrmse_before = 0;                         ///< refitted without the named terms
  double nrmse_after = 0;                          ///< with them
  double nrmse_stated = 0;                         ///< of the simulation as stated, without a fit
  double noise_floor = 0;                          ///< of sensor noise alone
  double variance_before = 0, variance_after = 0;  ///< of the whitened residual; 1: noise [-]
};

/// Zero of each output in each record, by record: the mean error of the named model, which a sensor
/// may have and is no error. An effect that is an offset counts, because all models have the same
/// zeros. Empty where offsets are free: then each model has its own.
using Zeros = std::vector<RowVectorXd>;
[[nodiscard]] Zeros zeros_of(const TestedHypothesis& named);

/// Error of a hypothesis on a record: root mean square over the standard deviation of the
/// measurement. Outputs of different units count alike.
/// @returns NaN if there is no prediction
[[nodiscard]] double nrmse(const TestedHypothesis& tested, std::size_t record, const Zeros& zeros);

/// The error that the sensors' noise alone causes, in the same unit.
[[nodiscard]] double nrmse_of_noise(const Problem& problem, std::size_t record);

/// Autocorrelation of the whitened residual of a record.
struct Whiteness {
  std::vector<double> correlation;  ///< mean of the outputs, from lag 1 on
  double bound = 0;                 ///< 95 % of the lags of noise lie within ± this
  bool is_white = false;            ///< passes the test of Ljung & Box (1978)
};
[[nodiscard]] Whiteness whiteness_of(const TestedHypothesis& named, std::size_t record);

/// What scatters the score of a model on a fold, over the sensors' noise [-]: the variance of its
/// whitened residual times the number of neighbouring rows that agree. 1 for noise.
[[nodiscard]] double scatter_of(const TestedHypothesis& tested, const Fold& fold);

/// Errors of all records that were not used before; of the fitted records if there are none.
struct Proof {
  std::vector<RecordScore> records;
  Whiteness whiteness;  ///< of the last record
  bool is_held_out = false;
  bool is_white = false;                    ///< residuals of all records
  double before = 0, after = 0, floor = 0;  ///< NRMSE over all records

  /// Share of the error's energy beyond the noise that the named terms explain [-].
  [[nodiscard]] double explained() const;
  /// Error that remains, in multiples of the error that the sensors' noise causes [-].
  [[nodiscard]] double times_noise() const { return after / floor; }
  /// Largest variance of a record's whitened residual; 1 is noise [-].
  [[nodiscard]] double variance() const;
  /// Returns true if the remaining error is coloured and well above the noise, or far above it
  /// where the noise is small.
  [[nodiscard]] bool is_systematic() const;
};

/// Scores of all records of a problem.
/// @param is_proof  the records were held out
[[nodiscard]] std::vector<RecordScore> scores_of(const Problem& problem, const Selection& selection,
                                                 bool is_proof);

/// The proof of a selection on records whose noise is that of the named model.
/// @param is_held_out  the records were not used before
[[nodiscard]] Proof proof_of(const Problem& problem, const Selection& selection, bool is_held_out);

}  // namespace rths::diagnosis
