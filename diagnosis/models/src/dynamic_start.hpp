// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// The state at the first sample that best fits the first rows of a measurement: Gauss-Newton steps
/// with the response of the linear system, then with that of the whole model.
/// @param steps  of a substep; there are `substeps` per sample
/// @param measured  first rows of the outputs
/// @param start  where the search begins; empty: at rest
/// @param predicted  prediction for a start state; empty if it diverges
/// @returns `start` if its prediction diverges; empty if the model has no states
[[nodiscard]] Eigen::VectorXd fitted_start(
    const StepMatrices<double>& steps, int substeps, const Eigen::MatrixXd& measured,
    Eigen::VectorXd start, const std::function<Eigen::MatrixXd(const Eigen::VectorXd&)>& predicted);

/// Size of each state at the start whose effect on the linear system is as large as the
/// measurement; 0 without effect.
[[nodiscard]] Eigen::VectorXd state_sizes(const StepMatrices<double>& steps, int substeps,
                                          const Eigen::MatrixXd& measured);

/// Adds to the derivatives of a prediction what the start state that fits the first rows of a
/// measurement changes with the parameters.
/// @param rows  first rows, which the start state fits
/// @param response  of the prediction to each state at the start, rows × outputs
void follow_start(Eigen::Index rows, const std::vector<Eigen::MatrixXd>& response,
                  std::vector<Eigen::MatrixXd>& derivatives);

}  // namespace rths::diagnosis
