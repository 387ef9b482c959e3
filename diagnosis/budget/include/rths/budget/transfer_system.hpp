// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/axis_transfer.hpp>

namespace rths::budget {

/// RMS of measured less predicted displacement over the RMS of the displacement [-].   @setup
[[nodiscard]] double error_on(const sim::AxisTransfer& system, const sim::TransferRecord& record);

/// Identifies a transfer system by its output error, on every other two seconds of a record. The
/// seconds between serve for the score.
/// @throws Error if the record is shorter than 8 s, its signals differ in length, or the reference
///         does not move   @setup
[[nodiscard]] sim::AxisTransfer identify_transfer(const sim::TransferRecord& record);

}  // namespace rths::budget
