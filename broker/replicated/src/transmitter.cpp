// SPDX-License-Identifier: Apache-2.0
//
// Own messages: from the transmit FIFO to the ring, blocks that grow while they are sent, and
// repetition until a message has returned intact.
#include <algorithm>

#include <rths/card/bits.hpp>
#include <rths/card/registers.hpp>

#include "engine.hpp"

namespace rths::replicated {

using namespace scramnet;

bool Engine::corrects(const CardNode& node) const {
  return type_ == CardType::Plus && !registers(node).all_set(2, csr2::kNoCorrection);
}

bool Engine::may_transmit(const CardNode& node) const {
  if (node.path == Path::Off || node.path == Path::Monitor || node.own_open != kNone) return false;
  if (node.outstanding.active ? !node.outstanding.repeat : node.fifo.is_empty()) return false;
  if (type_ == CardType::Gt) return is_set(*node.gt, gt::kLinkControl, gt::kTransmit);
  return registers(node).all_set(0, csr0::kTransmit) && node.plus->timeout.load() != 0;
}

void Engine::schedule_transmit(std::uint32_t at, Time earliest) {
  CardNode& node = nodes_[at];
  if (node.transmit_scheduled || node.output.open != kNone || !may_transmit(node)) return;
  node.transmit_scheduled = true;
  node.transmit_at = std::max({earliest, now_, node.output.free});
  ++scheduled_;
  post(Event::Kind::Transmit, at, node.transmit_at);
}

void Engine::on_transmit(std::uint32_t at) {
  CardNode& node = nodes_[at];
  node.transmit_scheduled = false;
  --scheduled_;
  if (node.output.open == kNone && node.output.free <= now_ && may_transmit(node)) start_own(at);
  drain(at);
  schedule_transmit(at, now_);
}

void Engine::start_own(std::uint32_t at) {
  CardNode& node = nodes_[at];
  const std::uint32_t index = make_own(at);
  Message& message = messages_[index];
  message.sent = now_;
  node.yielded = false;
  if (message.open) {
    node.own_open = index;
    post(Event::Kind::Extend, at, now_ + rates_.message(1), index);
  }
  if (node.transit_armed) {
    node.transit_armed = false;
    node.transit_runs = true;
    node.transit_since = now_;
  }
  put_on_line(index, at, now_);
  if (!message.open && corrects(node)) expect_return(at, index);
}

// The next message: a repetition, or the FIFO's first entry.
std::uint32_t Engine::make_own(std::uint32_t at) {
  CardNode& node = nodes_[at];
  const std::uint32_t index = messages_.take();
  Message& message = messages_[index];
  if (node.outstanding.active) {
    message = node.outstanding.message;
    message.repeated = true;
    node.outstanding.repeat = false;
  } else {
    const FifoEntry entry = node.fifo.take();
    message.number = ++numbers_;
    message.address = entry.address;
    message.enables = entry.enables;
    message.content = entry.content;
    message.interrupt = entry.interrupt;
    message.repeated = false;
    message.longwords.assign(1, entry.value);
    message.open = entry.content == Content::Data && entry.enables == 0xF && !entry.interrupt &&
                   most_longwords(node) > 1;
  }
  const bool plus = type_ == CardType::Plus;
  message.origin = at;
  message.source = plus ? registers(node).peek(3) >> 8 : node_id(*node.gt);
  message.start_age = message.age = plus ? node.plus->transmit_age.load() : 0;
  message.looped = node.path != Path::Inserted;
  message.damaged = message.on_ring = false;
  message.receivers = 0;
  return index;
}

std::uint32_t Engine::most_longwords(const CardNode& node) const {
  if (type_ == CardType::Gt) return kGtBlock;
  const Registers csr = registers(node);
  if (!csr.all_set(2, csr2::kBlocks)) return 1;
  return csr.all_set(2, csr2::kLongBlocks) ? kLongBlock : kShortBlock;
}

// A block ends if the FIFO is empty, or at an address that does not follow, the greatest length,
// or an interrupt, which is a message of its own.
void Engine::on_extend(std::uint32_t at) {
  CardNode& node = nodes_[at];
  const std::uint32_t index = node.own_open;
  Message& message = messages_[index];
  const auto longwords = static_cast<std::uint32_t>(message.longwords.size());
  const bool grows = !node.fifo.is_empty() && longwords < most_longwords(node) &&
                     node.fifo.first().address == message.address + 4 * longwords &&
                     node.fifo.first().content == Content::Data &&
                     node.fifo.first().enables == 0xF && !node.fifo.first().interrupt;
  if (grows) {
    message.longwords.push_back(node.fifo.take().value);
    return post(Event::Kind::Extend, at, now_ + rates_.longword, index);
  }
  node.own_open = kNone;
  if (corrects(node)) expect_return(at, index);
  close(index);
}

// Keeps a copy; the time-out runs from the message's last bit.
void Engine::expect_return(std::uint32_t at, std::uint32_t index) {
  CardNode& node = nodes_[at];
  Outstanding& outstanding = node.outstanding;
  if (!outstanding.active) outstanding.message = messages_[index];
  outstanding.message.open = false;
  outstanding.active = true;
  const Time end = node.output.start +
                   rates_.message(static_cast<std::uint32_t>(outstanding.message.longwords.size()));
  post(Event::Kind::Timeout, at, end + node.plus->timeout.load() * kTimeoutUnit,
       ++outstanding.attempt);
}

void Engine::on_timeout(std::uint32_t at, std::uint32_t attempt) {
  CardNode& node = nodes_[at];
  if (!node.outstanding.active || node.outstanding.attempt != attempt) return;
  node.outstanding.repeat = true;
  latch_error(node, csr1::kRepeatedAfterTimeout);
  schedule_transmit(at, now_);
}

// An own message is back at its node.
void Engine::on_return(std::uint32_t at, const Message& message, bool damaged) {
  CardNode& node = nodes_[at];
  if (!damaged) node.counts.ring_nodes = message.age - message.start_age + 1;
  if (node.transit_runs && !damaged) {
    node.transit_runs = false;
    registers(node).set_counter(
        static_cast<std::uint32_t>((now_ - node.transit_since) / kTransitTick & 0xFFFF));
  }
  if (!node.outstanding.active || node.outstanding.message.number != message.number) return;
  if (damaged) {
    ++node.outstanding.attempt;  // ends the time-out
    node.outstanding.repeat = true;
    latch_error(node, csr1::kRepeatedAfterError);
  } else {
    node.outstanding.active = false;
    node.outstanding.repeat = false;
  }
  schedule_transmit(at, now_);
}

}  // namespace rths::replicated
