// SPDX-License-Identifier: Apache-2.0
//
// Both types of card: accesses, power, the path of messages through a node, fibres.
#include <algorithm>

#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/registers.hpp>
#include <rths/core/error.hpp>

#include "engine.hpp"

namespace rths::replicated {

using namespace scramnet;

CardNode::CardNode(const NodeSetup& setup, CardType type)
    : fibre{from_ns(5 * setup.fibre_m)},
      extra_delay{setup.extra_delay},
      bypass_switch{setup.bypass_switch},
      id{setup.id},
      memory{setup.memory_bytes},
      acr{setup.memory_bytes / 4} {
  if (type == CardType::Plus)
    own_plus = std::make_unique<PlusCard>(), plus = own_plus.get();
  else
    gt = std::make_unique<GtCard>();
}

Access Engine::write(std::uint32_t at, std::uint32_t offset, std::uint32_t value,
                     std::uint32_t bytes) {
  CardNode& node = nodes_[at];
  RTHS_ASSERT(bytes == 1 || bytes == 2 || bytes == 4);
  offset -= offset % bytes;
  if (!node.powered || offset + std::uint64_t{bytes} > node.memory.size()) return Access::Local;
  return type_ == CardType::Plus ? write_plus(node, offset, value, bytes)
                                 : write_gt(node, offset, value, bytes);
}

std::uint32_t Engine::read(std::uint32_t at, std::uint32_t offset, std::uint32_t bytes) {
  const CardNode& node = nodes_[at];
  RTHS_ASSERT(bytes == 1 || bytes == 2 || bytes == 4);
  offset -= offset % bytes;
  if (!node.powered || offset + std::uint64_t{bytes} > node.memory.size()) return 0xFFFF'FFFF;
  if (type_ == CardType::Plus && registers(node).all_set(0, csr0::kAcrWindow))
    return offset % 4 == 0 ? node.acr.get(offset / 4) : 0;
  if (bytes == 1) return node.memory.get<std::uint8_t>(offset);
  if (bytes == 2) return node.memory.get<std::uint16_t>(offset);
  return node.memory.get<std::uint32_t>(offset);
}

void Engine::power_up(std::uint32_t at) {
  CardNode& node = nodes_[at];
  if (type_ == CardType::Plus) {
    registers(node).power_up(node.id);
    registers(node).set_size_code(size_code_of(node.memory.size()));
  } else {
    power_up_gt(*node.gt, clock_ns());
    static_cast<void>(set_state(*node.gt, 0, node.id, clock_ns()));
  }
  update_path(at);
}

void Engine::set_power(std::uint32_t at, bool on) {
  CardNode& node = nodes_[at];
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

namespace {

Path path_of_plus(const Registers& csr, bool bypass_switch) {
  const bool wire = csr.all_set(2, csr2::kWireLoopback);
  if (!csr.all_set(0, csr0::kInsert)) return wire ? Path::Looped : Path::Monitor;
  if (wire) return Path::Breaking;
  const bool loops = !csr.all_set(8, csr8::kNoSwitchLoopback) ||
                     (!csr.all_set(2, csr2::kNoFibreLoopback) && bypass_switch);
  return loops ? Path::Looped : Path::Inserted;
}

}  // namespace

void Engine::update_path(std::uint32_t at) {
  CardNode& node = nodes_[at];
  if (!node.powered) {
    node.path = Path::Off;
  } else if (type_ == CardType::Gt) {
    node.path = is_set(*node.gt, gt::kLinkControl, gt::kWrap) ? Path::Looped : Path::Inserted;
  } else {
    node.path = path_of_plus(registers(node), node.bypass_switch);
  }
}

// A signal arrives from the nearest node upstream that sends, past nodes that pass optically.
bool Engine::has_carrier(std::uint32_t at) const {
  if (nodes_[at].path == Path::Looped || nodes_[at].path == Path::Breaking) return true;
  for (std::uint32_t steps = 0, node = at; steps < nodes_.size(); ++steps) {
    node = node == 0 ? static_cast<std::uint32_t>(nodes_.size()) - 1 : node - 1;
    const CardNode& upstream = nodes_[node];
    if (!upstream.connected) return false;
    if (upstream.path == Path::Inserted) return true;
    if (!upstream.bypass_switch || upstream.path == Path::Breaking) return false;
  }
  return false;
}

CardReport Engine::report(std::uint32_t at) {
  CardNode& node = nodes_[at];
  CardReport report = node.counts;
  report.powered = node.powered;
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
