// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/experiment/experiment.hpp>
#include <rths/sim/motion_file.hpp>

namespace rths::experiment {

/// Compares what the simulation expects of a test with what specimen and machine can do. A wrong
/// unit exceeds it many times.
/// @returns what is unusual, but possible   @throws Error with the likely unit   @setup
[[nodiscard]] std::vector<std::string> check_plausible(const Experiment& experiment);

/// A file of ground motion, and remarks on unusual sizes.
struct CheckedMotion {
  sim::MotionFile file;
  std::vector<std::string> remarks;
};

/// Reads a file of ground motion once, as the `file` of [motion] in a test along one axis; each
/// channel of a station's file.
/// @throws Error as such a test   @setup
[[nodiscard]] CheckedMotion check_motion_file(const std::filesystem::path& file);

/// Time step and peaks of the tested ground motion, a line.   @setup
[[nodiscard]] std::string describe_motion(const Experiment& experiment);

}  // namespace rths::experiment
