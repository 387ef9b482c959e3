// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/judge.hpp>

#include <algorithm>

#include <fmt/format.h>

namespace rths::bench {
namespace {

constexpr double kLargestSpread = 0.25;  // of raw: interquartile range / median [-]

bool is_paired_with_raw(const Row& row) {
  return row.quantity == Quantity::RatioToRaw || row.quantity == Quantity::TimesOurs;
}

const Pairing* pairing_in(const Cycle& cycle, const std::string& row) {
  const auto found = cycle.outcomes.find(row);
  return found != cycle.outcomes.end() && found->second.pairing ? &*found->second.pairing : nullptr;
}

double ratio(const Pairing& pairing) { return pairing.measured.p50 / pairing.reference.p50; }

// Results of a row in several cycles.
struct Series {
  std::vector<double> p50, p99, ratio_p50, ratio_p99, value;
};

// True if the reference time is plausible for an undisturbed machine.
bool is_plausible(const Row& row, const Pairing& pairing) {
  if (row.quantity == Quantity::ExtraTime) return pairing.reference.p50 <= kLongestPlainStore;
  const double raw = is_paired_with_raw(row) ? pairing.reference.p50 : pairing.raw;
  return raw == 0 || (raw >= kPlausibleRaw.low && raw <= kPlausibleRaw.high);
}

double value_of(const Row& row, const Pairing& pairing, const Pairing* ours) {
  switch (row.quantity) {
    case Quantity::RatioToRaw:
    case Quantity::RatioToOther:
      return ratio(pairing);
    case Quantity::Time:
      return pairing.measured.p50;
    case Quantity::ExtraTime:
      return pairing.measured.p50 - pairing.reference.p50;
    case Quantity::TimesCheaper:
      return pairing.reference.p50 / pairing.measured.p50;
    case Quantity::TimesOurs:
      return ratio(pairing) / ratio(*ours);
  }
  return 0;
}

Series series_of(const Row& row, const std::vector<Cycle>& cycles, bool quiet_only) {
  Series series;
  for (const Cycle& cycle : cycles) {
    const Pairing* const pairing = pairing_in(cycle, row.name);
    const Pairing* const ours = row.is_peers() ? pairing_in(cycle, row.peer->against) : pairing;
    if (pairing == nullptr || ours == nullptr) continue;
    const bool plausible =
        is_plausible(row, *pairing) && (!row.is_peers() || is_plausible(row, *ours));
    if (quiet_only && !(is_quiet(cycle.load) && plausible)) continue;
    series.p50.push_back(pairing->measured.p50);
    series.p99.push_back(pairing->measured.p99);
    series.ratio_p50.push_back(ratio(*pairing));
    series.ratio_p99.push_back(pairing->measured.p99 / pairing->reference.p99);
    series.value.push_back(value_of(row, *pairing, ours));
  }
  return series;
}

std::string why_missing(const Row& row, const std::vector<Cycle>& cycles) {
  for (const Cycle& cycle : cycles)
    for (const auto& name : {row.name, row.is_peers() ? row.peer->against : row.name})
      if (const auto found = cycle.outcomes.find(name);
          found != cycle.outcomes.end() && !found->second.missing.empty())
        return found->second.missing;
  return "was not measured";
}

GateResult gate_result_of(const RowResult& result) {
  const Row& row = result.row;
  if (!row.gate) return GateResult::NotJudged;
  if (result.noisy) return GateResult::Inconclusive;
  const bool tail_holds = !row.tail_gate || result.ratio_p99 <= row.tail_gate->limit;
  return tail_holds && holds(row.quantity, result.value, row.gate->limit) ? GateResult::Pass
                                                                          : GateResult::Fail;
}

std::string load_problem(const std::vector<Cycle>& cycles) {
  std::size_t quiet = 0;
  Load worst;
  for (const Cycle& cycle : cycles) {
    quiet += is_quiet(cycle.load) ? 1 : 0;
    worst = {std::max(worst.other, cycle.load.other), std::max(worst.steal, cycle.load.steal)};
  }
  if (2 * quiet >= cycles.size()) return "";
  return fmt::format(
      "the machine is busy: {} of {} cycles were quiet; other processes used up to {:.0f} %, the "
      "host up to {:.1f} % of the two processors",
      quiet, cycles.size(), worst.other * 100, worst.steal * 100);
}

std::string raw_problem(const RawSpread& raw) {
  if (raw.median <= 0) return "";
  if (raw.median < kPlausibleRaw.low || raw.median > kPlausibleRaw.high)
    return fmt::format("raw takes {:.0f} ns, expected {:.0f} to {:.0f}", raw.median,
                       kPlausibleRaw.low, kPlausibleRaw.high);
  if ((raw.high - raw.low) / raw.median > kLargestSpread)
    return fmt::format("raw is unstable: {:.0f} to {:.0f} ns", raw.low, raw.high);
  return "";
}

std::string missing_problem(const std::vector<RowResult>& results) {
  std::string rows;
  for (const RowResult& result : results)
    if (result.row.gate && result.gate_result == GateResult::Missing)
      rows += fmt::format("{}{} ({})", rows.empty() ? "" : ", ", result.row.name, result.missing);
  return rows.empty() ? "" : "not measured: " + rows;
}

std::string noise_problem(const std::vector<RowResult>& results) {
  std::string rows;
  for (const RowResult& result : results)
    if (result.gate_result == GateResult::Inconclusive) rows += " " + result.row.name;
  return rows.empty() ? "" : "too few quiet cycles for" + rows;
}

}  // namespace

bool holds(Quantity quantity, double value, double bound) {
  const bool at_least = quantity == Quantity::TimesCheaper || quantity == Quantity::TimesOurs;
  return at_least ? value >= bound : value <= bound;
}

RowResult judge_row(const Row& row, const std::vector<Cycle>& cycles, std::uint64_t seed) {
  RowResult result;
  result.row = row;
  Series series = series_of(row, cycles, true);
  if (series.value.size() < kFewestCycles) {
    series = series_of(row, cycles, false);
    result.noisy = true;
  }
  if (series.value.empty()) {
    result.missing = why_missing(row, cycles);
    result.gate_result = GateResult::Missing;
    return result;
  }
  result.times = {median(series.p50), median(series.p99)};
  result.ratio_p50 = median(series.ratio_p50);
  result.ratio_interval = median_interval(series.ratio_p50, seed);
  result.ratio_p99 = median(series.ratio_p99);
  result.value = median(series.value);
  result.value_interval = median_interval(series.value, seed);
  result.cycles = static_cast<int>(series.value.size());
  result.gate_result = gate_result_of(result);
  return result;
}

RawSpread raw_spread(const std::vector<Row>& rows, const std::vector<Cycle>& cycles) {
  std::vector<double> raw;
  for (const Cycle& cycle : cycles)
    for (const Row& row : rows)
      if (const Pairing* pairing = pairing_in(cycle, row.name);
          pairing != nullptr && is_paired_with_raw(row))
        raw.push_back(pairing->reference.p50);
  if (raw.empty()) return {};
  return {median(raw), quantile(raw, 0.25), quantile(raw, 0.75)};
}

std::vector<std::string> troubles(const Machine& machine, const std::vector<Cycle>& cycles,
                                  const std::vector<RowResult>& results, const RawSpread& raw) {
  if (!machine.chosen) return {kOneProcessor};
  std::vector<std::string> found;
  if (machine.chosen->siblings)
    found.push_back(fmt::format("processors {} and {} share a core", machine.chosen->cpus.near,
                                machine.chosen->cpus.far));
  if (cycles.size() < kFewestCycles)
    found.push_back(
        fmt::format("{} cycles are too few, expected at least {}", cycles.size(), kFewestCycles));
  for (const auto& more : {load_problem(cycles), raw_problem(raw), missing_problem(results)})
    if (!more.empty()) found.push_back(more);
  // Reports noisy rows only if no reason above explains them.
  if (const auto noise = noise_problem(results); found.empty() && !noise.empty())
    found.push_back(noise);
  return found;
}

GateResult overall(const std::vector<RowResult>& results,
                   const std::vector<std::string>& troubles) {
  return troubles.empty() ? worst_of(results) : GateResult::Inconclusive;
}

}  // namespace rths::bench
