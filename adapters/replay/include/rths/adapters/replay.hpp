// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/schedule.hpp>
#include <rths/experiment/node.hpp>
#include <rths/recording/recorded_words.hpp>

namespace rths::adapters {

/// The words of a node, to be repeated at their times.
struct ReplaySettings {
  std::vector<double> time;                    ///< of each row, since the run began [s]
  std::vector<recording::RecordedWord> words;  ///< with faults
  Schedule schedule;                           ///< of its steps
};

/// An adapter that writes in each step the words of the first row at this time or later: what the
/// node had written in this step, if the recording has a row between two of its steps. No row is
/// left out with a step that is left out: the time is that of the steps made. It is done when the
/// recording is over, and at the latest 1.9 s after it is asked to stop.   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_replay(ReplaySettings settings);

/// Reads the table of a node that repeats a recording.
/// Keys: recording, role, of_node, fault. @throws Error with the place of the first wrong value
/// @setup
[[nodiscard]] experiment::NodeSettings read_replay(const std::string& node, const Config& table,
                                                   const experiment::Experiment& experiment);

}  // namespace rths::adapters
