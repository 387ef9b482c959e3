// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rths::testkit {

struct PlaySettings {
  std::filesystem::path recording;
  std::vector<std::string> nodes;    ///< whose words are written, as these nodes
  std::string ring;                  ///< an existing one, or one to make with the recorded map
  double rate = 1;                   ///< wall time over recorded time
  std::vector<std::string> faults;   ///< "kind=flip signal=… bit=…", as those of a test
  std::vector<std::string> awaited;  ///< nodes that are on the ring before the first row
  double longest_wait = 60;          ///< for these, and for each tick of the counter [s]
  /// A counter of another node, in the recording and on the ring: each row is written before the
  /// tick that had read it, however late that is. Empty: rows are written at their times.
  std::string counter = {};  // NOLINT(readability-redundant-member-init): may be left out
};

struct Played {
  std::uint64_t writes = 0;        ///< of words, or of whole tear groups
  std::vector<double> gap_errors;  ///< of each row: |gap − recorded gap| over the recorded gap
  std::uint64_t ticks = 0;         ///< of the counter for which words were written
  std::uint64_t late_ticks = 0;    ///< made before all their words were written
  bool is_complete = false;        ///< up to the last row
};

/// Writes the recorded words of some nodes to a ring, as these nodes, at their recorded times or in
/// step with a counter. A word is written in the rows in which it changes. Monitors that the ring
/// does not have in the same place are left out. A ring that it makes is removed at the end.
/// @param is_interrupted  ends it early
/// @throws Error if the recording lacks a node or is still written, if the ring has another map, or
///         if a node is on it already, or an awaited one or a tick is not in time
[[nodiscard]] Played play(const PlaySettings& settings,
                          const std::function<bool()>& is_interrupted);

struct RingRecording {
  std::uint64_t writes = 0, missing = 0;  ///< missing: overwritten before they were read
  std::uint64_t rows = 0;
  std::string foreign_store;  ///< the first store that was not made by the word's owner
};

/// Records every write to a ring. Changes of different words within `row` share a row, with the
/// time of the last one.
/// @param row  [s]
/// @param ends  whether to end; it also ends when the ring is gone
/// @throws Error if there is no such ring, or if the file exists or cannot be written
[[nodiscard]] RingRecording record_ring(const std::string& ring, const std::filesystem::path& file,
                                        double row, const std::function<bool()>& ends);

}  // namespace rths::testkit
