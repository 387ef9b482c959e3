// SPDX-License-Identifier: Apache-2.0
#include "unit_scales.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

double scale_of(const UnitScales& scales, std::string_view symbol) {
  const double mass = scales.force * scales.time * scales.time / scales.length;
  const std::pair<std::string_view, double> known[] = {
      {"m", scales.length},
      {"N", scales.force},
      {sim::kChannelUnit, scales.channel.value_or(scales.force)},
      {"A", scales.current},
      {"s", scales.time},
      {"kg", mass},
      {"J", scales.force * scales.length},
      {"W", scales.force * scales.length / scales.time},
      {"Pa", scales.force / (scales.length * scales.length)}};
  for (const auto& [name, scale] : known)
    if (symbol == name) return scale;
  for (const std::string_view plain : {"-", "1", "rad", "K", "degC"})
    if (symbol == plain) return 1;
  throw Error{fmt::format("unit '{}' of a term's parameter is unknown", symbol)};
}

}  // namespace

std::vector<UnitFactor> factors_of(std::string_view unit) {
  std::vector<UnitFactor> factors;
  int sign = 1;
  while (!unit.empty()) {
    const auto end = std::min(unit.find_first_of("*/"), unit.size());
    std::string_view symbol = unit.substr(0, end);
    int power = 1;
    if (symbol.size() > 1 && symbol.back() >= '0' && symbol.back() <= '9') {
      power = symbol.back() - '0';
      symbol.remove_suffix(1);
    }
    factors.push_back({symbol, sign * power});
    if (end < unit.size() && unit[end] == '/') sign = -1;
    unit.remove_prefix(std::min(end + 1, unit.size()));
  }
  return factors;
}

std::string UnitSymbols::of(std::string_view unit) const {
  constexpr std::string_view kBetween = "*/0123456789";
  std::string result;
  while (!unit.empty()) {
    const auto end = std::min(unit.find_first_of(kBetween), unit.size());
    const std::string_view symbol = unit.substr(0, end);
    const std::string chosen = symbol == "m"   ? length
                               : symbol == "N" ? force
                               : symbol == "A" ? current
                                               : std::string{symbol};
    const bool is_ratio = chosen != symbol && chosen.find('/') != std::string::npos;
    result += is_ratio ? "(" + chosen + ")" : chosen;
    if (end < unit.size()) result += unit[end];
    unit.remove_prefix(std::min(end + 1, unit.size()));
  }
  return result;
}

double UnitScales::of(std::string_view unit) const {
  double scale = 1;
  for (const auto& [symbol, power] : factors_of(unit)) {
    const double factor = std::pow(scale_of(*this, symbol), std::abs(power));
    scale = power > 0 ? scale * factor : scale / factor;
  }
  return scale;
}

double scale_for(double size, double low, double high, double typical) {
  if (!(size > 0) || !std::isfinite(size) || (size >= low && size <= high)) return 1;
  return std::pow(10.0, std::round(std::log10(size / typical)));
}

sim::TermSettings in_units(const sim::TermSettings& term, const UnitScales& scales) {
  const sim::TermKind& kind = sim::term_kind(term.kind);
  for (const auto& [name, value] : term.parameters) static_cast<void>(parameter_of(kind, name));
  sim::TermSettings scaled = term;
  scaled.parameters.clear();
  for (const auto& parameter : kind.parameters) {
    double value = parameter.absent;
    for (const auto& [name, stated] : term.parameters)
      if (name == parameter.name) value = stated;
    scaled.parameters.emplace_back(parameter.name, std::clamp(value / scales.of(parameter.unit),
                                                              parameter.low, parameter.high));
  }
  return scaled;
}

}  // namespace rths::diagnosis
