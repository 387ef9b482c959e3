// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/config.hpp>
#include <rths/experiment/node.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::adapters {

/// Version of the diagram file format. Increases when an existing file would change its meaning or
/// no longer load.
inline constexpr int kDiagramFormat = 1;

/// Properties of the run that a diagram needs.
struct DiagramContext {
  std::vector<std::string> axes = names_of(kHorizontal);  ///< width of every per-axis port
  double integration_step = 0.01;                         ///< model time per target [s]
  double simulation_step = 0.01;                          ///< wall time per target [s]
  experiment::Retreat retreat;  ///< of ring outputs that ramp when the run stops
  /// Unit of each signal of the laboratory's map; empty: no map is known, signals are not checked.
  std::map<std::string, std::string> signal_units = {};  // NOLINT: g++ needs the initializer
  /// The specimen as the test assumes it; null: none is known.
  std::shared_ptr<const sim::Bearing> specimen = {};  // NOLINT: g++ needs the initializer
  /// File of values that replace those of the diagram's blocks; empty: none.
  std::filesystem::path constants = {};  // NOLINT: g++ needs the initializer
  /// Tables of the experiment that do the same, with priority.
  Config blocks = {};  // NOLINT: g++ needs the initializer
};

/// A real-time target that runs a fixed-step block diagram from a TOML file.
///
/// Blocks run at the base rate or at `substeps` times it. Every block output is a monitor,
/// monitor.<node>.<block>.<port>[.<axis>]; every parameter can be tuned,
/// tune.<node>.<block>.<name>. docs/block_diagrams.md lists the block types.
/// @throws Error file:line:column for an unknown block, key or signal, an unconnected wire,
///         mismatched ports or units, a parameter outside its range, an algebraic loop, or a
///         base-rate block between fast ones   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_simulink_like(const std::filesystem::path& diagram,
                                                          const DiagramContext& context);

/// The same from text; messages show `name` instead of a file.   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_simulink_like_from_text(const std::string& text,
                                                                    const std::string& name,
                                                                    const DiagramContext& context);

/// Base period of a diagram file [s].   @setup
[[nodiscard]] double diagram_period(const std::filesystem::path& diagram);

/// Keys: diagram, constants, blocks. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_simulink_like(const std::string& node,
                                                          const Config& table,
                                                          const experiment::Experiment& experiment);

}  // namespace rths::adapters
