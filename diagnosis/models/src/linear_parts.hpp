// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "dynamic_reading.hpp"

namespace rths::diagnosis {

/// Makes a linear system from values of its parameters, with empty rows for connections.
using BareSystem = std::function<LinearSystem(const VectorXd&, Index connections)>;

/// Completes a linear model that has its inputs, outputs and parameters: connections for terms
/// between outputs and inputs, time step, and the keys common to all models.
void finish_linear(const Config& table, const BareSystem& bare, DynamicModel& model);

[[nodiscard]] DynamicModel read_state_space(const Config& table);

}  // namespace rths::diagnosis
