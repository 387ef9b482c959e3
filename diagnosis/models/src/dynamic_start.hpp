// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// The state at the first sample that best fits the first rows of a measurement: Gauss-Newton steps
/// with the response of the linear system, then with that of the whole model.
/// @param steps  of a substep; there are `substeps` per sample
/// @param predicted  prediction for a start state; empty if it diverges
/// @returns zero if the first prediction diverges; empty if the model has no states
[[nodiscard]] Eigen::VectorXd fitted_start(
    const StepMatrices<double>& steps, int substeps, const Eigen::MatrixXd& measured,
    Eigen::Index rows, const std::function<Eigen::MatrixXd(const Eigen::VectorXd&)>& predicted);

}  // namespace rths::diagnosis
