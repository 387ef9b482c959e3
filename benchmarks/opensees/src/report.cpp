// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/opensees_bench.hpp>

namespace rths::bench {
namespace {

using Json = nlohmann::ordered_json;

// Incremented when existing readers would misread the document.
constexpr int kFormat = 1;

Json document(const Times& times) { return {{"p50_ns", times.p50}, {"p99_ns", times.p99}}; }

}  // namespace

std::string to_json(const OpenSeesReport& report) {
  Json trips = Json::array();
  for (const auto& trip : report.trips)
    trips.push_back({{"protocol", trip.protocol},
                     {"through_ring", document(trip.through_ring)},
                     {"bare", document(trip.bare)},
                     {"ratio_p50", trip.ratio_p50},
                     {"ratio_p50_95", {trip.ratio_interval.low, trip.ratio_interval.high}},
                     {"ratio_p99", trip.ratio_p99},
                     {"at_most", kMostOfBare},
                     {"verdict", to_text(trip.gate_result)}});
  const Json document = {{"format", kFormat},
                         {"machine", Json::parse(to_json(report.machine))},
                         {"cycles", report.cycles},
                         {"round_trips", report.round_trips},
                         {"trips", trips},
                         {"steal", report.steal},
                         {"troubles", report.troubles},
                         {"result", to_text(report.result)}};
  return document.dump(2) + "\n";
}

std::string to_text(const OpenSeesReport& report) {
  std::string text = to_text(report.machine);
  text += fmt::format("\n{:<6}{:>14}{:>10}{:>14}{:>10}{:>9}{:>18}{:>9}\n", "", "ring p50 us", "p99",
                      "bare p50 us", "p99", "ratio", "95 %", "p99");
  for (const auto& trip : report.trips)
    text += fmt::format(
        "{:<6}{:>14.1f}{:>10.1f}{:>14.1f}{:>10.1f}{:>9.2f}{:>18}{:>9.2f}  {}\n", trip.protocol,
        trip.through_ring.p50 / 1e3, trip.through_ring.p99 / 1e3, trip.bare.p50 / 1e3,
        trip.bare.p99 / 1e3, trip.ratio_p50,
        fmt::format("{:.2f} to {:.2f}", trip.ratio_interval.low, trip.ratio_interval.high),
        trip.ratio_p99, to_text(trip.gate_result));
  for (const auto& trouble : report.troubles) text += trouble + "\n";
  return text + fmt::format("{}: at most {:g} times the bare ping-pong at the median\n",
                            to_text(report.result), kMostOfBare);
}

}  // namespace rths::bench
