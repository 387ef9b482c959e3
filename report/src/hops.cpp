// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <rths/maths/statistics.hpp>

#include "analysis.hpp"

namespace rths::report {
namespace {

constexpr const char* kGateway = "gateway.";
constexpr const char* kDelay = "delay.";

// Without the values before the first update.
std::vector<double> measured(std::vector<double> values) {
  values.erase(std::remove(values.begin(), values.end(), 0.0), values.end());
  return values;
}

}  // namespace

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
