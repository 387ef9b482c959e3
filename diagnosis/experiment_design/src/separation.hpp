// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include <rths/identification/relation_findings.hpp>

#include "designs.hpp"

namespace rths::diagnosis {

/// Proposed tests, as a problem.
struct Tests {
  /// @param like  problem whose noise the tests have
  Tests(const Problem& like, bool is_removable);

  std::vector<Design> designs;
  Problem problem;
};

/// Whitened residuals and their derivatives with respect to parameters divided by their scales.
struct PredictedRows {
  VectorXd residual;
  MatrixXd jacobian;
};

/// A hypothesis that is tied with another: fitted to the records of a relation, with its
/// predictions of proposed tests.
class Side {
 public:
  /// @param tests  must outlive this object
  Side(const RelationFindings& found, const Tests& tests, Hypothesis hypothesis);

  [[nodiscard]] const PredictedRows& records() const { return records_; }
  /// Whitened residual of a test; empty if there is no prediction.
  [[nodiscard]] const VectorXd& residual(std::size_t test);
  [[nodiscard]] const MatrixXd& jacobian(std::size_t test);

 private:
  [[nodiscard]] const TestedHypothesis& on(std::size_t test) const;

  PredictedRows records_;
  Hypothesis hypothesis_;
  const Tests* tests_;
  TestedHypothesis whole_, empty_;  ///< with the specimen and without it
  std::map<std::size_t, VectorXd> residuals_;
  std::map<std::size_t, MatrixXd> jacobians_;
};

/// Difference of two sides' predictions of a test before any refit [standard deviations].
[[nodiscard]] double distance(Side& one, Side& other, std::size_t test);

/// Expected log-likelihood gain of the true side over the other, on records and test together, less
/// the gain on the records alone. The wrong side is refitted to first order. Mean of both cases,
/// each side true in turn [nat].
[[nodiscard]] double expected_gain(Side& one, Side& other, std::size_t test);

}  // namespace rths::diagnosis
