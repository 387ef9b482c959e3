// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/report/comparison.hpp>

namespace rths::report {

/// Values at other times, linear between samples. @pre the times lie within those of the samples
[[nodiscard]] std::vector<double> interpolated(const std::vector<double>& time,
                                               const std::vector<double>& values,
                                               const std::vector<double>& at);

/// Sets delay, gain and the resemblance of a signal that differs from the baseline.
/// @param search  largest delay [s]   @setup
void explain(double search, const PairedValues& values, ComparedSignal& signal);

}  // namespace rths::report
