// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace rths::diagnosis {

// Vectors and matrices in all parts of the diagnosis.
using Eigen::ArrayXd, Eigen::ArrayXXd, Eigen::MatrixXd, Eigen::RowVectorXd, Eigen::VectorXcd,
    Eigen::VectorXd;
using Eigen::Index;

}  // namespace rths::diagnosis
