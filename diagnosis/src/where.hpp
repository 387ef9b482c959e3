// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "problem.hpp"

namespace rths::diagnosis {

/// Maps the energy of a whitened residual beyond what noise has, over time, frequency and state.
/// @param record  of the supposition's problem
[[nodiscard]] Where where_of(const Supposition& supposition, std::size_t record,
                             const MapRange& range);

/// Share of the excess energy at each row, for colours: rows × outputs, smoothed over a cell.
[[nodiscard]] Eigen::MatrixXd excess_of(const Supposition& supposition, std::size_t record);

}  // namespace rths::diagnosis
