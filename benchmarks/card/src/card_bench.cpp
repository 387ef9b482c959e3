// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/card_bench.hpp>

#include <algorithm>
#include <ctime>

#include <fmt/format.h>

#include <rths/bench/report.hpp>
#include <rths/replicated/ring.hpp>

namespace rths::bench {
namespace {

using replicated::Access;
using replicated::CardType;
using replicated::Time;

constexpr double kGoal = 2e6;
constexpr Time kRefill = std::chrono::microseconds{10};  ///< less than a FIFO lasts at 210 MB/s

struct Kind {
  const char *name, *title;
  CardType cards;
  std::uint32_t csr2, nodes, senders;
  double published;
  bool judged;
};
constexpr Kind kKinds[] = {
    {"burst", "BURST, 4 B messages", CardType::Plus, 0xC040, 256, 8, 6.5, true},
    {"burst_small", "BURST, 4 B messages, few nodes", CardType::Plus, 0xC040, 4, 1, 6.5, true},
    {"plus_256", "BURST+, blocks of 256 B", CardType::Plus, 0xD040, 16, 1, 16.2, false},
    {"plus_1024", "BURST+, blocks of 1024 B", CardType::Plus, 0xD840, 16, 1, 16.7, false},
    {"gt_4", "GT, frames of 4 B", CardType::Gt, 0, 16, 1, 33, true},
    {"gt_128", "GT, frames of 128 B", CardType::Gt, 0, 16, 1, 210, false}};

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A ring whose senders store without a pause.
class Saturated {
 public:
  explicit Saturated(const Kind& kind) : kind_{kind}, ring_{setup_of(kind)}, stored_(kind.senders) {
    for (std::uint32_t node = 0; kind.cards == CardType::Plus && node < kind.nodes; ++node) {
      ring_.card(node).write_csr(2, kind.csr2);
      ring_.card(node).write_csr(0, 0x8003);
    }
  }
  void advance() {
    const std::uint32_t stride = kind_.name == std::string{"gt_4"} ? 8 : 4;
    for (std::uint32_t i = 0; i < kind_.senders; ++i)
      while (sender(i).write(ByteOffset{stored_[i] * stride % 0x10'0000}, stored_[i]) ==
             Access::Queued)
        ++stored_[i];
    ring_.run_until(ring_.now() + kRefill);
  }
  /// Bytes that have left the transmit FIFOs.
  [[nodiscard]] double bytes() {
    double sum = 0;
    for (std::uint32_t i = 0; i < kind_.senders; ++i)
      sum += 4.0 * (stored_[i] - sender(i).report().transmit_fifo);
    return sum;
  }
  [[nodiscard]] replicated::Ring& ring() { return ring_; }

 private:
  static replicated::RingSetup setup_of(const Kind& kind) {
    replicated::RingSetup setup;
    setup.cards = kind.cards;
    for (std::uint32_t node = 0; node < kind.nodes; ++node)
      setup.nodes.push_back({.id = (node + 1) % 256});
    return setup;
  }
  replicated::Card sender(std::uint32_t i) { return ring_.card(i * (kind_.nodes / kind_.senders)); }

  const Kind& kind_;
  replicated::Ring ring_;
  std::vector<std::uint32_t> stored_;
};

CardRow measure(const Kind& kind, const CardOptions& options) {
  Saturated ring{kind};
  for (int i = 0; i < 50; ++i) ring.advance();
  const Time begun = ring.ring().now();
  const double bytes = ring.bytes();
  std::vector<double> rates;
  for (int pass = 0; pass < options.passes; ++pass) {
    const double start = thread_seconds();
    const std::uint64_t hops = ring.ring().hops();
    double passed = 0;
    for (; passed < options.seconds; passed = thread_seconds() - start) ring.advance();
    rates.push_back(static_cast<double>(ring.ring().hops() - hops) / passed);
  }
  CardRow row;
  row.name = kind.name;
  row.title = kind.title;
  row.nodes = static_cast<int>(kind.nodes);
  row.senders = static_cast<int>(kind.senders);
  row.hops_per_s = median(rates);
  row.megabytes_per_s =
      (ring.bytes() - bytes) / (replicated::to_ns(ring.ring().now() - begun) * 1e-3);
  row.published = kind.published;
  if (kind.judged) {
    row.goal = kGoal;
    row.gate_result = row.hops_per_s >= kGoal ? GateResult::Pass : GateResult::Inconclusive;
  }
  return row;
}

}  // namespace

CardReport run_card_bench(const CardOptions& options) {
  CardReport report;
  report.machine = describe_machine();
  report.passes = options.passes;
  for (const Kind& kind : kKinds) report.rows.push_back(measure(kind, options));
  report.result = worst_of(report.rows);
  return report;
}

std::string to_json(const CardReport& report) {
  Json out = {{"result", to_text(report.result)},
              {"passes", report.passes},
              {"machine", document(report.machine)},
              {"rows", Json::array()}};
  for (const auto& row : report.rows)
    out["rows"].push_back({{"name", row.name},
                           {"title", row.title},
                           {"nodes", row.nodes},
                           {"senders", row.senders},
                           {"hops_per_s", row.hops_per_s},
                           {"goal_hops_per_s", row.goal > 0 ? Json(row.goal) : Json()},
                           {"megabytes_per_s", row.megabytes_per_s},
                           {"published_megabytes_per_s", row.published},
                           {"verdict", to_text(row.gate_result)}});
  return written(1, out);
}

std::string to_text(const CardReport& report) {
  std::string out = to_text(report.machine);
  out += fmt::format("\n{:<34}{:>7}{:>9}{:>16}{:>9}{:>9}  result\n", "saturated ring", "nodes",
                     "senders", "million hops/s", "MB/s", "manual");
  for (const auto& row : report.rows)
    out += fmt::format("{:<34}{:>7}{:>9}{:>16.2f}{:>9.2f}{:>9.1f}  {}\n", row.title, row.nodes,
                       row.senders, row.hops_per_s * 1e-6, row.megabytes_per_s, row.published,
                       to_text(row.gate_result));
  return out + conclusion(report.result, {});
}

}  // namespace rths::bench
