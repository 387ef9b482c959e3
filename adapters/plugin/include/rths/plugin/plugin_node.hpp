// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/adapters/factory.hpp>

namespace rths::plugin {

/// An adapter in a shared library. Keys: library, role, config, own_process, deadline_s, allocates.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] adapters::NodeSettings read_plugin(const std::string& node, const Config& table,
                                                 const adapters::TestSetup& setup);

}  // namespace rths::plugin
