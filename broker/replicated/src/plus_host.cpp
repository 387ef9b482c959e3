// SPDX-License-Identifier: Apache-2.0
//
// The host's side of a SCRAMNet+ card: stores, registers, ACR.
#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/registers.hpp>

#include "engine.hpp"

namespace rths::replicated {

using namespace scramnet;

namespace {

constexpr std::uint32_t kLowMemory = 0x1000;  // [B], see CSR0.11
constexpr std::uint8_t kAllBytes = 0xF;

std::uint32_t merged(std::uint32_t before, std::uint32_t value, std::uint32_t offset,
                     std::uint32_t bytes) {
  if (bytes == 4) return value;
  const std::uint32_t shift = offset % 4 * 8;
  const std::uint32_t mask = ((1U << 8 * bytes) - 1) << shift;
  return (before & ~mask) | (value << shift & mask);
}

bool filters(const Registers& csr, std::uint32_t offset) {
  return csr.all_set(0, csr0::kFilter) &&
         (offset >= kLowMemory || csr.all_set(0, csr0::kFilterAlsoLow));
}

// Flags of CSR1 for the level of a FIFO.
std::uint32_t level_flags(const TransmitFifo& fifo) {
  return (fifo.size() >= TransmitFifo::kSevenEighths ? csr1::kTransmitFifoSevenEighths : 0U) |
         (fifo.size() >= TransmitFifo::kFullFlag ? csr1::kTransmitFifoFull : 0U);
}

// HIPRO: bytes of a longword are withheld until all four have been written. Returns true if the
// longword may leave.
bool completes_hipro(CardNode& node, std::uint32_t acr, std::uint32_t offset, std::uint32_t bytes) {
  if ((acr & acr::kHiPro) == 0) {
    node.hipro_longword = kNone;
    return true;
  }
  if (node.hipro_longword != offset / 4) node.hipro_bytes = 0;
  node.hipro_longword = offset / 4;
  node.hipro_bytes |= enabled_bytes(offset, bytes);
  if (node.hipro_bytes != kAllBytes) return false;
  node.hipro_longword = kNone;
  return true;
}

}  // namespace

Registers Engine::registers(const CardNode& node) const {
  now_ns_ = clock_ns();
  return Registers{*node.plus, now_ns_};
}

// Adds to the FIFO and raises its flags.
Access Engine::enqueue(CardNode& node, const FifoEntry& entry) {
  node.fifo.add(entry);
  if (type_ == CardType::Plus && node.fifo.size() >= TransmitFifo::kSevenEighths)
    latch(node, level_flags(node.fifo));
  schedule_transmit(position(node), now_ + rates_.insertion);
  return Access::Queued;
}

Access Engine::write_plus(CardNode& node, std::uint32_t offset, std::uint32_t value,
                          std::uint32_t bytes) {
  const Registers csr = registers(node);
  if (csr.all_set(0, csr0::kAcrWindow)) {
    if (offset % 4 == 0) set_acr(position(node), offset / 4, value);
    return Access::Local;
  }
  const std::uint32_t at = offset & ~3U;
  const std::uint32_t before = node.memory.get<std::uint32_t>(at);
  const std::uint32_t after = merged(before, value, offset, bytes);
  const std::uint32_t acr = node.acr.get(at / 4);
  const bool interrupt = csr.sends_interrupt(acr);
  const bool connected = (csr.peek(0) & (csr0::kReceive | csr0::kTransmit)) != 0;
  const bool unchanged = after == before && !interrupt && filters(csr, offset);
  const bool full = node.fifo.is_full() && connected && !unchanged;
  if (full && !csr.all_set(8, csr8::kNoHoldoff)) return Access::HeldOff;

  const bool complete = !csr.all_set(2, csr2::kHiPro) || completes_hipro(node, acr, offset, bytes);
  if (!csr.all_set(2, csr2::kNoHostWrite)) node.memory.set(at, after);
  trigger(node, acr::kTriggerOnHostWrite, acr);
  if (!complete) return Access::Withheld;
  if (!connected) return Access::Local;
  if (unchanged) return Access::Filtered;
  if (full) return Access::Lost;
  FifoEntry entry;
  entry.address = static_cast<std::uint32_t>(network_offset(csr.peek(12))) + at;
  entry.value = after;
  entry.interrupt = interrupt;
  return enqueue(node, entry);
}

// Conditions of CSR1 that hold now.
std::uint32_t Engine::live_status(std::uint32_t at) const {
  const CardNode& node = nodes_[at];
  return (node.fifo.is_empty() ? 0U : csr1::kTransmitFifoNotEmpty) | level_flags(node.fifo) |
         (size(node.plus->fifo) >= kFifoEntries ? csr1::kInterruptFifoFull : 0U) |
         (has_carrier(at) ? 0U : csr1::kNoCarrier);
}

std::uint32_t Engine::read_csr(std::uint32_t at, int index) {
  const CardNode& node = nodes_[at];
  return registers(node).read(index, {.nodes = node.counts.ring_nodes,
                                      .bypass_switch = node.bypass_switch,
                                      .live_status = live_status(at)});
}

std::uint32_t Engine::peek_csr(std::uint32_t at, int index) {
  const CardNode& node = nodes_[at];
  if (index == 1)
    return node.plus->latched.load() | live_status(at) |
           (node.plus->armed.load() != 0 ? csr1::kArmed : 0U) |
           (node.bypass_switch ? 0U : csr1::kNoBypassSwitch);
  if (index == 4) return peek(node.plus->fifo).value_or(0) & 0xFFFC;
  return read_csr(at, index);
}

void Engine::reset_transmitter(CardNode& node) {
  node.fifo.clear();
  node.outstanding.active = false;
  node.hipro_longword = kNone;
}

void Engine::write_csr(std::uint32_t at, int index, std::uint32_t value) {
  CardNode& node = nodes_[at];
  Registers csr = registers(node);
  const std::uint32_t before = csr.peek(0);
  csr.write(index, value);
  if (index == 0 && ((before | csr.peek(0)) & csr0::kResetTransmitFifo) != 0) {
    reset_transmitter(node);
  }
  if (index == 13) node.transit_armed = csr.measures_transit();
  update_path(at);
  schedule_transmit(at, now_);
  interrupt_host(node);
}

void Engine::set_acr(std::uint32_t at, std::uint32_t longword, std::uint32_t bits) {
  AcrCells& cells = nodes_[at].acr;
  if (longword < cells.size()) cells.set(longword, bits);
}

void Engine::share(std::uint32_t at, scramnet::Card& card, scramnet::Word* acr,
                   broker::Members members) {
  CardNode& node = nodes_[at];
  node.shared = &card;
  node.members = members;
  node.plus = &card.plus;
  node.acr.share(acr);
  power_up(at);
  card.carried.active.store(1);
}

void Engine::exchange(std::uint32_t at) {
  CardNode& node = nodes_[at];
  if (node.shared == nullptr || !node.powered) return;
  Carried& carried = node.shared->carried;
  if (carried.transmit_resets.exchange(0) != 0) reset_transmitter(node);
  if (carried.counter_writes.exchange(0) != 0)
    node.transit_armed = registers(node).measures_transit();
  update_path(at);
  schedule_transmit(at, now_);
  carried.live_status.store(live_status(at));
  carried.ring_nodes.store(node.counts.ring_nodes);
  carried.transmit_fifo.store(node.fifo.size());
  carried.sent.store(static_cast<std::uint32_t>(node.counts.sent));
  carried.stored.store(static_cast<std::uint32_t>(node.counts.stored));
  carried.rejected.store(static_cast<std::uint32_t>(node.counts.rejected));
  carried.same_id.store(static_cast<std::uint32_t>(node.counts.same_id));
  carried.scans.fetch_add(1);
}

}  // namespace rths::replicated
