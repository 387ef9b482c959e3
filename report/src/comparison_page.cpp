// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <rths/report/comparison.hpp>
#include "assemble.hpp"

namespace rths::report {
namespace {

constexpr std::size_t kMostPoints = 3000;  // of a curve: more than a screen can show

// Of each part of a curve, the row with the largest difference: a word of one row is not lost.
std::vector<std::size_t> shown_rows(const PairedValues& values) {
  const std::size_t stride = stride_of(values.time.size(), kMostPoints);
  std::vector<std::size_t> rows;
  for (std::size_t begin = 0; begin < values.time.size(); begin += stride) {
    std::size_t shown = begin;
    for (std::size_t i = begin; i < std::min(begin + stride, values.time.size()); ++i)
      if (std::abs(values.other[i] - values.baseline[i]) >
          std::abs(values.other[shown] - values.baseline[shown]))
        shown = i;
    rows.push_back(shown);
  }
  return rows;
}

Json curve_data(const ComparedSignal& signal, const PairedValues& values) {
  const auto rows = shown_rows(values);
  const double start = values.time.empty() ? 0 : values.time.front();
  const auto picked = [&](const std::vector<double>& all, double offset) {
    std::vector<double> shown;
    for (const std::size_t row : rows) shown.push_back(all[row] - offset);
    return packed(shown);
  };
  return {{"signal", signal.name},
          {"unit", signal.unit},
          {"start_s", start},
          {"time", picked(values.time, start)},
          {"baseline", picked(values.baseline, 0)},
          {"other", picked(values.other, 0)}};
}

}  // namespace

std::string comparison_page(const ComparedRuns& comparison, std::size_t most,
                            const std::string& why) {
  std::vector<const ComparedSignal*> shown;
  std::vector<std::string> names;
  for (const auto& signal : comparison.signals) {
    if (signal.is_equal || shown.size() == most) continue;
    shown.push_back(&signal);
    names.push_back(signal.name);
  }
  const auto values = values_of(comparison, names);
  Json curves = Json::array();
  for (std::size_t i = 0; i < shown.size(); ++i) curves.push_back(curve_data(*shown[i], values[i]));
  return assemble(
      {web::kCompareHtml,
       {web::kPageCss},
       {web::kThemeJs, web::kPlotsJs, web::kFiguresJs, web::kQuantitiesJs, web::kChartsJs,
        web::kSaveJs, web::kCompareJs}},
      {{"comparison", Json::parse(json_of(comparison, why))}, {"curves", curves}, {"most", most}});
}

}  // namespace rths::report
