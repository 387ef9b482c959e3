// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/relation.hpp>

#include <vector>

namespace rths::diagnosis {

Eigen::ArrayXd Drive::compared() const {
  Eigen::ArrayXd weight = present.size() > 0 ? present : Eigen::ArrayXd::Ones(rows());
  weight.head(first_row).setZero();
  return weight;
}

Eigen::MatrixXd Drive::compared_rows(const Eigen::MatrixXd& signal) const {
  if (present.size() == 0) return signal.bottomRows(rows() - first_row);
  std::vector<Eigen::Index> taken;
  for (Eigen::Index row = first_row; row < rows(); ++row)
    if (present[row] != 0) taken.push_back(row);
  return signal(taken, Eigen::all);
}

}  // namespace rths::diagnosis
