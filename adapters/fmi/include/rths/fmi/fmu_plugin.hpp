// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths_adapter.h>

namespace rths::fmi {

/// An FMU behind the interface of plugins. Its config has the keys `folder` (of the unpacked FMU),
/// `instance` and `step_s`, and those of the node: see `read_fmu`.
[[nodiscard]] const rths_adapter& fmu_adapter();

}  // namespace rths::fmi
