// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/report/comparison.hpp>

namespace rths::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSettings = 30, kLongestSetting = 60;

std::string brief_text(const std::string& value) {
  if (value.empty()) return "absent";
  return value.size() <= kLongestSetting ? value : value.substr(0, kLongestSetting) + " …";
}

std::string text_of(const std::vector<ComparedSetting>& settings) {
  std::string text;
  for (std::size_t i = 0; i < std::min(settings.size(), kMostSettings); ++i)
    text += fmt::format("  {}: {} → {}\n", settings[i].key, brief_text(settings[i].baseline),
                        brief_text(settings[i].other));
  if (settings.size() > kMostSettings)
    text += fmt::format("  and {} more\n", settings.size() - kMostSettings);
  return text;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "–";
}

std::string line_of(const ComparedSignal& signal) {
  const std::string name =
      signal.name == signal.other_name ? signal.name : signal.name + " = " + signal.other_name;
  std::string line = fmt::format(
      "  {:<36} {:>9} {:>9} {:>9} {:>8}  {:>9}  {}\n", name, number(signal.peak),
      number(signal.other_peak), number(signal.rms),
      std::isfinite(signal.relative_rms) ? fmt::format("{:.3g} %", 100 * signal.relative_rms) : "–",
      signal.delay ? fmt::format("{:.2f} ms", std::round(1e5 * *signal.delay) / 100 + 0.0) : "–",
      signal.unit == "1" ? "" : signal.unit);
  if (!signal.explanation.empty()) line += fmt::format("      {}\n", signal.explanation);
  if (signal.unmatched > 0)
    line += fmt::format("      {} rows have a number in one of both alone\n", signal.unmatched);
  if (signal.broken_at)
    line += fmt::format("      outside its tolerance in {} of {} samples, first at {:.4f} s\n",
                        signal.broken_samples, signal.samples, *signal.broken_at);
  return line;
}

// How many signals have each resemblance, as the first words of a comparison.
std::string resemblances_of(const ComparedRuns& comparison) {
  std::map<Resemblance, std::size_t> counts;
  for (const auto& signal : comparison.signals)
    if (signal.resemblance != Resemblance::None) ++counts[signal.resemblance];
  std::string text;
  for (const auto& [resemblance, count] : counts)
    text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", name_of(resemblance), count);
  return text.empty() ? "" : fmt::format("likely causes, by signals: {}\n", text);
}

Json json_of(const ComparedSignal& signal) {
  const auto optional = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  return {{"signal", signal.name},
          {"other", signal.other_name},
          {"unit", signal.unit},
          {"samples", signal.samples},
          {"equal", signal.is_equal},
          {"unmatched_rows", signal.unmatched},
          {"peak", signal.peak},
          {"other_peak", signal.other_peak},
          {"rms_difference", signal.rms},
          {"relative_rms", std::isfinite(signal.relative_rms) ? Json(signal.relative_rms) : Json()},
          {"largest_difference", signal.largest},
          {"largest_difference_at_s", signal.largest_at},
          {"delay_s", optional(signal.delay)},
          {"gain", signal.gain},
          {"resemblance", name_of(signal.resemblance)},
          {"explanation", signal.explanation},
          {"broken_at_s", optional(signal.broken_at)},
          {"broken_samples", signal.broken_samples}};
}

}  // namespace

std::string text_of(const ComparedRuns& comparison, std::size_t most) {
  std::string text = fmt::format("baseline {}\nother    {}\n", comparison.baseline.string(),
                                 comparison.other.string());
  if (comparison.shift != 0)
    text += fmt::format("aligned: {:.3f} ms are removed from the times of the other\n",
                        1e3 * comparison.shift);
  if (!comparison.settings.empty())
    text += fmt::format("{} settings differ\n{}", comparison.settings.size(),
                        text_of(comparison.settings));
  const std::size_t count = comparison.signals.size(), equal = comparison.equal();
  text += fmt::format("compared from {:g} to {:g} s, of {:g} to {:g} s and {:g} to {:g} s\n",
                      comparison.from, comparison.to, comparison.baseline_times[0],
                      comparison.baseline_times[1], comparison.other_times[0],
                      comparison.other_times[1]);
  text += fmt::format("common signals: {}, equal to the last bit: {}\n", count, equal);
  text += resemblances_of(comparison);
  if (equal < count)
    text += fmt::format("  {:<36} {:>9} {:>9} {:>9} {:>8}  {:>9}  {}\n", "signal", "peak", "other",
                        "rms diff.", "of rms", "delay", "unit");
  for (std::size_t i = 0; i < std::min(count - equal, most); ++i)
    text += line_of(comparison.signals[i]);
  if (count - equal > most)
    text += fmt::format("  and {} more that differ\n", count - equal - most);
  for (const auto& [names, where] : {std::pair{&comparison.only_baseline, "the baseline"},
                                     std::pair{&comparison.only_other, "the other"}})
    if (!names->empty())
      text +=
          fmt::format("{} signals only in {}, such as {}\n", names->size(), where, names->front());
  if (comparison.is_judged)
    text +=
        fmt::format("{} of {} signals are outside their tolerance\n", comparison.broken(), count);
  return text;
}

std::string json_of(const ComparedRuns& comparison, const std::string& why) {
  Json settings = Json::array(), signals = Json::array();
  for (const auto& [key, baseline, other] : comparison.settings)
    settings.push_back({{"key", key}, {"baseline", baseline}, {"other", other}});
  for (const auto& signal : comparison.signals) signals.push_back(json_of(signal));
  return Json{{"baseline", comparison.baseline.string()},
              {"other", comparison.other.string()},
              {"from_s", comparison.from},
              {"to_s", comparison.to},
              {"baseline_times_s", comparison.baseline_times},
              {"other_times_s", comparison.other_times},
              {"shift_s", comparison.shift},
              {"settings", settings},
              {"signals", signals},
              {"only_baseline", comparison.only_baseline},
              {"only_other", comparison.only_other},
              {"equal", comparison.equal()},
              {"judged", comparison.is_judged},
              {"broken", comparison.broken()},
              {"why", why.empty() ? Json() : Json::parse(why)}}
             .dump(1) +
         "\n";
}

}  // namespace rths::report
