// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/launch/run.hpp>

#include "assembly.hpp"

namespace rths::launch {

/// What goes into /meta of a recording when it begins.
[[nodiscard]] recording::NamedTexts describe_run(const Experiment& experiment, ClockKind clock,
                                                 const std::string& version);

/// What a node may take from being told to stop until it is gone: its retreat, and a second to see
/// the others through theirs.
[[nodiscard]] Duration longest_stop(const Experiment& experiment);

/// @returns what went wrong, empty if nothing did
[[nodiscard]] std::string run_in_virtual_time(const Experiment& experiment, Assembly& assembly,
                                              const RunOptions& options);

/// The host's own lateness while a run lasted: the largest of each interval.
struct HostLateness {
  double interval = 0;          ///< [s]
  std::vector<double> largest;  ///< [s]
};

struct WallRunResult {
  std::string trouble;  ///< what went wrong, empty if nothing did
  bool interrupted = false;
  HostLateness lateness;
  std::vector<std::string> privileges;  ///< what each node could not get, one line a node
};
[[nodiscard]] WallRunResult run_in_wall_time(const Experiment& experiment, const Assembly& assembly,
                                             const RunOptions& options);

}  // namespace rths::launch
