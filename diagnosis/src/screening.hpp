// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "problem.hpp"

namespace rths::diagnosis {

/// What is left of signals when everything that some columns can make is taken out.
class Complement {
 public:
  explicit Complement(const Eigen::MatrixXd& columns);
  void take_out(Eigen::Ref<Eigen::VectorXd> x) const;

 private:
  Eigen::MatrixXd basis_;  ///< orthonormal
};

/// How promising a candidate is, before it is fitted.
struct Screened {
  const Candidate* candidate;
  std::vector<Eigen::VectorXd> starts;  ///< best first
  double gain = 0;  ///< log-likelihood that its linearised signature would win on the fold [nat]
};

/// Score test (Rao 1948) of every candidate at every start: its signature, less what the free
/// parameters of the base can make, against the residual, less the same. Best first.
/// @param base  at its fit to the fold
[[nodiscard]] std::vector<Screened> screen(const Supposition& base, const Fold& fold,
                                           const std::vector<Candidate>& candidates);

}  // namespace rths::diagnosis
