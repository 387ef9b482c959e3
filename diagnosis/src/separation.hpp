// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "designs.hpp"
#include "investigation.hpp"

namespace rths::diagnosis {

/// Tests that were not run yet, as a problem.
struct Tests {
  /// @param like  tells the noise
  Tests(const Problem& like, bool is_removable);

  std::vector<Design> designs;
  Problem problem;
};

/// Whitened residuals and their derivatives, by a change of each parameter that matters.
struct Rows {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

/// A hypothesis that is tied with another, fitted to an investigation's records, and what it makes
/// of tests that were not run yet.
class Side {
 public:
  /// @param tests  must outlive it
  Side(const Investigation& found, const Tests& tests, Hypothesis hypothesis);

  [[nodiscard]] const Rows& records() const { return records_; }
  /// Whitened residual of a test; empty if there is no prediction.
  [[nodiscard]] const Eigen::VectorXd& residual(std::size_t test);
  [[nodiscard]] const Eigen::MatrixXd& jacobian(std::size_t test);

 private:
  [[nodiscard]] const Supposition& on(std::size_t test) const;

  Rows records_;
  Hypothesis hypothesis_;
  const Tests* tests_;
  Supposition whole_, empty_;  ///< with the specimen and without it
  std::map<std::size_t, Eigen::VectorXd> residuals_;
  std::map<std::size_t, Eigen::MatrixXd> jacobians_;
};

/// How far two sides' predictions of a test differ before any refit [standard deviations].
[[nodiscard]] double distance(Side& one, Side& other, std::size_t test);

/// Log-likelihood by which the right one of two sides is expected to beat the other on records and
/// test, beyond what it is on the records alone, the loser fitted anew to first order: the mean of
/// both ways round [nat].
[[nodiscard]] double told(Side& one, Side& other, std::size_t test);

}  // namespace rths::diagnosis
