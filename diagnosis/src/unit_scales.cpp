// SPDX-License-Identifier: Apache-2.0
#include "unit_scales.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

// A symbol with its power, "m3".
double scale_of_factor(const UnitScales& scales, std::string_view factor) {
  int power = 1;
  if (!factor.empty() && factor.back() >= '0' && factor.back() <= '9' && factor.size() > 1) {
    power = factor.back() - '0';
    factor.remove_suffix(1);
  }
  const double mass = scales.force * scales.time * scales.time / scales.length;
  const std::pair<std::string_view, double> known[] = {
      {"m", scales.length},
      {"N", scales.force},
      {sim::kChannelUnit, scales.force},
      {"s", scales.time},
      {"kg", mass},
      {"J", scales.force * scales.length},
      {"W", scales.force * scales.length / scales.time},
      {"Pa", scales.force / (scales.length * scales.length)}};
  for (const auto& [symbol, scale] : known)
    if (factor == symbol) return std::pow(scale, power);
  for (const std::string_view plain : {"-", "1", "rad", "K", "degC"})
    if (factor == plain) return 1;
  throw Error{fmt::format("unit '{}' of a term's parameter is not known", factor)};
}

double scale_of_product(const UnitScales& scales, std::string_view product) {
  double scale = 1;
  while (!product.empty()) {
    const auto end = std::min(product.find('*'), product.size());
    scale *= scale_of_factor(scales, product.substr(0, end));
    product.remove_prefix(std::min(end + 1, product.size()));
  }
  return scale;
}

}  // namespace

double UnitScales::of(std::string_view unit) const {
  auto end = std::min(unit.find('/'), unit.size());
  double scale = scale_of_product(*this, unit.substr(0, end));
  while (end < unit.size()) {
    unit.remove_prefix(end + 1);
    end = std::min(unit.find('/'), unit.size());
    scale /= scale_of_product(*this, unit.substr(0, end));
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
