// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <rths/foreign/simulation.hpp>

namespace rths::foreign {

/// Signals of a plugin between which a force may act.
struct PluginPort {
  std::string displacement;  ///< output that the force opposes
  std::string velocity;      ///< output; empty: differences of the displacement
  std::string force;         ///< input, from which the force is subtracted [N]
};

/// A simulation that is an adapter in a shared library or in Python: see rths_adapter.h.
struct PluginRunSettings {
  std::filesystem::path file;                            ///< full path: runs have their own folder
  std::string config;                                    ///< of the plugin, TOML text
  std::vector<std::string> inputs, outputs, parameters;  ///< names of signals
  std::vector<std::pair<std::string, double>> start;     ///< of other inputs and parameters [SI]
  std::vector<PluginPort> ports;
  double step = 0;            ///< [s]; 0: the interval of the rows
  bool holds_inputs = false;  ///< each value until the next; otherwise linear between the rows
  double deadline = 60;       ///< of one run [s]
};

/// A signal as the plugin describes it.
struct PluginSignal {
  std::string name, unit;       ///< unit: SI
  std::uint32_t direction = 0;  ///< as in rths_adapter.h
  double initial = 0;
};

/// Makes the plugin in a process of its own and asks for its signals.
/// @param file  full path
/// @throws Error if it cannot be loaded or made within a deadline [s]   @setup
[[nodiscard]] std::vector<PluginSignal> plugin_signals(const std::filesystem::path& file,
                                                       const std::string& config, double deadline);

/// Each run is a process of its own, a fork of this one, in which the plugin is loaded, made and
/// activated. It makes a step at each row, with the inputs of that time, and further steps between
/// rows if `step` is a part of their interval. Its outputs after the step at a row belong to the
/// row. The time starts at 0. Forces at ports are extrapolated from the last two steps.
/// @param signals  of the plugin
/// @throws Error if the plugin lacks a signal, or has an input without a value   @setup
[[nodiscard]] std::unique_ptr<Simulation> make_plugin(PluginRunSettings settings,
                                                      const std::vector<PluginSignal>& signals);

}  // namespace rths::foreign
