// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rths::diagnosis {

/// What is wrong with a role, or with its SI unit; nothing if it is right.
[[nodiscard]] std::optional<std::string> trouble_with(const std::string& role,
                                                      const std::string& si_unit);

/// The kind of model that is meant: hyphens and blanks stand for underscores. Nothing: none is.
[[nodiscard]] std::optional<std::string> model_kind(std::string spelling);
/// For messages: "bearing, platen, …".
[[nodiscard]] std::string model_kinds();

}  // namespace rths::diagnosis
