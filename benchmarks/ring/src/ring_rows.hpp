// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/rows.hpp>

namespace rths::bench {

/// Raw against itself: what is left of a ratio of 1 is the noise of this machine.
[[nodiscard]] Pairing measure_raw(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_raw_paused(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_word(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_word_paused(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_group(const Row& row, const Workbench& bench);
/// A word through the ring against a plain store, sequential, nobody reading.
[[nodiscard]] Pairing measure_write_cost(const Row& row, const Workbench& bench);
/// A group of the row's size, written while the other processor reads it all the time.
[[nodiscard]] Times write_group_under_reader(const Row& row, const Workbench& bench);

}  // namespace rths::bench
