// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/broker/ring.hpp>
#include <rths/launch/run.hpp>

namespace rths::launch {

/// Name of the ring of a run, and the file of its recording.
struct RunPlace {
  std::string ring;
  std::filesystem::path recording;
};

/// Runs the process that stands for a foreign node: starts its program, or asks the user to, and is
/// ready when the program is on the ring. Watches the program, its peers and the launcher; ends the
/// program after the retreat of the others.
/// @returns exit code of the process   @throws Error if the program does not join the ring   @setup
[[nodiscard]] int run_foreign_node(const Experiment& experiment, const NodePlan& plan,
                                   broker::Ring& ring, const RunPlace& place);

}  // namespace rths::launch
