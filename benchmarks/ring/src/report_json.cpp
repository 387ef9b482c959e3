// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/report.hpp>
#include <rths/bench/ring_bench.hpp>

namespace rths::bench {
namespace {

const char* name_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::RatioToRaw:
      return "ratio_to_raw";
    case Quantity::RatioToOther:
      return "ratio";
    case Quantity::Time:
      return "ns";
    case Quantity::ExtraTime:
      return "extra_ns";
    case Quantity::TimesCheaper:
      return "times_cheaper";
    case Quantity::TimesOurs:
      return "times_ours";
  }
  return "unknown";
}

void add_gate(Json& out, const std::string& suffix, const std::optional<Gate>& gate) {
  out["goal" + suffix] = gate ? Json(gate->goal) : Json();
  out["gate" + suffix] = gate ? Json(gate->limit) : Json();
}

Json document(const RowResult& result) {
  Json out = {
      {"name", result.row.name}, {"bytes", result.row.bytes}, {"what", result.row.description}};
  if (result.row.is_peers()) out["against"] = result.row.peer->against;
  if (!result.missing.empty()) {
    out["missing"] = result.missing;
  } else {
    out["p50_ns"] = result.times.p50;
    out["p99_ns"] = result.times.p99;
    out["ratio_p50"] = result.ratio_p50;
    out["ratio_p50_95"] = document(result.ratio_interval);
    out["ratio_p99"] = result.ratio_p99;
    out["quantity"] = name_of(result.row.quantity);
    out["value"] = result.value;
    out["value_95"] = document(result.value_interval);
    out["cycles"] = result.cycles;
    out["noisy"] = result.noisy;
  }
  add_gate(out, "", result.row.gate);
  add_gate(out, "_p99", result.row.tail_gate);
  out["verdict"] = to_text(result.gate_result);
  return out;
}

}  // namespace

std::string to_json(const RingReport& report) {
  Json out = {{"result", to_text(report.result)},
              {"troubles", report.troubles},
              {"cycles", report.cycles},
              {"round_trips", report.round_trips},
              {"seed", report.seed},
              {"machine", document(report.machine)},
              {"raw_ns",
               {{"median", report.raw.median},
                {"lower_quartile", report.raw.low},
                {"upper_quartile", report.raw.high}}},
              {"rows", Json::array()},
              {"peers", Json::array()}};
  for (const RowResult& result : report.rows)
    out[result.row.is_peers() ? "peers" : "rows"].push_back(document(result));
  return written(1, out);
}

}  // namespace rths::bench
