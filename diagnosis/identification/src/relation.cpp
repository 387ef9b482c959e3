// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/relation.hpp>

#include <vector>

namespace rths::diagnosis {

ArrayXd Drive::compared() const {
  ArrayXd weight = present.size() > 0 ? present : ArrayXd::Ones(rows());
  weight.head(first_row).setZero();
  return weight;
}

MatrixXd Drive::compared_rows(const MatrixXd& signal) const {
  if (present.size() == 0) return signal.bottomRows(rows() - first_row);
  std::vector<Index> taken;
  for (Index row = first_row; row < rows(); ++row)
    if (present[row] != 0) taken.push_back(row);
  return signal(taken, Eigen::all);
}

}  // namespace rths::diagnosis
