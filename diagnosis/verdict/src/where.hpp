// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/cases/case.hpp>
#include <rths/identification/relation_findings.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

/// Maps the mismatch on the first record over time, frequency and state: the energy of the
/// named terms' contribution, if they explain all, else the energy beyond the noise of the residual
/// without them.
[[nodiscard]] Where where_of(const RelationFindings& found, const MapRange& range);

/// Share of the excess energy at each row, for colours: rows × outputs, smoothed over a cell.
[[nodiscard]] MatrixXd excess_of(const TestedHypothesis& tested, std::size_t record);

}  // namespace rths::diagnosis
