// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "dynamic_reading.hpp"

namespace rths::diagnosis {

/// A linear system at values of its parameters, with room for that many connections.
using BareSystem = std::function<LinearSystem(const Eigen::VectorXd&, Eigen::Index connections)>;

/// Completes a linear model whose inputs, outputs and parameters are known: components for terms
/// between outputs and inputs, time step, and what all models have in common.
void finish_linear(const Config& table, BareSystem bare, DynamicModel& model);

[[nodiscard]] DynamicModel read_state_space(const Config& table);

}  // namespace rths::diagnosis
