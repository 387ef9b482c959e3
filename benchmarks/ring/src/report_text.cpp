// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/bench/report.hpp>
#include <rths/bench/ring_bench.hpp>

namespace rths::bench {
namespace {

std::string nanoseconds(double value) {
  return value < 10 ? fmt::format("{:.2f}", value) : fmt::format("{:.0f}", value);
}

std::string header(const std::string& value) {
  return fmt::format("{:<24}{:>6}{:>10}{:>10}{:>10}{:>18}{:>8}{:>10}{:>7}{:>7}  result\n", "row",
                     "bytes", "p50 [ns]", "p99 [ns]", "ratio", "95 %", "p99", value, "goal",
                     "gate");
}

std::string line(const RowResult& result) {
  const std::string start = fmt::format("{:<24}{:>6}", result.row.name, result.row.bytes);
  if (!result.missing.empty()) return fmt::format("{}  missing: {}\n", start, result.missing);
  const auto bound = [&](double Gate::*bound_of) {
    return result.row.gate ? fmt::format("{:.2f}", (*result.row.gate).*bound_of) : std::string{"-"};
  };
  return fmt::format("{}{:>10}{:>10}{:>10.2f}{:>18}{:>8.2f}{:>10.2f}{:>7}{:>7}  {}{}\n", start,
                     nanoseconds(result.times.p50), nanoseconds(result.times.p99), result.ratio_p50,
                     to_text(result.ratio_interval), result.ratio_p99, result.value,
                     bound(&Gate::goal), bound(&Gate::limit), to_text(result.gate_result),
                     result.noisy ? " (noisy)" : "");
}

std::string table(const RingReport& report, bool peers) {
  std::string out;
  for (const RowResult& result : report.rows)
    if (result.row.is_peers() == peers) out += line(result);
  if (out.empty()) return "";
  return (peers ? "\n" : "") + header(peers ? "× ours" : "value") + out;
}

}  // namespace

std::string to_text(const RingReport& report) {
  std::string out = to_text(report.machine);
  out += fmt::format(
      "{} cycles of {} round trips; raw {:.0f} ns, quartiles {:.0f} and {:.0f}; "
      "seed {}\n\n",
      report.cycles, report.round_trips, report.raw.median, report.raw.low, report.raw.high,
      report.seed);
  out += table(report, false) + table(report, true);
  return out + conclusion(report.result, report.troubles);
}

}  // namespace rths::bench
