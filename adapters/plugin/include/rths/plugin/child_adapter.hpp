// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <rths/adapters/adapter.hpp>

namespace rths::plugin {

struct ChildSettings {
  std::string title;           ///< of the adapter, for messages
  double setup_deadline = 20;  ///< until it is made, until it is active [s]
  double step_deadline = 0.5;  ///< of a step, wall time [s]; the process ends 0.1 s later
  int priority = 0;            ///< real-time priority of the process from `activate` on; 0: none
};

/// Any adapter, in a process of its own. The process is a copy of this one, so it starts at once;
/// it ends with this adapter.
///
/// A step passes its arrays through shared memory and waits for the answer, so it makes system
/// calls. It is a Fault if the process ends or does not answer in time; the process is killed then.
/// Wake events are not supported.
/// @param make  called in the new process. Its Error is thrown here   @setup
[[nodiscard]] std::unique_ptr<adapters::Adapter> make_child(
    const std::function<std::unique_ptr<adapters::Adapter>()>& make, const ChildSettings& settings);

}  // namespace rths::plugin
