// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/controller/predictor_corrector.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/report/judgement.hpp>

#include "analysis.hpp"
#include "conditions.hpp"
#include "numbers.hpp"

namespace rths::report {
namespace {

constexpr double kMemory = 0.5;  // before a trip: longer than the answer of any machine [s]

std::vector<std::string> signals_ending_in(const Reader& run, const std::string& end) {
  std::vector<std::string> found;
  for (const auto& name : run.names())
    if (name.starts_with("monitor.") && name.ends_with(end)) found.push_back(name);
  return found;
}

std::string node_of(const std::string& signal, const std::string& end) {
  constexpr std::size_t kPrefix = std::string_view{"monitor."}.size();
  return signal.substr(kPrefix, signal.size() - kPrefix - end.size());
}

/// Rows of the time before a trip.
struct RowsBeforeTrip {
  std::size_t begin, end;
};

RowsBeforeTrip rows_before(const Reader& run, double time) {
  const auto& times = run.time();
  const auto begin = std::ranges::lower_bound(times, time - kMemory);
  const auto end = std::upper_bound(begin, times.end(), time);
  return {static_cast<std::size_t>(begin - times.begin()),
          static_cast<std::size_t>(end - times.begin())};
}

// The node that was latest, by a control period or more.
std::string latest_node(const Reader& run, const RowsBeforeTrip& rows, double period) {
  const std::string end = ".host.late";
  std::string text;
  double most = 0;
  for (const auto& signal : signals_ending_in(run, end)) {
    const auto late = run.signal(signal);
    for (std::size_t i = rows.begin; i < rows.end; ++i) {
      if (!(late[i] >= period && late[i] > most)) continue;
      most = late[i];
      text = fmt::format("{} was {:.1f} ms late at {:.3f} s", node_of(signal, end), most * kMilli,
                         run.time()[i]);
    }
  }
  return text;
}

std::string late_target(const Reader& run, const RowsBeforeTrip& rows) {
  const std::string signal = recording::roles_of(run).monitor_of_controller() + "pc.state";
  if (!run.has(signal)) return "";
  const auto state = run.signal(signal);
  for (std::size_t i = rows.begin; i < rows.end; ++i)
    if (state[i] == static_cast<double>(controller::PcState::AutoSlowDown))
      return fmt::format("a target was late at {:.3f} s", run.time()[i]);
  return "";
}

constexpr const char* kGateway = "gateway.";
constexpr const char* kDelay = "delay.";

// Without the values before the first update.
std::vector<double> measured(std::vector<double> values) {
  values.erase(std::remove(values.begin(), values.end(), 0.0), values.end());
  return values;
}

}  // namespace

std::string lateness_before(const Reader& run, double time) {
  const RowsBeforeTrip rows = rows_before(run, time);
  const std::string node = latest_node(run, rows, lateness_of(run).period);
  return node.empty() ? late_target(run, rows) : node;
}

std::string lateness_before_trip(const Reader& run) {
  const Break trip = safety_of(run);
  return trip ? lateness_before(run, trip->time) : "";
}

std::string late_host_in(const Reader& run) {
  const RecordedLateness host = lateness_of(run);
  const auto& late = host.late.values;
  double most = 0;
  std::size_t count = 0;
  for (const double value : late) {
    most = std::max(most, value);
    count += value >= host.period ? 1 : 0;
  }
  for (const auto& signal : signals_ending_in(run, ".host.late_max"))
    for (const double value : run.signal(signal)) most = std::max(most, value);
  if (!(most >= host.period)) return "";
  return fmt::format(
      "up to {:.0f} ms late, in {:.1f} % of the time by {:g} ms or more", most * kMilli,
      late.empty() ? 0 : 100.0 * static_cast<double>(count) / static_cast<double>(late.size()),
      host.period * kMilli);
}

std::string host_of_gateway(const std::string& partition) {
  return partition.starts_with(kGateway) ? partition.substr(std::string{kGateway}.size()) : "";
}

std::vector<HopAnalysis> analyse_hops(const Reader& run) {
  std::vector<HopAnalysis> hops;
  for (const auto& entry : run.map().signals()) {
    const std::string host = host_of_gateway(entry.partition->name);
    const std::string& name = entry.signal->name;
    if (host.empty() || !name.starts_with(kDelay) || !run.has(entry.name)) continue;
    const auto delays = measured(run.signal(entry.name));
    if (delays.empty()) continue;
    HopAnalysis hop;
    hop.from = name.substr(std::string{kDelay}.size());
    hop.to = host;
    hop.delay_p50 = maths::quantile(delays, 0.50);
    hop.delay_p99 = maths::quantile(delays, 0.99);
    hop.delay_max = maths::quantile(delays, 1);
    if (const auto age = kGateway + host + ".age." + hop.from; run.has(age)) {
      const auto ages = measured(run.signal(age));
      hop.age_p99 = maths::quantile(ages, 0.99);
      hop.age_max = maths::quantile(ages, 1);
    }
    hops.push_back(std::move(hop));
  }
  return hops;
}

}  // namespace rths::report
