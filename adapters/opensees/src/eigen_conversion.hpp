// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

namespace rths::adapters {

[[nodiscard]] inline Eigen::Vector3d to_eigen(const Vector3& vector) {
  return Eigen::Map<const Eigen::Vector3d>{vector.data()};
}

[[nodiscard]] inline Eigen::MatrixXd to_eigen(const SquareMatrix& matrix) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto n = static_cast<Eigen::Index>(matrix.size);
  return Eigen::Map<const RowMajor>{matrix.values.data(), n, n};
}

}  // namespace rths::adapters
