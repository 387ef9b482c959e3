// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <rths/experiment/node.hpp>
#include <rths/plugin/plugin_adapter.hpp>

namespace rths::plugin {

/// An adapter in a shared library. Keys: library, role, config, own_process, deadline_s, allocates.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_plugin(const std::string& node, const Config& table,
                                                   const experiment::Experiment& setup);

/// Name, size and SHA-256 of a file, for the recording. @throws Error if it cannot be read   @setup
[[nodiscard]] Config identity_of(const std::filesystem::path& file);

/// How a node calls an adapter that may be broken.
struct Hosting {
  bool own_process = false;
  double step_deadline = 0;  ///< wall time [s]; 0: the default
  bool may_allocate = false;
  int priority = 0;  ///< real-time, of the process
};

/// Reads `role`: the place of a node in the order of steps, its schedule and priority.
/// @throws Error with the place of a wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_role(const Config& table);
/// Reads `own_process`, `deadline_s` and `allocates`. @throws Error as read_role   @setup
[[nodiscard]] Hosting read_hosting(const Config& table);
/// Makes a plugin in this process, or in one of its own.   @setup
[[nodiscard]] std::unique_ptr<adapters::Adapter> make_hosted(
    PluginSettings plugin, const Hosting& hosting, const experiment::Experiment& setup,
    const experiment::NodeContext& context);

}  // namespace rths::plugin
