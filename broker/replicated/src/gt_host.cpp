// SPDX-License-Identifier: Apache-2.0
//
// The host's side of a GT card, and the state of cards and fibres that both types share.
#include <algorithm>

#include "bits.hpp"
#include "engine.hpp"
#include "fifo.hpp"
#include "registers.hpp"

namespace rths::replicated {

using namespace scramnet;

Node::Node(const NodeSetup& setup, CardType type)
    : fibre{from_ns(5 * setup.fibre_m)},
      extra_delay{setup.extra_delay},
      bypass_switch{setup.bypass_switch},
      id{setup.id},
      memory{setup.memory_bytes},
      acr{type == CardType::Plus ? setup.memory_bytes / 4 : 0} {
  if (type == CardType::Plus)
    plus = std::make_unique<PlusCard>();
  else
    gt = std::make_unique<GtCard>();
}

Access Engine::write(std::uint32_t at, std::uint32_t offset, std::uint32_t value,
                     std::uint32_t bytes) {
  Node& node = nodes_[at];
  if (!node.powered || offset + std::uint64_t{bytes} > node.memory.size()) return Access::Local;
  return type_ == CardType::Plus ? write_plus(node, offset, value, bytes)
                                 : write_gt(node, offset, value, bytes);
}

std::uint32_t Engine::read(std::uint32_t at, std::uint32_t offset, std::uint32_t bytes) {
  const Node& node = nodes_[at];
  if (!node.powered || offset + std::uint64_t{bytes} > node.memory.size()) return 0xFFFF'FFFF;
  if (type_ == CardType::Plus && registers(node).all_set(0, csr0::kAcrWindow))
    return offset % 4 == 0 ? node.acr.get<std::uint8_t>(offset / 4) : 0;
  if (bytes == 1) return node.memory.get<std::uint8_t>(offset);
  if (bytes == 2) return node.memory.get<std::uint16_t>(offset);
  return node.memory.get<std::uint32_t>(offset);
}

// Bytes travel with their enables, so that stores of different nodes into one longword survive.
Access Engine::write_gt(Node& node, std::uint32_t offset, std::uint32_t value,
                        std::uint32_t bytes) {
  const bool sends = is_set(*node.gt, gt::kLinkControl, gt::kTransmit);
  if (sends && node.fifo.is_full()) return Access::HeldOff;
  if (!is_set(*node.gt, gt::kLinkControl, gt::kWriteMeLast)) {
    for (std::uint32_t byte = 0; byte < bytes; ++byte)
      node.memory.set(offset + byte, static_cast<std::uint8_t>(value >> 8 * byte));
  }
  if (!sends) return Access::Local;
  Entry entry;
  entry.address = offset & ~3U;
  entry.value = value << offset % 4 * 8;
  entry.enables = static_cast<std::uint8_t>(((1U << bytes) - 1) << offset % 4);
  return queue(node, entry);
}

Access Engine::send_interrupt(std::uint32_t at, const Entry& interrupt) {
  Node& node = nodes_[at];
  if (!node.powered || !is_set(*node.gt, gt::kLinkControl, gt::kTransmit)) return Access::Local;
  return node.fifo.is_full() ? Access::HeldOff : queue(node, interrupt);
}

// The ring as the card's status messages show it.
GtRing Engine::gt_ring(std::uint32_t at) const {
  GtRing ring{.nodes = 1, .upstream = node_id(*nodes_[at].gt), .closed = nodes_[at].connected};
  for (std::uint32_t other = behind(at); other != at; other = behind(other)) {
    const Node& node = nodes_[other];
    ring.closed =
        ring.closed && node.connected && (node.path == Path::Inserted || node.bypass_switch);
    if (node.path != Path::Inserted) continue;
    ++ring.nodes;
    ring.upstream = node_id(*node.gt);
  }
  if (!ring.closed) ring.nodes = 256;
  return ring;
}

std::uint32_t Engine::gt_state(std::uint32_t at, std::uint32_t state) {
  return get_state(*nodes_[at].gt, state, gt_ring(at), now_.count() / 15);
}

bool Engine::set_gt_state(std::uint32_t at, std::uint32_t state, std::uint32_t value) {
  const bool done = set_state(*nodes_[at].gt, state, value, now_.count() / 15) == StateResult::Ok;
  update_path(at);
  schedule_transmit(at, now_);
  return done;
}

void Engine::power_up(std::uint32_t at) {
  Node& node = nodes_[at];
  if (type_ == CardType::Plus) {
    registers(node).power_up(node.id);
    registers(node).set_size_code(size_code_of(node.memory.size()));
  } else {
    power_up_gt(*node.gt, now_.count() / 15);
    static_cast<void>(set_state(*node.gt, 0, node.id, now_.count() / 15));
  }
  update_path(at);
}

void Engine::set_power(std::uint32_t at, bool on) {
  Node& node = nodes_[at];
  if (node.powered == on) return;
  node.powered = on;
  node.fifo.clear();
  node.outstanding.active = false;
  node.memory.clear();
  node.acr.clear();
  node.queue = {};
  power_up(at);
}

void Engine::set_fibre(std::uint32_t at, bool connected) {
  nodes_[at].connected = connected;
  if (type_ == CardType::Gt) return;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node)
    if (!connected && !has_carrier(node)) latch_error(nodes_[node], csr1::kNoCarrier);
}

// A signal arrives from the nearest node upstream that sends, past nodes that pass optically.
bool Engine::has_carrier(std::uint32_t at) const {
  if (nodes_[at].path == Path::Looped || nodes_[at].path == Path::Breaking) return true;
  for (std::uint32_t steps = 0, node = at; steps < nodes_.size(); ++steps) {
    node = node == 0 ? static_cast<std::uint32_t>(nodes_.size()) - 1 : node - 1;
    const Node& upstream = nodes_[node];
    if (!upstream.connected) return false;
    if (upstream.path == Path::Inserted) return true;
    if (!upstream.bypass_switch || upstream.path == Path::Breaking) return false;
  }
  return false;
}

CardReport Engine::report(std::uint32_t at) {
  Node& node = nodes_[at];
  CardReport report = node.counts;
  report.transmit_fifo = node.fifo.size();
  report.waiting = node.waiting;
  std::uint32_t index = node.waiting_first;
  for (std::uint32_t i = 0; i < node.waiting; ++i, index = messages_[index].next)
    report.oldest_age = std::max(report.oldest_age, messages_[index].age);
  if (type_ == CardType::Gt) {
    report.interrupt_fifo = node.queue.size();
  } else {
    report.interrupt_fifo = size(node.plus->fifo);
    report.host_interrupts = node.plus->host_interrupts.load();
  }
  return report;
}

}  // namespace rths::replicated
