// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rths::test {

/// The Python that has OpenSees: RTHS_OPENSEES_PYTHON, or the one that `./lab test` made.
[[nodiscard]] std::optional<std::string> opensees_python();

}  // namespace rths::test
