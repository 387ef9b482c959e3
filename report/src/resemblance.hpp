// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/report/comparison.hpp>

namespace rths::report {

/// Sets delay, gain and the resemblance of a signal that differs from the baseline.
/// @param search  largest delay [s]   @setup
void explain(double search, ComparedSignal& signal);

}  // namespace rths::report
