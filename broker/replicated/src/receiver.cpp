// SPDX-License-Identifier: Apache-2.0
//
// The effect of a message on a card that has received its last bit.
#include "engine.hpp"

#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/interrupts.hpp>
#include <rths/card/registers.hpp>

namespace rths::replicated {

using namespace scramnet;

std::uint32_t Engine::receive_id(const CardNode& node) const {
  return type_ == CardType::Plus ? node.plus->receive_id.load() : node_id(*node.gt);
}

// Cards know their messages by their id. Where another node has the same id, the hardware takes
// that node's messages for its own.
bool Engine::is_own_id(const CardNode& node, const Message& message) const {
  return message.source == receive_id(node) && (strict_ids_ || message.origin == position(node));
}

void Engine::on_received(const Event& event) {
  CardNode& node = nodes_[event.node];
  Message& message = messages_[event.subject];
  if (message.origin != event.node && message.source == receive_id(node)) ++node.counts.same_id;
  if (event.damaged) {
    log(Hop::Kind::Rejected, message, event.node);
    reject(node);
  } else if (type_ == CardType::Plus) {
    store_plus(node, message, event.own);
  } else {
    store_gt(node, message, event.own);
  }
  if (event.own && message.origin == event.node) on_return(event.node, message, event.damaged);
  --message.receivers;
  release_if_done(event.subject);
}

void Engine::reject(CardNode& node) {
  ++node.counts.rejected;
  if (type_ == CardType::Plus)
    latch_error(node, csr1::kBadMessage);
  else
    node.gt->own[0].fetch_add(1);  // link errors
}

void Engine::store_plus(CardNode& node, const Message& message, bool own) {
  Registers csr = registers(node);
  if (!csr.all_set(0, csr0::kReceive) || (own && !csr.all_set(2, csr2::kReceiveOwn))) return;
  ++node.counts.stored;
  csr.count(Counted::Messages);
  const std::uint64_t window = network_offset(csr.peek(12));
  for (std::uint32_t i = 0; i < message.longwords.size(); ++i)
    if (const auto offset = message.address + std::uint64_t{4} * i - window;
        offset < node.memory.size())
      node.memory.set(offset, message.longwords[i]);
  log(Hop::Kind::Stored, message, position(node));  // the data are there before their interrupt
  for (std::uint32_t i = 0; i < message.longwords.size(); ++i)
    if (const auto offset = message.address + std::uint64_t{4} * i - window;
        offset < node.memory.size())
      interrupt_of(node, message, own, offset, window);
  interrupt_host(node);
}

// Trigger and interrupt of one longword of a message.
void Engine::interrupt_of(CardNode& node, const Message& message, bool own, std::uint64_t offset,
                          std::uint64_t window) {
  const std::uint32_t acr = node.acr.get(offset / 4);
  trigger(node, acr::kTriggerOnMessage, acr);
  if (!registers(node).accepts_interrupt(acr, own, message.interrupt)) return;
  const std::uint32_t repeated = message.repeated ? kRepeatedEntry : 0;
  if (!push(node.plus->fifo, static_cast<std::uint32_t>(offset + window) | repeated))
    ++node.counts.lost_interrupts;
  if (size(node.plus->fifo) == kFifoEntries) latch(node, csr1::kInterruptFifoFull);
}

void Engine::store_gt(CardNode& node, const Message& message, bool own) {
  const bool is_taken = message.content == Content::Data ? store_gt_data(node, message, own)
                                                         : queue_gt(node, message, own);
  if (!is_taken) return;
  ++node.counts.stored;
  log(Hop::Kind::Stored, message, position(node));
}

// @returns false if the card does not take this interrupt, or has no space for it
bool Engine::queue_gt(CardNode& node, const Message& message, bool own) {
  const GtCard& card = *node.gt;
  const bool unicast = message.content == Content::Unicast;
  const std::uint32_t type = unicast ? gt_interrupt::kUnicast : gt_interrupt::kBroadcast;
  if (own && !is_set(card, gt::kLinkControl, gt::kInterruptSelf)) return false;
  if (unicast && message.address != node_id(card)) return false;
  if (!accepts(card, type, message.address)) return false;
  GtQueue& queue = node.queue;
  if (queue.size() == kGtQueue) {
    ++node.counts.lost_interrupts;
    return false;
  }
  queue.entries[queue.added++ % kGtQueue] = {type, message.source, unicast ? 0 : message.address,
                                             message.longwords[0]};
  return true;
}

// @returns false if the card does not receive
bool Engine::store_gt_data(CardNode& node, const Message& message, bool own) {
  const GtCard& card = *node.gt;
  if (!is_set(card, gt::kLinkControl, gt::kReceive)) return false;
  if (own && !is_set(card, gt::kLinkControl, gt::kWriteMeLast)) return false;
  for (std::uint32_t i = 0; i < message.longwords.size(); ++i) {
    const std::uint64_t offset = message.address + std::uint64_t{4} * i;
    if (offset >= node.memory.size()) continue;
    for (std::uint32_t byte = 0; byte < 4; ++byte)
      if ((message.enables >> byte & 1U) != 0)
        node.memory.set(offset + byte, static_cast<std::uint8_t>(message.longwords[i] >> 8 * byte));
  }
  return true;
}

// A card in an image has its host in another process.
void Engine::interrupt_host(CardNode& node) {
  if (node.shared != nullptr) return deliver_if_due(*node.shared, node.members);
  static_cast<void>(registers(node).take_host_interrupt());
}

// CSR1.4 and the other conditions of CSR1 interrupt the host if CSR9 selects them.
void Engine::latch(CardNode& node, std::uint32_t csr1_bits) {
  registers(node).latch(csr1_bits);
  interrupt_host(node);
}

void Engine::latch_error(CardNode& node, std::uint32_t csr1_bits) {
  registers(node).count(Counted::Errors);
  latch(node, csr1_bits);
}

// Overridden interrupts disable the external triggers.
void Engine::trigger(CardNode& node, std::uint32_t acr_bit, std::uint32_t acr) {
  if ((acr & acr_bit) == 0) return;
  Registers csr = registers(node);
  constexpr std::uint32_t kOverrides = csr0::kAllReceiveInterrupts | csr0::kAllSendInterrupts;
  if ((csr.peek(0) & kOverrides) != 0) return;
  ++node.counts.triggers;
  csr.count(Counted::Triggers);
  if (acr_bit == acr::kTriggerOnMessage) csr.clear_slow_counter();
}

}  // namespace rths::replicated
