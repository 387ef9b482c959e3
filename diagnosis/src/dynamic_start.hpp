// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// The state at the first sample that makes the first rows of a prediction fit best, found as if
/// the model were linear; what its terms change of that, in a few turns.
/// @param steps  from sample to sample, `substeps` each
/// @param predicted  by start state; empty if it diverges
/// @returns zero where there is none
[[nodiscard]] Eigen::VectorXd fitted_start(
    const StepMatrices<double>& steps, int substeps, const Eigen::MatrixXd& measured,
    Eigen::Index rows, const std::function<Eigen::MatrixXd(const Eigen::VectorXd&)>& predicted);

}  // namespace rths::diagnosis
