// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/fmi/exchange.hpp>
#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// The SI unit of a variable and the conversion to it.
struct SiUnit {
  std::string name = "1";
  Conversion conversion;
};

/// The FMU's own definition of a unit has priority over the usual meaning of its name. A variable
/// without a unit is a pure number.
/// @throws Error if the unit is unknown   @setup
[[nodiscard]] SiUnit si_unit_of(const ModelDescription& description, const Variable& variable);

}  // namespace rths::fmi
