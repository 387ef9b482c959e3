// SPDX-License-Identifier: Apache-2.0
#include <rths/report/report.hpp>

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <rths/core/replace_files.hpp>
#include <rths/report/diagnosis.hpp>

#include "assemble.hpp"
#include "companions.hpp"
#include "numbers.hpp"

namespace rths::report {
namespace {

constexpr std::size_t kMostCurvePoints = 4000;  // of a curve: more than a screen can show

// The largest value of each interval, so that thinning keeps a rare late millisecond.
std::vector<double> peaks(const std::vector<double>& values) {
  const std::size_t stride = stride_of(values.size(), kMostCurvePoints);
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += stride)
    result.push_back(*std::max_element(
        values.begin() + static_cast<std::ptrdiff_t>(i),
        values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), i + stride))));
  return result;
}

Json series(const Series& s, double scale, bool keep_peaks = false) {
  const auto stride = static_cast<double>(stride_of(s.values.size(), kMostCurvePoints));
  return {{"start", s.start},
          {"interval", s.interval * stride},
          {"values",
           packed(keep_peaks ? peaks(s.values) : thinned(s.values, kMostCurvePoints), scale)}};
}

Json axis_data(const AxisAnalysis& axis) {
  return {{"name", axis.name},
          {"command_mm", series(axis.command, kMilli)},
          {"measured_mm", series(axis.measured, kMilli)},
          {"step_displacement_mm", packed(axis.step_displacement, kMilli)},
          {"step_force_kN", packed(axis.step_force, kPerKilo)},
          {"a0", series(axis.a0, 1)},
          {"a1_ms", series(axis.a1, kMilli)},
          {"a2_ms2", series(axis.a2, kMilli * kMilli)},
          {"delay_ms", series(axis.tracking.delay, kMilli)},
          {"nrms_percent", series(axis.tracking.nrms, 100)}};
}

Json numerical_data(const NumericalAxis& axis, double interval) {
  const Series displacement{interval, interval, axis.displacement};
  return {{"name", axis.name},
          {"displacement_mm", series(displacement, kMilli)},
          {"loop_displacement_mm", packed(thinned(axis.displacement, kMostCurvePoints), kMilli)},
          {"loop_force_kN", packed(thinned(axis.force, kMostCurvePoints), kPerKilo)}};
}

Json steps_data(const StepAnalysis& steps) {
  std::vector<double> start = steps.start;
  if (!start.empty()) start.pop_back();
  return {{"start_s", packed(start)},
          {"predict_ms", packed(steps.predict, kMilli)},
          {"correct_ms", packed(steps.correct, kMilli)},
          {"slow_ms", packed(steps.slow, kMilli)}};
}

Json vertical_data(const std::optional<VerticalAnalysis>& vertical) {
  if (!vertical) return nullptr;
  return {{"command_kN", series(vertical->command, kPerKilo)},
          {"measured_kN", series(vertical->measured, kPerKilo)},
          {"frequencies_Hz", packed(vertical->coherence.frequency)},
          {"coherence", packed(vertical->coherence.value)}};
}

Json floor_data(const FloorSpectra& floor) {
  return {{"floor", floor.floor},
          {"spectra", each(floor.spectra, [](const FloorSpectrum& spectrum) {
             return Json{{"of", spectrum.of}, {"values", packed(spectrum.values)}};
           })}};
}

// The sketch is that of a recording, and may be of any program.
Json structure_data(const StructureAnalysis& structure) {
  const Json sketch = Json::parse(structure.sketch, nullptr, false);
  const Series least{structure.interval, structure.interval, structure.least},
      largest{structure.interval, structure.interval, structure.largest};
  return {{"sketch", sketch.is_object() ? sketch : Json(nullptr)},
          {"least_MN", series(least, kPerMega)},
          {"largest_MN", series(largest, kPerMega)}};
}

Json page_data(const Analysis& analysis, const Json& numbers) {
  Json data;
  data["numbers"] = numbers;
  data["axes"] = each(analysis.axes, axis_data);
  for (const auto& [name, axes] : {std::pair{"numerical", &analysis.companions.numerical},
                                   std::pair{"improved", &analysis.companions.improved}})
    data[name] = each(*axes, [&](const NumericalAxis& axis) {
      return numerical_data(axis, analysis.companions.interval);
    });
  const auto& beside = analysis.beside;
  data["beside"] = each(
      beside ? beside->axes : std::vector<NumericalAxis>{},
      [&](const NumericalAxis& axis) { return numerical_data(axis, beside->integration_step); });
  data["vertical"] = vertical_data(analysis.vertical);
  data["steps"] = steps_data(analysis.steps);
  data["host_late_ms"] = series(analysis.hosts.late, kMilli, true);
  data["frequencies_Hz"] = packed(analysis.spectra.frequencies);
  data["structure"] = structure_data(analysis.structure);
  data["floors"] = each(analysis.spectra.floors, floor_data);
  return data;
}

// The complete page of a run: style, scripts and data in one self-contained file.
std::string page_of(const Analysis& analysis, const Json& numbers) {
  return assemble(
      {web::kReportHtml,
       {web::kPageCss, web::kVerdictCss},
       {web::kThemeJs, web::kPlotsJs, web::kFiguresJs, web::kQuantitiesJs, web::kChartsJs,
        web::kSaveJs, web::kSentenceJs, web::kStructureJs, web::kReportJs}},
      page_data(analysis, numbers));
}

// The verdict of a diagnosis in the folder of the run; null if there is none.
Json verdict_in(const std::filesystem::path& folder) {
  const auto file = folder / kVerdictFile;
  if (!std::filesystem::exists(file)) return nullptr;
  std::ifstream stream{file};
  const Json verdict = Json::parse(stream, nullptr, false);
  if (!verdict.is_object() || verdict.value("format", 0) != kVerdictFormat)
    throw Error{fmt::format("{}: not a verdict of format {}; remove it or diagnose the run again",
                            file.string(), kVerdictFormat)};
  return verdict;
}

}  // namespace

std::vector<Broken> judge_run(const std::filesystem::path& folder) {
  const Reader run{folder / kRunFile};
  for (const char* file : {kImprovedFile, kNumericalFile}) {
    if (!std::filesystem::exists(folder / file)) continue;
    const Reader reference{folder / file};
    return judge(run, &reference);
  }
  return judge(run);
}

ReportOutcome make_report(const std::filesystem::path& folder, std::vector<Broken> broken,
                          const std::filesystem::path& beside) {
  Analysis analysis = analyse(folder);
  if (!beside.empty()) add_beside(analysis, beside);
  analysis.broken = std::move(broken);
  Json numbers = numbers_of(analysis);
  numbers["diagnosis"] = verdict_in(folder);
  const ReportOutcome outcome{folder / "report.html", folder / "report.json", summary_of(analysis),
                              is_conclusive(analysis)};
  replace_file(outcome.page, page_of(analysis, numbers));
  replace_file(outcome.numbers, numbers.dump(2) + "\n");
  return outcome;
}

}  // namespace rths::report
