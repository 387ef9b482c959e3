// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/fmu_unit.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>

namespace rths::fmi {
namespace {

// "kg.m.s-2"
std::string text_of(const BaseUnit& unit) {
  std::string text;
  for (std::size_t i = 0; i < unit.exponents.size(); ++i)
    if (unit.exponents[i] != 0)
      text += fmt::format("{}{}{}", text.empty() ? "" : ".", kBases[i],
                          unit.exponents[i] == 1 ? "" : std::to_string(unit.exponents[i]));
  return text.empty() ? "1" : text;
}

}  // namespace

SiUnit si_unit_of(const ModelDescription& description, const Variable& variable) {
  if (!variable.is_real() || variable.unit.empty()) return {};
  try {
    const auto defined = description.units.find(variable.unit);
    const bool is_defined = defined != description.units.end();
    const auto unit = memmap::parse_unit(is_defined ? text_of(defined->second) : variable.unit);
    SiUnit result{unit.si, {unit.scale, unit.offset}};
    if (is_defined) result.conversion = {defined->second.factor, defined->second.offset};
    if (variable.is_relative) result.conversion.offset = 0;
    return result;
  } catch (const Error& error) {
    throw Error{fmt::format("unit '{}' of '{}': {}", variable.unit, variable.name, error.what())};
  }
}

}  // namespace rths::fmi
