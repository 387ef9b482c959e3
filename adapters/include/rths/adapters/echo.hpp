// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opf_layout.hpp>

namespace rths::adapters {

/// A controller and machine that are wherever they are told to be, at once: what comes back is what
/// was commanded, and the force of a spring. Of any laboratory's map. To try a solver's script
/// with, and to see what the way there and back costs.
struct EchoSettings {
  OpfLayout layout;
  double stiffness = 1e6;  ///< of each axis [N/m, N·m/rad]
  /// atTarget stays down until the first target has come, as with controllers of the older
  /// generation.
  bool is_down_when_idle = false;
  bool is_prompt = false;  ///< steps come with the solver's words, not only when they are due
};

[[nodiscard]] std::unique_ptr<Adapter> make_echo(const EchoSettings& settings);

}  // namespace rths::adapters
