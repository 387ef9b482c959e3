// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/rows.hpp>

namespace rths::bench {

/// Raw against itself: the deviation from a ratio of 1 is the noise of this machine.
[[nodiscard]] Pairing measure_raw(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_raw_paused(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_word(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_word_paused(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_any_word(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_any_word_paused(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_group(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_wait_spinning(const Row& row, const Workbench& bench);
/// Both sides sleep before each message; against a word with a futex.
[[nodiscard]] Pairing measure_wait_sleeping(const Row& row, const Workbench& bench);
/// A word through the ring against a plain store, sequential, without readers.
[[nodiscard]] Pairing measure_write_cost(const Row& row, const Workbench& bench);
/// The fastest of several rates at which the other process follows every write.
[[nodiscard]] Pairing measure_journal_follow(const Row& row, const Workbench& bench);
/// Words through a journal, at the receiver's rate.
[[nodiscard]] Times stream_of_words(const Workbench& bench);
/// A group of the row's size, written every `gap` [ns] while the other processor reads
/// continuously.
[[nodiscard]] Times write_group_under_reader(const Row& row, const Workbench& bench,
                                             std::uint32_t gap);

}  // namespace rths::bench
