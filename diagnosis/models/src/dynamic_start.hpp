// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <rths/identification/vectors.hpp>

#include "dynamic_steps.hpp"

namespace rths::diagnosis {

/// The state at the first sample that best fits the first rows of a measurement. Linear least
/// squares without the terms, iterated a few times to include their effect.
/// @param steps  of a substep; there are `substeps` per sample
/// @param predicted  prediction for a start state; empty if it diverges
/// @returns zero if the first prediction diverges; empty if the model has no states
[[nodiscard]] VectorXd fitted_start(const StepMatrices<double>& steps, int substeps,
                                    const MatrixXd& measured, Index rows,
                                    const std::function<MatrixXd(const VectorXd&)>& predicted);

}  // namespace rths::diagnosis
