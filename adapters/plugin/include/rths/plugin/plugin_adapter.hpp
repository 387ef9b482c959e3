// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <rths_adapter.h>

#include <rths/adapters/adapter.hpp>
#include <rths/experiment/retreat.hpp>

namespace rths::plugin {

struct PluginSettings {
  std::filesystem::path library;
  const rths_adapter* built_in = nullptr;  ///< of this program; `library` is the file that it reads
  std::string config;                      ///< TOML text, for the plugin
  std::string title;                       ///< for messages; empty: "plugin 'name' (file)"
  experiment::Retreat retreat;
  double step_deadline = 0.3;  ///< of a step, wall time [s]
  double longest_unset = 2;    ///< until a step sets an output, from the first step on [s]
  bool may_allocate = false;   ///< a step that uses the heap is not a fault
};

/// An adapter in a shared library, in this process.
///
/// A step is a Fault, with the name of the plugin and the reason, if it crashes, does not return in
/// time, uses the heap, or writes NaN, a value outside its stated range or memory outside its
/// outputs. So is a step after `longest_unset` in which none had set any output. The outputs then
/// keep their last valid values. No step follows; only a plugin that is intact is deactivated and
/// destroyed.
///
/// A crash or an endless loop can leave locks and memory of this process in a bad state.
/// `make_child` separates them.
/// @throws Error if the library cannot be loaded or its signals are not usable   @setup
[[nodiscard]] std::unique_ptr<adapters::Adapter> make_plugin(const PluginSettings& settings);

/// Number of heap calls of this thread. Programs that can count them define it.
extern "C" __attribute__((weak)) long rths_heap_calls();

}  // namespace rths::plugin
