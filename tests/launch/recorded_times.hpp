// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rths::test {

/// Rows of a recording, compared with the counts and times of the steps of its nodes.
struct RecordedTimes {
  long compared = 0;  ///< comparisons of a row with a node
  long wrong = 0;     ///< rows with a value of a later time, or without a value of an earlier time
  long gaps = 0;      ///< rows that are missing between the first and the last
};

/// A node reports the number of its last step, and when that step began. So a row of time t must
/// hold a step that began before the end of the row's period, t + 1 ms, and every step that ended
/// before t.
[[nodiscard]] RecordedTimes recorded_times(const std::filesystem::path& recording);

}  // namespace rths::test
