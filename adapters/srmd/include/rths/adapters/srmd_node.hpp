// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// A virtual SRMD behind a safety layer, whose limits the key `safety` changes. Without other keys,
/// it has two axes. `model` names a machine file, with six degrees of freedom; `family_member` (0:
/// nominal) and a table `changes` vary it.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_srmd(const std::string& node, const Config& table,
                                                 const experiment::Experiment& setup);
/// An ideal machine; has no keys of its own. @throws Error with the place of the first wrong value
/// @setup
[[nodiscard]] experiment::NodeSettings read_ideal_machine(const std::string& node,
                                                          const Config& table,
                                                          const experiment::Experiment& setup);

}  // namespace rths::adapters
