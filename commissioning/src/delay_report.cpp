// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/delay_report.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/commissioning/recorded.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::commissioning {
namespace {

using Json = nlohmann::ordered_json;
using Signal = std::span<const double>;

constexpr double kLeastWindowShare = 0.05;  // of the largest target: quieter windows are left out

WindowTracking track_window(Signal target, Signal measured, double begin, double interval,
                            double search) {
  WindowTracking window;
  window.begin = begin;
  window.fit = maths::fit_delay(target, measured, interval, search);
  window.nearest = maths::fit_delay(target, measured, interval, search, maths::Gain::Fixed);
  window.index = maths::frequency_index(target, measured, interval, window.fit.delay);
  window.error = maths::tracking_error(target, measured);
  return window;
}

struct Pair {
  std::string axis, target, measured;
};

std::vector<Pair> pairs_of(const recording::Reader& run, const DelayQuestion& question) {
  const bool roles = is_axis_role(question.target), others = is_axis_role(question.measured);
  if (!roles && !others) return {{"", question.target, question.measured}};
  if (roles != others)
    throw Error{fmt::format(
        "'{}' is a role of an axis and '{}' is not, expected two roles or two "
        "signals",
        roles ? question.target : question.measured, roles ? question.measured : question.target)};
  std::vector<Pair> pairs;
  for (const auto& axis : recording::roles_of(run).axes)
    pairs.push_back(
        {axis.axis, signal_of(axis, question.target), signal_of(axis, question.measured)});
  return pairs;
}

PairTracking track_pair(const recording::Reader& run, const Pair& names,
                        const DelayQuestion& question) {
  const Recorded data = recorded(run, {names.target, names.measured});
  const Signal target{data.values[0]}, measured{data.values[1]};
  if (run.unit(names.target) != run.unit(names.measured))
    throw Error{fmt::format("'{}' is in {} and '{}' in {}, expected one unit", names.target,
                            run.unit(names.target), names.measured, run.unit(names.measured))};
  const double motion = maths::deviation(target);
  if (!(motion >= question.least_rms))
    throw Error{
        fmt::format("'{}' moves too little for a delay: {:.3g} {} RMS, expected at least {:g}",
                    names.target, motion, run.unit(names.target), question.least_rms)};
  PairTracking pair;
  pair.axis = names.axis;
  pair.target = names.target;
  pair.measured = names.measured;
  pair.whole = track_window(target, measured, data.begin, data.interval, question.search);
  const double largest = maths::largest_magnitude(target);
  const auto length = static_cast<std::size_t>(std::llround(question.window / data.interval));
  // A delay beyond a quarter of a window cannot be found in it.
  const double search = std::min(question.search, 0.2 * question.window);
  for (const auto& window : maths::moving_windows(
           target, length, std::max(question.least_rms, kLeastWindowShare * largest)))
    pair.windows.push_back(track_window(
        target.subspan(window.begin, window.length), measured.subspan(window.begin, window.length),
        data.begin + static_cast<double>(window.begin) * data.interval, data.interval, search));
  pair.bands =
      maths::track_bands(data.values[0], data.values[1], data.interval, pair.whole.fit.delay);
  return pair;
}

Json json_of(const WindowTracking& window) {
  Json json;
  json["begin_s"] = window.begin;
  json["delay_ms"] = 1e3 * window.fit.delay;
  json["delay_95_ms"] = 1e3 * window.fit.delay_95;
  json["gain"] = window.fit.gain;
  json["gain_95"] = window.fit.gain_95;
  json["minimum_rms_delay_ms"] = 1e3 * window.nearest.delay;
  json["minimum_rms_delay_95_ms"] = 1e3 * window.nearest.delay_95;
  json["index_delay_ms"] = 1e3 * window.index.delay;
  json["index_delay_95_ms"] = 1e3 * window.index.delay_95;
  json["index_amplitude"] = window.index.amplitude;
  json["index_amplitude_95"] = window.index.amplitude_95;
  json["index_frequency_Hz"] = window.index.frequency;
  json["nrms_percent"] = 1e2 * window.error.nrms;
  json["peak_percent"] = 1e2 * window.error.peak;
  return json;
}

Json json_of(const maths::BandTracking& band) {
  Json json{{"from_Hz", band.from}, {"to_Hz", band.to}, {"nrms_percent", 1e2 * band.nrms}};
  json["gain"] = band.response ? Json(band.response->gain) : Json();
  json["delay_ms"] = band.response ? Json(1e3 * band.response->delay) : Json();
  json["coherence"] = band.response ? Json(band.response->coherence) : Json();
  return json;
}

std::string row_of(const std::string& name, const WindowTracking& window) {
  return fmt::format(
      "  {:<8}{:8.2f} ± {:<6.2f}{:8.4f} ± {:<7.4f}{:8.2f} ± {:<6.2f}{:8.2f} ± "
      "{:<6.2f}{:8.4f}{:7.2f}"
      "{:8.2f}\n",
      name, 1e3 * window.fit.delay, 1e3 * window.fit.delay_95, window.fit.gain, window.fit.gain_95,
      1e3 * window.nearest.delay, 1e3 * window.nearest.delay_95, 1e3 * window.index.delay,
      1e3 * window.index.delay_95, window.index.amplitude, window.index.frequency,
      1e2 * window.error.nrms);
}

}  // namespace

double PairTracking::median_delay() const {
  std::vector<double> delays;
  for (const auto& window : windows) delays.push_back(window.fit.delay);
  if (delays.empty()) return whole.fit.delay;
  return maths::median(std::move(delays));
}

double PairTracking::largest_delay() const {
  double largest = windows.empty() ? whole.fit.delay : 0;
  for (const auto& window : windows)
    if (std::abs(window.fit.delay) > std::abs(largest)) largest = window.fit.delay;
  return largest;
}

std::vector<PairTracking> track(const recording::Reader& run, const DelayQuestion& question) {
  std::vector<PairTracking> pairs;
  for (const auto& names : pairs_of(run, question))
    pairs.push_back(track_pair(run, names, question));
  return pairs;
}

std::string text_of(const std::vector<PairTracking>& pairs) {
  std::string text;
  for (const auto& pair : pairs) {
    text += fmt::format("{}{}{} behind {}; 95 % intervals\n", pair.axis,
                        pair.axis.empty() ? "" : ": ", pair.measured, pair.target);
    text +=
        "           delay ms           gain              minimum RMS ms   index ms         ampl.   "
        "  "
        "Hz  NRMS %\n";
    text += row_of("whole", pair.whole);
    for (const auto& window : pair.windows)
      text += row_of(fmt::format("{:.2f} s", window.begin), window);
    if (!pair.windows.empty())
      text +=
          fmt::format("  {} windows: median {:.2f} ms, largest {:.2f} ms\n", pair.windows.size(),
                      1e3 * pair.median_delay(), 1e3 * pair.largest_delay());
    text += "  band Hz      amplitude   delay ms   coherence   NRMS %\n";
    for (const auto& band : pair.bands) {
      text += fmt::format("  {:4g}–{:<6g}", band.from, band.to);
      text += band.response ? fmt::format("{:11.4f}{:11.2f}{:12.3f}", band.response->gain,
                                          1e3 * band.response->delay, band.response->coherence)
                            : fmt::format("{:>11}{:>11}{:>12}", "–", "–", "–");
      text += fmt::format("{:9.3f}\n", 1e2 * band.nrms);
    }
  }
  return text;
}

std::string json_of(const std::vector<PairTracking>& pairs) {
  Json document = Json::array();
  for (const auto& pair : pairs) {
    Json json;
    if (!pair.axis.empty()) json["axis"] = pair.axis;
    json["target"] = pair.target;
    json["measured"] = pair.measured;
    json["whole"] = json_of(pair.whole);
    json["median_delay_ms"] = 1e3 * pair.median_delay();
    json["largest_delay_ms"] = 1e3 * pair.largest_delay();
    json["windows"] = Json::array();
    for (const auto& window : pair.windows) json["windows"].push_back(json_of(window));
    json["bands"] = Json::array();
    for (const auto& band : pair.bands) json["bands"].push_back(json_of(band));
    document.push_back(json);
  }
  return Json{{"pairs", document}}.dump(2) + "\n";
}

}  // namespace rths::commissioning
