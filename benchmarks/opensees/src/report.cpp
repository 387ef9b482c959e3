// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/bench/opensees_bench.hpp>
#include <rths/bench/report.hpp>

namespace rths::bench {

std::string to_json(const OpenSeesReport& report) {
  Json trips = Json::array();
  for (const auto& trip : report.trips)
    trips.push_back({{"protocol", trip.protocol},
                     {"through_ring", document(trip.through_ring)},
                     {"bare", document(trip.bare)},
                     {"ratio_p50", trip.ratio_p50},
                     {"ratio_p50_95", document(trip.ratio_interval)},
                     {"ratio_p99", trip.ratio_p99},
                     {"at_most", kMostOfBare},
                     {"verdict", to_text(trip.gate_result)}});
  const Json fields = {{"machine", document(report.machine)},
                       {"cycles", report.cycles},
                       {"round_trips", report.round_trips},
                       {"trips", trips},
                       {"steal", report.steal},
                       {"troubles", report.troubles},
                       {"result", to_text(report.result)}};
  return written(1, fields);
}

std::string to_text(const OpenSeesReport& report) {
  std::string text = to_text(report.machine);
  text += fmt::format("\n{:<6}{:>14}{:>10}{:>14}{:>10}{:>9}{:>18}{:>9}\n", "", "ring p50 us", "p99",
                      "bare p50 us", "p99", "ratio", "95 %", "p99");
  for (const auto& trip : report.trips)
    text += fmt::format("{:<6}{:>14.1f}{:>10.1f}{:>14.1f}{:>10.1f}{:>9.2f}{:>18}{:>9.2f}  {}\n",
                        trip.protocol, trip.through_ring.p50 / 1e3, trip.through_ring.p99 / 1e3,
                        trip.bare.p50 / 1e3, trip.bare.p99 / 1e3, trip.ratio_p50,
                        to_text(trip.ratio_interval), trip.ratio_p99, to_text(trip.gate_result));
  text += fmt::format("gate: at most {:g} times the bare ping-pong at the median\n", kMostOfBare);
  return text + conclusion(report.result, report.troubles);
}

}  // namespace rths::bench
