// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/memmap/map.hpp>
#include <rths/recording/recording.hpp>

namespace rths::adapters {

struct RecorderSettings {
  std::filesystem::path file;
  recording::RecordingInfo info;
  double linger = 1.5;     ///< goes on recording this long after it is told to stop [s]
  bool own_thread = true;  ///< write from a thread of its own; false in virtual time
};

/// What a recorder tells of itself, beside what every node does.
[[nodiscard]] std::vector<Port> recorder_monitors();

/// A node that only listens: one row of every signal of the map per step, into a recording.
///
/// In real time a row goes to a queue and a thread of its own writes the file; rows that find the
/// queue full are counted, never waited for.
/// @throws Error if the file cannot be created   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_recorder(const memmap::Map& map,
                                                     const RecorderSettings& settings);

}  // namespace rths::adapters
