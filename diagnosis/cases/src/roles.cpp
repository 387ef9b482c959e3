// SPDX-License-Identifier: Apache-2.0
#include "roles.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {
namespace {

// A family of roles: "displacement" stands for displacement.<axis>.
struct Family {
  std::string_view name;
  bool has_members;
  std::string_view units[2];  // along an axis, about an axis; none: any
};
constexpr Family kFamilies[] = {{"command", true, {"m", "rad"}},
                                {"displacement", true, {"m", "rad"}},
                                {"velocity", true, {"m/s", "rad/s"}},
                                {"acceleration", true, {"m/s2", "rad/s2"}},
                                {"force", true, {"N", "N.m"}},
                                {"vertical_force", false, {"N", "N"}},
                                {"temperature", false, {"K", "K"}},
                                {"input", true, {}},
                                {"output", true, {}},
                                {"auxiliary", true, {}}};

// In the order of ModelKind.
constexpr std::string_view kModelKinds[] = {
    "bearing", "platen",   "servo_axis", "structure", "mass_spring_damper", "linear", "data",
    "program", "opensees", "fmu",        "plugin"};

}  // namespace

std::optional<std::string> trouble_with(const std::string& full_role, const std::string& si_unit) {
  std::string_view role = full_role;
  if (is_predicted(role)) role.remove_prefix(kPredicted.size());
  const auto dot = role.find('.');
  const std::string_view name = role.substr(0, dot);
  const auto family = std::find_if(std::begin(kFamilies), std::end(kFamilies),
                                   [&](const Family& known) { return known.name == name; });
  if (family == std::end(kFamilies)) {
    std::string known;
    for (const auto& candidate : kFamilies)
      known += fmt::format("{}{}{}", known.empty() ? "" : ", ", candidate.name,
                           candidate.has_members ? ".*" : "");
    return fmt::format("there is no role '{}', expected one of {}, predicted.*", full_role, known);
  }
  if (family->has_members != (dot != std::string_view::npos))
    return fmt::format(
        "role '{}' {}", full_role,
        family->has_members ? "names no member, as in force.long" : "has no members");
  if (family->units[0].empty() || si_unit == family->units[0] || si_unit == family->units[1])
    return std::nullopt;
  return fmt::format("{} is in {}, expected {}", full_role, si_unit, family->units[0]);
}

std::optional<ModelKind> model_kind(std::string spelling) {
  std::replace(spelling.begin(), spelling.end(), '-', '_');
  std::replace(spelling.begin(), spelling.end(), ' ', '_');
  if (spelling == "servo_hydraulic_axis") spelling = "servo_axis";
  const auto known = std::find(std::begin(kModelKinds), std::end(kModelKinds), spelling);
  if (known == std::end(kModelKinds)) return std::nullopt;
  return static_cast<ModelKind>(known - std::begin(kModelKinds));
}

std::string name_of(ModelKind kind) {
  return std::string{kModelKinds[static_cast<std::size_t>(kind)]};
}

bool is_composition(ModelKind kind) {
  return kind == ModelKind::Bearing || kind == ModelKind::Platen || kind == ModelKind::ServoAxis;
}

bool is_foreign(ModelKind kind) { return kind >= ModelKind::Program; }

bool is_prediction(ModelKind kind) { return kind == ModelKind::Data || is_foreign(kind); }

std::string model_kinds() { return fmt::format("{}", fmt::join(kModelKinds, ", ")); }

}  // namespace rths::diagnosis
