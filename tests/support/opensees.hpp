// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace rths::test {

/// Python with OpenSees: RTHS_OPENSEES_PYTHON, or the interpreter installed by `./lab test`.
[[nodiscard]] std::optional<std::string> opensees_python();

/// Whether there is MPICH's launcher, which OpenSees needs for several processors.
[[nodiscard]] bool has_mpich();
inline constexpr const char* kWithoutMpich =
    "SKIPPED: MPICH is not installed; ./lab test installs its package, mpich";

}  // namespace rths::test
