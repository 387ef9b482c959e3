// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/report/diagnosis.hpp>

#include "assemble.hpp"

namespace rths::report {
namespace {

constexpr double kFarFromZero = 1e5;  // [s]: single precision resolves 8 ms there

void shift(std::vector<double>& times, double by) {
  for (double& time : times) time += by;
}

// The location of the mismatch begins with its record, too.
void shift(diagnosis::Where& where, double by) {
  for (auto& [from, to] : where.intervals) from += by, to += by;
  for (auto& profile : where.profiles)
    if (profile.name == "time") shift(profile.edges, by);
}

// The verdict for a page: instants far from zero, such as those since 1970, begin with the record.
diagnosis::Verdict with_near_times(const diagnosis::Verdict& verdict) {
  diagnosis::Verdict near = verdict;
  std::vector<std::string> starts;
  const std::string* record = nullptr;  // the traces of a record follow each other
  for (auto& trace : near.evaluation.traces) {
    if (trace.time.empty() || std::abs(trace.time.front()) < kFarFromZero) continue;
    const double start = trace.time.front();
    shift(trace.time, -start);
    if (record != nullptr && *record == trace.record) continue;
    record = &trace.record;
    starts.push_back(fmt::format("{:.13g} s in {}", start, trace.record));
    if (trace.record == near.conclusion.where.record) shift(near.conclusion.where, -start);
  }
  if (!starts.empty())
    near.limits.push_back(
        fmt::format("The times of this page begin at {}.", fmt::join(starts, ", ")));
  return near;
}

// Points of a curve: more than a screen can show. Many curves share the limit of a page.
constexpr std::size_t kMostTracePoints = 6000, kMostPointsOfAll = 40'000;

Json curve(const std::vector<double>& values, std::size_t most) {
  return packed(thinned(values, most));
}

Json trace_data(const diagnosis::Trace& trace, std::size_t most) {
  Json without = Json::object();
  for (const auto& [name, prediction] : trace.without) without[name] = curve(prediction, most);
  return {{"record", trace.record},
          {"channel", trace.channel},
          {"unit", trace.unit},
          {"abscissa_label", trace.abscissa_label},
          {"time_label", trace.has_time ? "time [s]" : "row"},
          {"time", curve(trace.time, most)},
          {"abscissa", curve(trace.abscissa, most)},
          {"measured", curve(trace.measured, most)},
          {"before", curve(trace.before, most)},
          {"after", curve(trace.after, most)},
          {"without", without},
          {"excess", curve(trace.excess, most)}};
}

// The response of the test, of its simulation, and with all parts as identified. Times are those of
// the recording, as everywhere on the pages of a run.
Json response_data(const diagnosis::Verdict& verdict) {
  return each(verdict.budget.axes, [&](const budget::AxisBudget& axis) {
    std::vector<double> time = verdict.budget.times;
    for (std::size_t i = time.size(); i < axis.measured.size(); ++i)
      time.push_back(static_cast<double>(i + 1) * verdict.budget.integration_step);
    time.resize(axis.measured.size());
    return Json{{"axis", name_of(axis.axis)},
                {"time", curve(time, kMostTracePoints)},
                {"measured", curve(axis.measured, kMostTracePoints)},
                {"simulated", curve(axis.simulated, kMostTracePoints)},
                {"improved", curve(axis.improved, kMostTracePoints)}};
  });
}

// Those of the first record, of the place of the mismatch, and of the proof.
std::vector<const diagnosis::Trace*> shown_traces(const diagnosis::Verdict& verdict) {
  std::vector<const diagnosis::Trace*> shown;
  for (const auto& trace : verdict.evaluation.traces)
    if (trace.record == verdict.evaluation.traces[0].record ||
        trace.record == verdict.conclusion.where.record ||
        trace.record == verdict.evaluation.proof_record)
      shown.push_back(&trace);
  return shown;
}

}  // namespace

std::string verdict_page(const diagnosis::Verdict& given) {
  const diagnosis::Verdict verdict = with_near_times(given);
  Json data;
  data["verdict"] = verdict_numbers(verdict);
  data["responses"] = response_data(verdict);
  const auto shown = shown_traces(verdict);
  const std::size_t most =
      std::min(kMostTracePoints, kMostPointsOfAll / std::max<std::size_t>(1, shown.size()));
  data["traces"] =
      each(shown, [&](const diagnosis::Trace* trace) { return trace_data(*trace, most); });
  return assemble(
      {web::kDiagnosisHtml,
       {web::kPageCss, web::kVerdictCss, web::kDiagnosisCss},
       {web::kThemeJs, web::kPlotsJs, web::kFiguresJs, web::kQuantitiesJs, web::kSentenceJs,
        web::kChartsJs, web::kSaveJs, web::kCurtainJs, web::kVerdictJs, web::kBudgetJs,
        web::kWhereJs, web::kProofJs, web::kDiagnosisJs}},
      data);
}

}  // namespace rths::report
