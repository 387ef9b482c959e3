// SPDX-License-Identifier: Apache-2.0
#include "numbers.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/maths/bands.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/report/report.hpp>

namespace rths::report {
namespace {

// Bands for comparing spectra [Hz]: isolation and first modes of the buildings; the band of the
// machine's errors and of vertical motion; higher frequencies.
struct Band {
  const char* name;
  double from, to;
};
constexpr double kLeastCoherent = 1, kMostCoherent = 15;  // of the vertical force [Hz]
constexpr Band kBands[] = {{"below_6_Hz", 0, 6}, {"6_to_11_Hz", 6, 11}, {"above_11_Hz", 11, 1e3}};

// The values without NaN.
std::vector<double> numbers_in(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double value) { return std::isnan(value); }),
      values.end());
  return values;
}

// None without values.
std::optional<double> median(std::vector<double> values) {
  return values.empty() ? std::nullopt : std::optional{maths::quantile(std::move(values), 0.5)};
}

// Rounds to significant decimals.
double rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

Json optional_ms(const std::optional<double>& seconds) {
  return seconds ? Json(rounded(*seconds * kMilli, 2)) : Json(nullptr);
}

// Ratio of the test's spectrum to another by band, as the geometric mean.
Json spectrum_ratios(const FloorSpectra& floor, const std::string& of,
                     const std::vector<double>& frequencies) {
  const auto found = std::ranges::find_if(
      floor.spectra, [&](const FloorSpectrum& spectrum) { return spectrum.of == of; });
  if (found == floor.spectra.end()) return nullptr;
  Json ratios;
  for (const auto& band : kBands) {
    std::vector<double> logarithms;
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      if (frequencies[i] >= band.from && frequencies[i] < band.to)
        logarithms.push_back(std::log(floor.spectra[0].values[i] / found->values[i]));
    ratios[band.name] = rounded(std::exp(maths::mean(logarithms)), 4);
  }
  return ratios;
}

Json floor_numbers(const FloorSpectra& floor, const std::vector<double>& frequencies) {
  return {{"hybrid_over_numerical", spectrum_ratios(floor, "numerical", frequencies)},
          {"hybrid_over_improved", spectrum_ratios(floor, "improved", frequencies)}};
}

void add_numerical(Json& json, const std::string& axis, const char* prefix,
                   const std::vector<NumericalAxis>& numerical) {
  const auto key = [&](const char* name) { return fmt::format("{}_{}", prefix, name); };
  for (const auto& model : numerical) {
    if (model.name != axis) continue;
    json[key("peak_displacement_mm")] = rounded(model.peak_displacement * kMilli, 2);
    json[key("peak_shear_kN")] = rounded(model.peak_shear * kPerKilo, 1);
    json[key("difference_percent")] = rounded(model.difference * kPercent, 2);
  }
}

Json band_numbers(const maths::BandTracking& band) {
  Json json{{"from_Hz", rounded(band.from, 3)},
            {"to_Hz", rounded(band.to, 3)},
            {"command_percent", rounded(band.command * kPercent, 3)},
            {"nrms_percent", rounded(band.nrms * kPercent, 3)},
            {"gain", nullptr},
            {"delay_ms", nullptr},
            {"coherence", nullptr}};
  if (!band.response) return json;
  json["gain"] = rounded(band.response->gain, 4);
  json["delay_ms"] = rounded(band.response->delay * kMilli, 2);
  json["coherence"] = rounded(band.response->coherence, 4);
  return json;
}

Json axis_numbers(const AxisAnalysis& axis, const Analysis& analysis) {
  Json json;
  json["delay_raw_ms"] = optional_ms(axis.raw_delay);
  json["delay_raw_min_rms_ms"] = optional_ms(axis.raw_delay_min_rms);
  json["nrms_raw_percent"] =
      axis.raw_nrms ? Json(rounded(*axis.raw_nrms * kPercent, 3)) : Json(nullptr);
  json["delay_compensated_ms"] = rounded(axis.delay * kMilli, 2);
  json["delay_compensated_min_rms_ms"] = rounded(axis.delay_min_rms * kMilli, 2);
  json["nrms_percent"] = rounded(axis.nrms * kPercent, 3);
  const auto delays = numbers_in(axis.tracking.delay.values);
  json["delay_in_windows_median_ms"] = optional_ms(median(delays));
  json["delay_in_windows_max_ms"] = optional_ms(most_extreme(delays));
  json["nrms_in_windows_max_percent"] = rounded(largest(axis.tracking.nrms.values) * kPercent, 3);
  json["peak_error_percent"] = rounded(axis.peak_error * kPercent, 3);
  json["peak_displacement_mm"] = rounded(axis.peak_displacement * kMilli, 2);
  json["peak_shear_kN"] = rounded(axis.peak_shear * kPerKilo, 1);
  json["compensator_ticks_at_a_limit"] = axis.compensator_limited;
  json["tracking_bands"] = each(axis.bands, band_numbers);
  add_numerical(json, axis.name, "numerical", analysis.companions.numerical);
  add_numerical(json, axis.name, "improved", analysis.companions.improved);
  return json;
}

Json vertical_numbers(const std::optional<VerticalAnalysis>& vertical) {
  if (!vertical) return nullptr;
  const auto least = vertical->coherence.least(kLeastCoherent, kMostCoherent);
  return {{"delay_ms", rounded(vertical->delay * kMilli, 2)},
          {"rms_percent", rounded(vertical->error * kPercent, 3)},
          {"peak_to_peak_kN", rounded(vertical->span * kPerKilo, 1)},
          {"coherence_1_to_15_Hz", least ? Json(rounded(*least, 4)) : Json(nullptr)},
          {"tracking_bands", each(vertical->bands, band_numbers)}};
}

Json beside_numbers(const std::optional<Beside>& beside) {
  if (!beside) return nullptr;
  Json json{{"name", beside->name},
            {"folder", beside->folder},
            {"rate", beside->rate},
            {"ending", text_or_null(beside->ending)},
            {"axes", Json::object()}};
  for (const auto& axis : beside->axes) {
    Json& numbers = json["axes"][axis.name] = Json::object();
    add_numerical(numbers, axis.name, kBeside, beside->axes);
  }
  return json;
}

Json change_numbers(const OperatorChange& change) {
  return {{"time_s", rounded(change.time, 3)},
          {"signal", change.signal},
          {"unit", change.unit},
          {"from", change.from},
          {"to", change.to}};
}

Json node_numbers(const NodeAnalysis& node) {
  return {{"steps", node.steps},
          {"overruns", node.overruns},
          {"stale_reads", node.stale},
          {"late_p50_ms", rounded(node.late_p50 * kMilli, 4)},
          {"late_p99_ms", rounded(node.late_p99 * kMilli, 4)},
          {"late_max_ms", rounded(node.late_max * kMilli, 3)}};
}

Json hop_numbers(const HopAnalysis& hop) {
  return {{"from", hop.from},
          {"to", hop.to},
          {"delay_p50_ms", rounded(hop.delay_p50 * kMilli, 4)},
          {"delay_p99_ms", rounded(hop.delay_p99 * kMilli, 4)},
          {"delay_max_ms", rounded(hop.delay_max * kMilli, 3)},
          {"age_p99_ms", rounded(hop.age_p99 * kMilli, 3)},
          {"age_max_ms", rounded(hop.age_max * kMilli, 3)}};
}

// The slowest hop between two hosts.
std::string hops_summary(const std::vector<HopAnalysis>& hops) {
  if (hops.empty()) return "";
  const auto slowest = std::ranges::max_element(
      hops, [](const auto& a, const auto& b) { return a.delay_p99 < b.delay_p99; });
  return fmt::format(
      "hosts   updates of {} reach host {} in {:.2f} ms (p99 {:.2f}, at most {:.1f}), the slowest "
      "of {} hops\n",
      slowest->from, slowest->to, slowest->delay_p50 * kMilli, slowest->delay_p99 * kMilli,
      slowest->delay_max * kMilli, hops.size());
}

Json broken_numbers(const Broken& broken) {
  return {{"condition", broken.condition}, {"time_s", rounded(broken.time, 3)},
          {"signal", broken.signal},       {"found", broken.found},
          {"expected", broken.expected},   {"text", broken.text()}};
}

Json safety_numbers(const SafetyChange& change) {
  return {{"time_s", rounded(change.time, 3)}, {"state", change.state}, {"text", change.text}};
}

// Integration steps of the test.
std::size_t count_of(const StepAnalysis& steps) {
  return std::max(steps.start.size(), steps.slow.size() + 1);
}

Json mean_ms(const std::vector<double>& seconds) {
  return seconds.empty() ? Json(nullptr) : Json(rounded(maths::mean(seconds) * kMilli, 4));
}

Json left_out_numbers(const LeftOut& left) {
  return {{"section", left.section}, {"reason", left.reason}};
}

std::string left_out_summary(const std::vector<LeftOut>& sections) {
  std::string text;
  for (const auto& left : sections)
    text += fmt::format("without {}: {}\n", left.section, left.reason);
  return text;
}

long total_overruns(const Analysis& analysis) {
  long overruns = 0;
  for (const auto& node : analysis.hosts.nodes) overruns += node.overruns;
  return overruns;
}

// Delay and error of an axis, of all frequencies and of each band.
std::string axis_summary(const AxisAnalysis& axis) {
  const auto in_windows = median(numbers_in(axis.tracking.delay.values));
  std::string text = fmt::format(
      "{:<7} delay {}{:.1f} ms (median over 2 s windows {})  NRMS {:.2f} %  peak "
      "{:.1f} mm, {:.0f} kN\n",
      axis.name, axis.raw_delay ? fmt::format("{:.1f} -> ", *axis.raw_delay * kMilli) : "",
      axis.delay * kMilli, in_windows ? fmt::format("{:.1f}", *in_windows * kMilli) : "–",
      axis.nrms * kPercent, axis.peak_displacement * kMilli, axis.peak_shear * kPerKilo);
  for (const auto& band : axis.bands)
    if (band.response)
      text += fmt::format(
          "        {:>2.0f} to {:>2.0f} Hz: delay {:.1f} ms  gain {:.3f}  coherence {:.2f}  NRMS "
          "{:.2f} %\n",
          band.from, band.to, band.response->delay * kMilli, band.response->gain,
          band.response->coherence, band.nrms * kPercent);
  return text;
}

// How far the test's displacement is from the results with a model instead of the specimen.
std::string response_summary(const std::string& axis, const Analysis& analysis) {
  std::string text;
  const auto add = [&](const char* result, const std::vector<NumericalAxis>& models) {
    for (const auto& model : models)
      if (model.name == axis)
        text += fmt::format("{}{:.1f} % from the {} result", text.empty() ? "" : ", ",
                            model.difference * kPercent, result);
  };
  add("numerical", analysis.companions.numerical);
  add("improved", analysis.companions.improved);
  return text.empty() ? "" : "        response differs by " + text + " (rms)\n";
}

std::string vertical_summary(const std::optional<VerticalAnalysis>& vertical) {
  if (!vertical) return "";
  const auto least = vertical->coherence.least(kLeastCoherent, kMostCoherent);
  return fmt::format(
      "vert    force: delay {:.2f} ms  RMS error {:.2f} % of {:.0f} kN peak to peak{}\n",
      vertical->delay * kMilli, vertical->error * kPercent, vertical->span * kPerKilo,
      least ? fmt::format("  coherence {:.2f} or more from {:g} to {:g} Hz", *least, kLeastCoherent,
                          kMostCoherent)
            : "");
}

// A rate that differs from the planned one by more than rounding.
std::string rate_summary(const Analysis& analysis) {
  constexpr double kWorthStating = 0.01;
  const auto& achieved = analysis.timing.achieved_rate;
  if (!achieved || std::abs(*achieved - analysis.test.rate) <= kWorthStating * analysis.test.rate)
    return "";
  return fmt::format("rate    {:.2f} s of wall time per second of the model, planned {:g}\n",
                     *achieved, analysis.test.rate);
}

std::string beside_summary(const std::optional<Beside>& beside) {
  if (!beside) return "";
  std::string text = fmt::format(
      "beside  {} ({}), {}", beside->name, beside->folder,
      beside->rate == 1 ? "at true speed" : fmt::format("{:g} times slower", beside->rate));
  for (const auto& axis : beside->axes)
    text += fmt::format(", {} {:.1f} %", axis.name, axis.difference * kPercent);
  text += " apart (rms)\n";
  if (!beside->ending.empty()) text += fmt::format("        it ended early: {}\n", beside->ending);
  return text;
}

std::string changes_summary(const std::vector<OperatorChange>& changes) {
  constexpr std::size_t kMostShown = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(changes.size(), kMostShown); ++i)
    text += fmt::format("changed {} from {:g} to {:g}{} at {:.3f} s\n", changes[i].signal,
                        changes[i].from, changes[i].to,
                        changes[i].unit == "1" ? "" : " " + changes[i].unit, changes[i].time);
  if (changes.size() > kMostShown)
    text +=
        fmt::format("changed {} more words: report.json has all\n", changes.size() - kMostShown);
  return text;
}

}  // namespace

bool is_conclusive(const Analysis& analysis) {
  return analysis.test.ending.empty() && analysis.broken.empty();
}

Json numbers_of(const Analysis& analysis) {
  const StepAnalysis& steps = analysis.steps;
  Json json;
  json["report_format"] = 1;
  json["name"] = analysis.test.name;
  json["motion"] = analysis.test.motion;
  json["synthetic"] = analysis.test.synthetic;
  json["processes"] = analysis.hosts.processes;
  json["clock"] = analysis.test.clock;
  json["real_time"] = text_or_null(analysis.hosts.real_time);
  json["duration_s"] = rounded(analysis.timing.duration, 6);
  json["planned_duration_s"] = analysis.test.planned_duration;
  json["ending"] = text_or_null(analysis.test.ending);
  json["control_rate_hz"] = rounded(analysis.timing.control_rate, 3);
  json["integration_step_s"] = analysis.test.integration_step;
  json["rate"] = analysis.test.rate;
  json["achieved_rate"] = analysis.timing.achieved_rate
                              ? Json(rounded(*analysis.timing.achieved_rate, 4))
                              : Json(nullptr);
  json["integration_steps"] = count_of(steps);
  json["overruns"] = total_overruns(analysis);
  json["slow_downs"] = steps.slow_downs;
  json["slow_downs_excused"] = steps.slow_downs_excused;
  json["host_late_max_ms"] = rounded(largest(analysis.hosts.late.values) * kMilli, 3);
  json["steps_excused"] = steps.excused_count;
  json["conclusive"] = is_conclusive(analysis);
  json["stated_bounds"] = Json(analysis.test.stated_bounds);
  json["broken"] = each(analysis.broken, broken_numbers);
  json["left_out"] = each(analysis.left_out, left_out_numbers);
  json["predict_ms_mean"] = mean_ms(steps.predict);
  json["correct_ms_mean"] = mean_ms(steps.correct);
  json["slow_down_ms_mean"] = mean_ms(steps.slow);
  json["axes"] = Json::object();
  for (const auto& axis : analysis.axes) json["axes"][axis.name] = axis_numbers(axis, analysis);
  json["vertical"] = vertical_numbers(analysis.vertical);
  json["beside"] = beside_numbers(analysis.beside);
  if (!analysis.structure.least.empty()) json["bearings_lifted"] = analysis.structure.lifted;
  json["floors"] = Json::object();
  for (const auto& floor : analysis.spectra.floors)
    json["floors"][floor.floor] = floor_numbers(floor, analysis.spectra.frequencies);
  json["nodes"] = Json::object();
  for (const auto& node : analysis.hosts.nodes) json["nodes"][node.name] = node_numbers(node);
  json["hops"] = each(analysis.hosts.hops, hop_numbers);
  json["drops"] = Json::object();
  for (const auto& [node, count] : analysis.hosts.drops) json["drops"][node] = count;
  json["rows_missing"] = analysis.hosts.rows_missing;
  json["operator_changes"] = each(analysis.changes, change_numbers);
  json["safety"] = each(analysis.safety, safety_numbers);
  if (const auto& elevation = analysis.test.spectrum_elevation)
    json["spectrum_elevation_m"] = *elevation;
  json["scope"] = analysis.test.scope;
  json["command"] = analysis.test.command;
  json["meta"] = analysis.test.meta;
  return json;
}

std::string verdict_of(const std::vector<Broken>& conditions) {
  if (conditions.empty()) return "";
  std::string text = "the test is not conclusive:\n";
  for (const auto& broken : conditions) text += "  " + broken.text() + "\n";
  return text;
}

std::string summary_of(const Analysis& analysis) {
  const StepAnalysis& steps = analysis.steps;
  std::string text = fmt::format(
      "{:.3f} s, {} steps, {} process{}, {} clock, {:.0f} Hz\n", analysis.timing.duration,
      count_of(steps), analysis.hosts.processes, analysis.hosts.processes == 1 ? "" : "es",
      analysis.test.clock, analysis.timing.control_rate);
  if (!analysis.hosts.real_time.empty())
    text += fmt::format(
        "in real time the host was {}: {} has that attempt, all numbers here are of "
        "the repetition in virtual time\n",
        analysis.hosts.real_time, kRealTimeFile);
  if (!steps.predict.empty())
    text += fmt::format(
        "PC      predict {:.1f} ms  correct {:.1f} ms  slow-downs {}{}\n",
        maths::mean(steps.predict) * kMilli, maths::mean(steps.correct) * kMilli, steps.slow_downs,
        steps.slow_downs_excused > 0
            ? fmt::format(" (and {} while the host was late)", steps.slow_downs_excused)
            : "");
  for (const auto& axis : analysis.axes)
    text += axis_summary(axis) + response_summary(axis.name, analysis);
  text += vertical_summary(analysis.vertical) + beside_summary(analysis.beside);
  text += rate_summary(analysis);
  text += changes_summary(analysis.changes);
  text += fmt::format("host    at most {:.2f} ms late, {} of {} steps excused, {} overruns\n",
                      largest(analysis.hosts.late.values) * kMilli, steps.excused_count,
                      count_of(steps), total_overruns(analysis));
  text += hops_summary(analysis.hosts.hops);
  text += left_out_summary(analysis.left_out);
  if (analysis.hosts.rows_missing > 0)
    text += fmt::format("record  {} rows missing: the recorder did not run at their time\n",
                        analysis.hosts.rows_missing);
  if (!analysis.test.ending.empty())
    text += fmt::format("ended at {:.3f} of {:g} s: {}\n", analysis.timing.duration,
                        analysis.test.planned_duration, analysis.test.ending);
  return text + verdict_of(analysis.broken);
}

}  // namespace rths::report
