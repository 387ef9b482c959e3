// SPDX-License-Identifier: Apache-2.0
//
// A picture of the ring in text.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include <rths/replicated/scenario.hpp>

namespace rths::replicated {
namespace {

struct BitName {
  int csr;
  std::uint32_t bit;
  const char* name;
};
constexpr std::array kBits{BitName{0, 0x1, "receive"},
                           BitName{0, 0x2, "transmit"},
                           BitName{0, 0x8, "host interrupts"},
                           BitName{0, 0x10, "window shows ACR"},
                           BitName{0, 0x20, "memory interrupts"},
                           BitName{0, 0x40, "all words interrupt here"},
                           BitName{0, 0x80, "error interrupts"},
                           BitName{0, 0x100, "sends interrupts"},
                           BitName{0, 0x200, "sends interrupts of all words"},
                           BitName{0, 0x400, "data filter"},
                           BitName{0, 0x800, "data filter below 4 KB"},
                           BitName{0, 0x1000, "resets transceiver FIFO"},
                           BitName{0, 0x2000, "resets interrupt FIFO"},
                           BitName{0, 0x4000, "resets transmit FIFO"},
                           BitName{0, 0x8000, "inserted"},
                           BitName{1, 0x1, "transmit FIFO full"},
                           BitName{1, 0x2, "transmit FIFO not empty"},
                           BitName{1, 0x4, "transmit FIFO at 7/8"},
                           BitName{1, 0x10, "interrupt FIFO full"},
                           BitName{1, 0x40, "no carrier"},
                           BitName{1, 0x80, "bad message"},
                           BitName{1, 0x200, "repeated after an error"},
                           BitName{1, 0x400, "repeated after a time-out"},
                           BitName{1, 0x1000, "counter overflow"},
                           BitName{1, 0x4000, "armed"},
                           BitName{1, 0x8000, "no bypass switch"},
                           BitName{2, 0x40, "no fibre loopback"},
                           BitName{2, 0x80, "wire loopback"},
                           BitName{2, 0x100, "no host writes"},
                           BitName{2, 0x200, "receives own messages"},
                           BitName{2, 0x400, "own messages interrupt"},
                           BitName{2, 0x800, "blocks of 1024 B"},
                           BitName{2, 0x1000, "blocks"},
                           BitName{2, 0x2000, "HIPRO"},
                           BitName{2, 0x4000, "multiple messages"},
                           BitName{2, 0x8000, "no error correction"},
                           BitName{8, 0x1, "id multiplexer"},
                           BitName{8, 0x2, "no holdoff"},
                           BitName{8, 0x200, "free-running counter"},
                           BitName{8, 0x400, "every message interrupts"},
                           BitName{8, 0x800, "no switch loopback"},
                           BitName{12, 0x1, "virtual paging"}};

constexpr std::size_t kNodesPerLine = 4;

std::string bar(std::uint32_t level, std::uint32_t capacity) {
  constexpr std::uint32_t kCells = 20;
  const std::uint32_t full = std::min(kCells, (level * kCells + capacity - 1) / capacity);
  return "[" + std::string(full, '#') + std::string(kCells - full, '.') +
         fmt::format("] {} of {}", level, capacity);
}

std::string picture(const Scenario& scenario) {
  std::string out;
  for (std::size_t node = 0; node < scenario.names.size(); ++node) {
    if (node % kNodesPerLine == 0) out += node == 0 ? "  " : "\n  -> ";
    out += fmt::format("{} --{:g} m--> ", scenario.names[node], scenario.setup.nodes[node].fibre_m);
  }
  return out + scenario.names[0] + "\n";
}

std::string registers(Card card) {
  std::string out;
  for (const int csr : {0, 1, 2, 8}) {
    out += csr_line(csr, card.peek_csr(csr));
  }
  const std::uint32_t ids = card.peek_csr(3);
  out += fmt::format("  CSR3 {:04x}  id {}, ", ids, ids >> 8);
  const std::uint32_t ring_nodes = card.report().ring_nodes;
  return out + (ring_nodes == 0 ? "ring not measured yet\n"
                                : fmt::format("ring of {} nodes\n", ring_nodes));
}

std::string levels(const CardReport& report, std::uint32_t interrupts) {
  std::string out =
      fmt::format("  transmit FIFO       {}\n  interrupt FIFO      {}\n",
                  bar(report.transmit_fifo, 1024), bar(report.interrupt_fifo, interrupts));
  out += fmt::format("  insertion register  {} messages", report.waiting);
  if (report.waiting != 0) out += fmt::format(", greatest age {}", report.oldest_age);
  out += fmt::format(
      "\n  messages            sent {}, repeated {}, passed {}, stored {}, rejected {}\n",
      report.sent, report.repeated, report.passed, report.stored, report.rejected);
  if (report.passed != 0)
    out += fmt::format("  greatest delay      {:.0f} ns\n", to_ns(report.longest_delay));
  if (report.same_id != 0)
    out += fmt::format("  messages of other nodes with this id: {}\n", report.same_id);
  if (report.host_interrupts != 0 || report.lost_interrupts != 0)
    out += fmt::format("  interrupts          {} to the host, {} lost\n", report.host_interrupts,
                       report.lost_interrupts);
  return out;
}

}  // namespace

std::string csr_line(int index, std::uint32_t value) {
  std::string words;
  for (const auto& one : kBits)
    if (one.csr == index && (value & one.bit) != 0)
      words += (words.empty() ? "" : ", ") + std::string{one.name};
  return fmt::format("  CSR{} {:04x}  {}\n", index, value, words.empty() ? "-" : words);
}

std::string show(Course& course) {
  const Scenario& scenario = course.scenario();
  Ring& ring = course.ring();
  const bool plus = scenario.setup.cards == CardType::Plus;
  std::string out =
      fmt::format("{:.3f} µs, {} {} cards, {} hops, seed {}\n\n{}", to_ns(ring.now()) * 1e-3,
                  scenario.names.size(), plus ? "SCRAMNet+" : "GT", ring.hops(),
                  scenario.setup.seed, picture(scenario));
  if (course.stalls() != 0)
    out += fmt::format("\n{} stores of the hosts were held off\n", course.stalls());
  for (std::uint32_t node = 0; node < ring.nodes(); ++node) {
    Card card = ring.card(node);
    out += fmt::format("\n{}\n", scenario.names[node]);
    if (!card.report().powered)
      out += "  no power\n";
    else if (plus)
      out += registers(card);
    else
      out += fmt::format("  id {}, ring of {} nodes\n", card.gt_state(0), card.gt_state(8));
    out += levels(card.report(), plus ? 1024 : 256);
  }
  return out;
}

}  // namespace rths::replicated
