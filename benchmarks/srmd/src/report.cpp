// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <rths/bench/report.hpp>
#include <rths/bench/srmd_bench.hpp>

namespace rths::bench {
namespace {

constexpr double kMs = 1e3;
constexpr double kPercent = 100;

// Figures of the paper (Sarebanha et al. 2019).
constexpr const char* kPublished =
    "raw delay about 60 ms; with feed-forward and ATS 6.3 ms (long), 3.8 ms (lat); "
    "normalised RMS below 1 %; a0 mostly below 1; a1 from 0 to 60 ms";

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double largest_magnitude(const std::vector<double>& values) {
  double found = 0;
  for (const double value : values) found = std::max(found, std::abs(value));
  return found;
}

double rounded(double value, double scale) { return std::round(value * scale) / scale; }

/// The same figure of many tests.
struct Spread {
  std::vector<double> values;
  [[nodiscard]] Json document() const {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {{"mean", rounded(mean(values), 100)},
            {"lowest", rounded(*low, 100)},
            {"highest", rounded(*high, 100)}};
  }
};

Json document(const SrmdAxis& axis) {
  return {{"axis", axis.name},
          {"largest_command_mm", rounded(axis.largest * kMs, 10)},
          {"raw_delay_ms", rounded(axis.raw_delay * kMs, 100)},
          {"delay_ms", rounded(axis.delay * kMs, 100)},
          {"delay_windows_mean_ms", rounded(mean(axis.windows) * kMs, 100)},
          {"delay_windows_largest_ms", rounded(largest_magnitude(axis.windows) * kMs, 100)},
          {"windows", axis.windows.size()},
          {"nrms_percent", rounded(axis.nrms * kPercent, 1000)},
          {"peak_percent", rounded(axis.peak * kPercent, 100)},
          {"feed_forward_overshoot_percent", rounded(axis.feed_forward_overshoot * kPercent, 100)},
          {"share_a0_below_1", rounded(axis.share_a0_below_1, 1000)},
          {"lowest_a1_ms", rounded(axis.lowest_a1 * kMs, 10)},
          {"highest_a1_ms", rounded(axis.highest_a1 * kMs, 10)}};
}

Json document(const SrmdTest& test) {
  Json out = {{"controller", test.controller},
              {"stable", test.stable},
              {"limit_periods", test.limit_periods}};
  if (!test.stable) return out;
  out["floor_error_percent"] = rounded(test.floor_error * kPercent, 10);
  out["axes"] = Json::array();
  for (const auto& axis : test.axes) out["axes"].push_back(document(axis));
  return out;
}

/// Of one record and controller, over the family without the nominal machine.
struct Family {
  int tests = 0, unstable = 0;
  std::map<std::string, Spread> spreads;
  void add(const SrmdTest& test) {
    ++tests;
    if (!test.stable) {
      ++unstable;
      return;
    }
    spreads["floor_error_percent"].values.push_back(test.floor_error * kPercent);
    for (const auto& axis : test.axes) {
      const std::string at = axis.name + ".";
      spreads[at + "raw_delay_ms"].values.push_back(axis.raw_delay * kMs);
      spreads[at + "delay_ms"].values.push_back(axis.delay * kMs);
      spreads[at + "delay_windows_largest_ms"].values.push_back(largest_magnitude(axis.windows) *
                                                                kMs);
      spreads[at + "nrms_percent"].values.push_back(axis.nrms * kPercent);
      spreads[at + "peak_percent"].values.push_back(axis.peak * kPercent);
    }
  }
};

std::map<std::string, Family> families(const SrmdReport& report) {
  std::map<std::string, Family> found;
  for (const auto& row : report.rows)
    if (row.member != 0)
      for (const auto& test : row.tests) found[row.record + ", " + test.controller].add(test);
  return found;
}

std::string line(const SrmdAxis& axis) {
  return fmt::format("  {:<5}{:>8.1f}{:>8.1f}{:>8.2f}{:>10.2f}{:>10.2f}{:>8.2f}{:>8.2f}\n",
                     axis.name, axis.largest * kMs, axis.raw_delay * kMs, axis.delay * kMs,
                     mean(axis.windows) * kMs, largest_magnitude(axis.windows) * kMs,
                     axis.nrms * kPercent, axis.peak * kPercent);
}

}  // namespace

std::string to_json(const SrmdReport& report) {
  Json out = {{"machine", document(report.host)},
              {"draws", report.options.draws},
              {"records", report.options.records},
              {"duration_s", report.options.duration},
              {"published", kPublished},
              {"step_us",
               {{"p50", rounded(report.step_p50 * 1e6, 10)},
                {"p99", rounded(report.step_p99 * 1e6, 10)},
                {"worst", rounded(report.step_worst * 1e6, 10)}}},
              {"nominal", Json::object()},
              {"family", Json::object()},
              {"rows", Json::array()}};
  for (const auto& row : report.rows) {
    Json tests = Json::array();
    for (const auto& test : row.tests) tests.push_back(document(test));
    if (row.member == 0) out["nominal"][row.record] = tests;
    out["rows"].push_back({{"member", row.member}, {"record", row.record}, {"tests", tests}});
  }
  for (const auto& [name, family] : families(report)) {
    Json& entry = out["family"][name];
    entry = {{"tests", family.tests}, {"unstable", family.unstable}};
    for (const auto& [figure, spread] : family.spreads) entry[figure] = spread.document();
  }
  return written(1, out);
}

std::string to_text(const SrmdReport& report) {
  std::string out = to_text(report.host);
  out += fmt::format("published: {}\n\n", kPublished);
  out += fmt::format("nominal machine{:>6}{:>8}{:>8}{:>10}{:>10}{:>8}{:>8}\n", "max", "raw",
                     "delay", "windows", "largest", "NRMS", "peak");
  out += fmt::format("{:>21}{:>8}{:>8}{:>10}{:>10}{:>8}{:>8}\n", "mm", "ms", "ms", "ms", "ms", "%",
                     "%");
  for (const auto& row : report.rows) {
    if (row.member != 0) continue;
    for (const auto& test : row.tests) {
      out += fmt::format("{}, {}: {}\n", row.record, test.controller,
                         test.stable ? fmt::format("floor spectra at 6 to 11 Hz {:.0f} % off",
                                                   test.floor_error * kPercent)
                                     : "unstable");
      for (const auto& axis : test.axes) out += line(axis);
    }
  }
  for (const auto& [name, family] : families(report)) {
    out += fmt::format("\n{}: {} machines, {} unstable\n", name, family.tests, family.unstable);
    for (const auto& [figure, spread] : family.spreads) {
      const auto [low, high] = std::minmax_element(spread.values.begin(), spread.values.end());
      out += fmt::format("  {:<32}mean {:>8.2f}, {:.2f} to {:.2f}\n", figure, mean(spread.values),
                         *low, *high);
    }
  }
  out +=
      fmt::format("\nstep of the machine (1 ms): p50 {:.1f} us, p99 {:.1f} us, worst {:.1f} us\n",
                  report.step_p50 * 1e6, report.step_p99 * 1e6, report.step_worst * 1e6);
  return out;
}

}  // namespace rths::bench
