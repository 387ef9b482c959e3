// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// The error in a role or in its SI unit, as a message; nothing if both are right.
[[nodiscard]] std::optional<std::string> trouble_with(const std::string& role,
                                                      const std::string& si_unit);

/// The kind of model with this spelling; hyphens and blanks stand for underscores. Nothing:
/// unknown.
[[nodiscard]] std::optional<ModelKind> model_kind(std::string spelling);
/// All kinds of models, for messages: "bearing, platen, …".
[[nodiscard]] std::string model_kinds();

}  // namespace rths::diagnosis
