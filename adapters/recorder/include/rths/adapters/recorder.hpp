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
  double linger = 1.5;     ///< continues recording for this time after the stop [s]
  bool own_thread = true;  ///< write in a separate thread; false in virtual time
};

/// Monitors of a recorder, in addition to those of every node.
[[nodiscard]] std::vector<Port> recorder_monitors();

/// A node that only reads: writes one row of all signals of the map per step to a recording.
///
/// In real time a separate thread writes the file from a queue. Rows that do not fit into the queue
/// are counted and dropped; the step never waits.
/// @throws Error if the file cannot be created   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_recorder(const memmap::Map& map,
                                                     const RecorderSettings& settings);

}  // namespace rths::adapters
