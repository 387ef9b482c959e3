// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/report.hpp>

#include <fmt/format.h>

#include <rths/core/text.hpp>

namespace rths::bench {

Json document(const Machine& machine) {
  Json out = {{"cpu", machine.cpu},
              {"processors", machine.processors},
              {"kernel", machine.kernel},
              {"hypervisor", machine.hypervisor},
              {"huge_pages", machine.huge_pages},
              {"used", Json::array()},
              {"smt_siblings", machine.chosen && machine.chosen->siblings}};
  if (machine.chosen) out["used"] = {machine.chosen->cpus.near, machine.chosen->cpus.far};
  return out;
}

Json document(const Times& times) { return {{"p50_ns", times.p50}, {"p99_ns", times.p99}}; }

Json document(const Interval& interval) { return {interval.low, interval.high}; }

std::string written(int format, const Json& fields) {
  Json whole = {{"format", format}};
  whole.update(fields);
  return whole.dump(2) + "\n";
}

std::string to_text(const Machine& machine) {
  const std::string used =
      machine.chosen
          ? fmt::format("{} and {}{}", machine.chosen->cpus.near, machine.chosen->cpus.far,
                        machine.chosen->siblings ? ", siblings of one core" : "")
          : "none";
  return fmt::format("{}, {} processors, used: {}; kernel {}{}\nhuge pages: {}\n", machine.cpu,
                     machine.processors, used, machine.kernel,
                     machine.hypervisor ? ", a guest" : "", machine.huge_pages);
}

std::string to_text(const Interval& interval) {
  return fmt::format("{:.2f} to {:.2f}", interval.low, interval.high);
}

const char* to_text(GateResult result) noexcept {
  switch (result) {
    case GateResult::Pass:
      return "pass";
    case GateResult::Fail:
      return "fail";
    case GateResult::Inconclusive:
      return "inconclusive";
    case GateResult::NotJudged:
      return "not judged";
    case GateResult::Missing:
      return "missing";
  }
  return "unknown";
}

std::string conclusion(GateResult result, const std::vector<std::string>& troubles) {
  std::string text = "\n";
  for (const char* c = to_text(result); *c != '\0'; ++c) text += upper(*c);
  text += "\n";
  for (const auto& trouble : troubles) text += "  " + trouble + "\n";
  return text;
}

}  // namespace rths::bench
