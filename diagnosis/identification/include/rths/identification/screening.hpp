// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/identification/problem.hpp>

namespace rths::diagnosis {

/// Removes from signals everything that a linear combination of some columns can reproduce.
class Complement {
 public:
  explicit Complement(const MatrixXd& columns);
  void take_out(Eigen::Ref<VectorXd> x) const;

 private:
  MatrixXd basis_;  ///< orthonormal
};

/// Result of screening a candidate, before it is fitted.
struct Screened {
  const Candidate* candidate;
  std::vector<VectorXd> starts;  ///< best first
  double gain = 0;  ///< log-likelihood gain of its linearised signature on the fold [nat]
};

/// Score test (Rao 1948) of every candidate at every start. The test compares the candidate's
/// signature with the residual, both without the part that the free parameters of the base can
/// reproduce. Best first.
/// @param base  fitted to the fold
[[nodiscard]] std::vector<Screened> screen(const TestedHypothesis& base, const Fold& fold,
                                           const std::vector<Candidate>& candidates);

}  // namespace rths::diagnosis
