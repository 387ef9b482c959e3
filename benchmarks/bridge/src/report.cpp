// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/bench/bridge_bench.hpp>
#include <rths/bench/report.hpp>

namespace rths::bench {

std::string to_json(const BridgeReport& r) {
  const Json updates = {{"name", "updates"},
                        {"updates_per_s", r.updates_per_s},
                        {"samples_per_s", r.samples_per_s},
                        {"updates_ratio", r.updates_ratio},
                        {"updates_per_frame", r.updates_per_frame},
                        {"goal", kUpdatesGoal},
                        {"gate", kUpdatesGate},
                        {"lost", r.lost},
                        {"reordered", r.reordered}};
  const Json latency = {{"name", "latency"},
                        {"through_ring", document(r.latency)},
                        {"bare", document(r.bare_latency)},
                        {"latency_ratio_p50", r.latency_ratio_p50},
                        {"latency_ratio_p50_95", document(r.latency_ratio_interval)},
                        {"goal", kLatencyGoal},
                        {"gate", kLatencyGate}};
  const Json resync = {{"name", "resync"},
                       {"seconds", r.resync_s},
                       {"bare_bytes_per_s", r.bare_bytes_per_s},
                       {"resync_ratio", r.resync_ratio},
                       {"goal", kResyncGoal}};
  const Json load = {{"name", "load"}, {"near_share", r.near_share}, {"far_share", r.far_share}};
  const Json whole = {{"machine", document(r.machine)},
                      {"cycles", r.cycles},
                      {"rows", {updates, latency, resync, load}},
                      {"steal", r.steal},
                      {"troubles", r.troubles},
                      {"result", to_text(r.result)}};
  return written(1, whole);
}

std::string to_text(const BridgeReport& r) {
  std::string text = to_text(r.machine);
  text += fmt::format(
      "\nupdates  {:.2f} million/s, bare samples {:.3f} million/s: {:.0f} times (goal {:g}, gate "
      "{:g})\n"
      "         {} lost, {} reordered, {:.0f} updates per frame\n",
      1e-6 * r.updates_per_s, 1e-6 * r.samples_per_s, r.updates_ratio, kUpdatesGoal, kUpdatesGate,
      r.lost, r.reordered, r.updates_per_frame);
  text += fmt::format(
      "latency  {:.1f} us (p99 {:.1f}), bare {:.1f} us (p99 {:.1f}): {:.2f} times, 95 % {} "
      "(goal {:g}, gate {:g})\n",
      r.latency.p50 / 1e3, r.latency.p99 / 1e3, r.bare_latency.p50 / 1e3, r.bare_latency.p99 / 1e3,
      r.latency_ratio_p50, to_text(r.latency_ratio_interval), kLatencyGoal, kLatencyGate);
  text += fmt::format(
      "resync   8 MiB in {:.1f} ms, bare samples {:.0f} MB/s: {:.2f} times (goal {:g})\n"
      "load     at 1 kHz and 100 words: {:.1f} % of a processor sends, {:.1f} % receives\n",
      1e3 * r.resync_s, 1e-6 * r.bare_bytes_per_s, r.resync_ratio, kResyncGoal, 100 * r.near_share,
      100 * r.far_share);
  return text + conclusion(r.result, r.troubles);
}

}  // namespace rths::bench
