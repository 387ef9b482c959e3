// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/bench/bearing_bench.hpp>
#include <rths/bench/report.hpp>

namespace rths::bench {
namespace {

Json document(const StepTimes& times) {
  return {{"p50_ns", times.p50},
          {"p99_ns", times.p99},
          {"p999_ns", times.p999},
          {"worst_ns", times.worst},
          {"worst_code_ns", times.worst_code}};
}

Json document(const OpenSeesTimes& times) {
  Json out = {{"element", times.element}};
  if (!times.missing.empty()) {
    out["not_measured"] = times.missing;
  } else {
    out["version"] = times.version;
    out["alone_ns"] = times.alone;
    out["further_ns"] = times.further;
  }
  return out;
}

Json document(const BearingResult& result) {
  return {{"name", result.name},
          {"title", result.title},
          {"terms", result.terms},
          {"earthquake", document(result.earthquake)},
          {"adversarial", document(result.adversarial)},
          {"dual_ratio", result.dual_ratio},
          {"one_of_486_ns", result.in_loop},
          {"goal_p50_ns", result.goal > 0 ? Json(result.goal) : Json()},
          {"verdict", to_text(result.gate_result)},
          {"opensees", document(result.opensees)}};
}

std::string line(const std::string& name, const char* motion, const StepTimes& times) {
  return fmt::format("{:<8}{:<14}{:>9.0f}{:>9.0f}{:>9.0f}{:>12.0f}{:>12.0f}", name, motion,
                     times.p50, times.p99, times.p999, times.worst_code, times.worst);
}

std::string opensees_line(const BearingResult& result) {
  const OpenSeesTimes& theirs = result.opensees;
  const std::string start = fmt::format("{:<8}{:<24}", result.name, theirs.element);
  if (!theirs.missing.empty()) return fmt::format("{}not measured: {}\n", start, theirs.missing);
  return fmt::format("{}{:>12.0f}{:>12.0f}{:>12.0f}{:>12.1f}\n", start, theirs.alone,
                     theirs.further, result.earthquake.p50, theirs.further / result.earthquake.p50);
}

}  // namespace

std::string to_json(const BearingReport& report) {
  Json out = {{"result", to_text(report.result)},
              {"troubles", report.troubles},
              {"passes", report.passes},
              {"steps", report.steps},
              {"machine", document(report.machine)},
              {"bearings", Json::array()}};
  for (const auto& result : report.bearings) out["bearings"].push_back(document(result));
  return written(1, out);
}

std::string to_text(const BearingReport& report) {
  std::string out = to_text(report.machine);
  out += fmt::format("{} passes of {} steps at 1 kHz, each step timed [ns]\n\n", report.passes,
                     report.steps);
  out += fmt::format("{:<22}{:>9}{:>9}{:>9}{:>12}{:>12}{:>8}  result\n", "bearing", "p50", "p99",
                     "p99.9", "worst code", "worst seen", "goal");
  for (const auto& result : report.bearings) {
    out += line(result.name, "earthquake", result.earthquake);
    out += fmt::format("{:>8}  {}\n", result.goal > 0 ? fmt::format("{:.0f}", result.goal) : "-",
                       to_text(result.gate_result));
    out += line("", "adversity", result.adversarial) + "\n";
    out += fmt::format("{:<8}with four derivatives {:.1f} times; one of 486 in a loop {:.0f} ns\n",
                       "", result.dual_ratio, result.in_loop);
    out += fmt::format("{:<8}{}\n", "", fmt::join(result.terms, ", "));
  }
  out += fmt::format("\n{:<32}{:>12}{:>12}{:>12}{:>12}\n", "OpenSees", "step alone", "further one",
                     "ours", "times");
  for (const auto& result : report.bearings) out += opensees_line(result);
  return out + conclusion(report.result, report.troubles);
}

}  // namespace rths::bench
