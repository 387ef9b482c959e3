// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <rths/memmap/map.hpp>
#include <rths/recording/message_fault.hpp>
#include <rths/recording/recording.hpp>

namespace rths::recording {

/// The word of a signal in each row of a recording.
struct RecordedWord {
  memmap::SignalEntry entry;         ///< of the recorded map
  std::vector<std::uint32_t> words;  ///< a row without a number has that of the row before
};

/// The words of a node, to write them back. Flags and counters, which hold whole numbers alone,
/// come last: they announce the others.
/// @param run  must outlive the result
/// @throws Error if the map has no such node, or no row has a word of it   @setup
[[nodiscard]] std::vector<RecordedWord> words_of(const Reader& run, const std::string& node);

/// Changes words as if some writes had not arrived, had arrived later or with a bit inverted.
/// @param time   of each row [s]
/// @param words  of the fault's node   @setup
void apply(const MessageFault& fault, const std::vector<double>& time,
           std::vector<RecordedWord>& words);

}  // namespace rths::recording
