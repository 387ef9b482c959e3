// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/cases/case.hpp>
#include <rths/identification/hypothesis.hpp>

namespace rths::diagnosis {

/// Removes the faults T of an accelerometer from its channels y, so that later relations see
/// corrected accelerations: a = T⁻¹(y) by iteration, since the faults are small. Changes nothing if
/// no fault is named.
/// @param named  model of the accelerometer   @setup
void correct_accelerometers(const Hypothesis& named, Case& c);

}  // namespace rths::diagnosis
