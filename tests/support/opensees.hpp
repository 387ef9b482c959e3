// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rths::test {

/// Python with OpenSees: RTHS_OPENSEES_PYTHON, or the interpreter installed by `./lab test`.
[[nodiscard]] std::optional<std::string> opensees_python();

}  // namespace rths::test
