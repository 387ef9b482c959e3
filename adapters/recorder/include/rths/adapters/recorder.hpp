// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/experiment/node.hpp>
#include <rths/memmap/map.hpp>
#include <rths/recording/recording.hpp>

namespace rths::adapters {

struct RecorderSettings {
  std::filesystem::path file;
  recording::RecordingInfo info;
  double period = 1e-3;    ///< of the rows [s]
  double linger = 1.5;     ///< continues recording for this time after the stop [s], and longer
  double longest = 1.5;    ///< while a safety layer moves its machine, but at most for this time
  bool own_thread = true;  ///< write in a separate thread; false in virtual time
};

/// Monitors of a recorder, in addition to those of every node.
[[nodiscard]] std::vector<Port> recorder_monitors();

/// A node that only reads: writes one row of all signals of the map per step to a recording.
///
/// The values of a row are read less than a period after its time. A row that is due while this
/// node does not run is missing: later values would have a wrong time.
///
/// In real time a separate thread writes the file from a queue. Rows that do not fit into the queue
/// are missing, too; the step never waits. The recording and the monitor lost_rows count missing
/// rows.
/// @throws Error if the file cannot be created   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_recorder(const memmap::Map& map,
                                                     const RecorderSettings& settings);

/// Has no keys of its own. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_recorder(const std::string& node, const Config& table,
                                                     const experiment::Experiment& experiment);

}  // namespace rths::adapters
