// SPDX-License-Identifier: Apache-2.0
//
// The host's side of a GT card: stores, interrupts, registers and states.
#include "engine.hpp"

namespace rths::replicated {

using namespace scramnet;

// Bytes travel with their enables, so that stores of different nodes into one longword survive.
Access Engine::write_gt(CardNode& node, std::uint32_t offset, std::uint32_t value,
                        std::uint32_t bytes) {
  const bool sends = is_set(*node.gt, gt::kLinkControl, gt::kTransmit);
  if (sends && node.fifo.is_full()) return Access::HeldOff;
  if (!is_set(*node.gt, gt::kLinkControl, gt::kWriteMeLast)) {
    for (std::uint32_t byte = 0; byte < bytes; ++byte)
      node.memory.set(offset + byte, static_cast<std::uint8_t>(value >> 8 * byte));
  }
  if (!sends) return Access::Local;
  FifoEntry entry;
  entry.address = offset & ~3U;
  entry.value = value << offset % 4 * 8;
  entry.enables = enabled_bytes(offset, bytes);
  return enqueue(node, entry);
}

Access Engine::send_interrupt(std::uint32_t at, const FifoEntry& interrupt) {
  CardNode& node = nodes_[at];
  if (!node.powered || !is_set(*node.gt, gt::kLinkControl, gt::kTransmit)) return Access::Local;
  return node.fifo.is_full() ? Access::HeldOff : enqueue(node, interrupt);
}

// The ring as the card's status messages show it.
GtRing Engine::gt_ring(std::uint32_t at) const {
  GtRing ring{.nodes = 1, .upstream = node_id(*nodes_[at].gt), .closed = nodes_[at].connected};
  for (std::uint32_t other = behind(at); other != at; other = behind(other)) {
    const CardNode& node = nodes_[other];
    ring.closed =
        ring.closed && node.connected && (node.path == Path::Inserted || node.bypass_switch);
    if (node.path != Path::Inserted) continue;
    ++ring.nodes;
    ring.upstream = node_id(*node.gt);
  }
  if (!ring.closed) ring.nodes = 256;
  const Time last = nodes_[at].round_trip;
  ring.latency_ns = static_cast<std::int64_t>(to_ns(last != Time{0} ? last : quiet_round_trip(at)));
  return ring;
}

// Of a message that finds every line free.
Time Engine::quiet_round_trip(std::uint32_t at) const {
  Time time = nodes_[at].fibre;
  for (std::uint32_t other = behind(at); other != at; other = behind(other)) {
    const CardNode& node = nodes_[other];
    time += node.fibre;
    if (node.path == Path::Inserted) time += rates_.node_delay + node.extra_delay;
  }
  return time;
}

std::uint32_t Engine::gt_state(std::uint32_t at, std::uint32_t state) {
  return get_state(*nodes_[at].gt, state, gt_ring(at), clock_ns());
}

bool Engine::set_gt_state(std::uint32_t at, std::uint32_t state, std::uint32_t value) {
  const bool done = set_state(*nodes_[at].gt, state, value, clock_ns()) == StateResult::Ok;
  update_path(at);
  schedule_transmit(at, now_);
  return done;
}

std::uint32_t Engine::read_cr(std::uint32_t at, std::uint32_t offset) {
  return offset / 4 < kGtRegisters
             ? scramnet::read_cr(*nodes_[at].gt, offset / 4, gt_ring(at), clock_ns())
             : 0xFFFF'FFFF;
}

void Engine::write_cr(std::uint32_t at, std::uint32_t offset, std::uint32_t value) {
  if (offset / 4 >= kGtRegisters) return;
  scramnet::write_cr(*nodes_[at].gt, offset / 4, value, clock_ns());
  update_path(at);
  schedule_transmit(at, now_);
}

}  // namespace rths::replicated
