// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/controller/table_force.hpp>

namespace rths::commissioning {

/// The force of a machine's axes, identified from recordings without a specimen.
struct EmptyTableRuns {
  std::vector<std::filesystem::path> files;
  struct Axis {
    std::string name;  ///< "long", "lat"
    controller::TableIdentification fit;
  };
  std::vector<Axis> axes;
  double load = 0;  ///< vertical load for which the constants are stated [N]
};

/// All recordings together, axis by axis.
/// @param load  vertical load of the constants [N]; NaN: the mean of the recordings
/// @throws Error if a recording lacks a signal of the machine, if their intervals differ, or as
///         identify_table_force does   @setup
[[nodiscard]] EmptyTableRuns identify_empty_table(const std::vector<std::filesystem::path>& files,
                                                  double load);

[[nodiscard]] std::string text_of(const EmptyTableRuns& runs);
[[nodiscard]] std::string json_of(const EmptyTableRuns& runs);
/// Constants of a block of the given type, as a file of `constants` of an experiment. Those of a
/// force_observer hold for `load`; a table_force_observer gets the friction per load, the
/// presliding length, the delay of the accelerometer and the lead of the displacement.
/// @param block  name of the block in the diagram
/// @param type   "force_observer" or "table_force_observer"
/// @throws Error for a table_force_observer if the load of the recordings does not vary   @setup
[[nodiscard]] std::string toml_of(const EmptyTableRuns& runs, const std::string& block,
                                  const std::string& type);

}  // namespace rths::commissioning
