// SPDX-License-Identifier: Apache-2.0
#include <rths/dds/gateway.hpp>

#include <algorithm>
#include <thread>
#include <utility>

#include "contact.hpp"
#include "inbox.hpp"
#include "outbox.hpp"
#include "shared.hpp"

namespace rths::dds {
namespace {

// One more than the largest NodeId.
std::size_t ids_of(const memmap::Map& map) {
  std::size_t ids = 0;
  for (const auto& node : map.description().nodes)
    ids = std::max<std::size_t>(ids, node.id.value() + 1U);
  return ids;
}

}  // namespace

struct Gateway::State {
  State(const std::string& ring, std::unique_ptr<Carrier> with, GatewayOptions options)
      : carrier{std::move(with)} {
    shared.host = carrier->id();
    shared.options = std::move(options);
    shared.carrier = carrier.get();
    const auto attached = broker::Ring::attach(ring);
    shared.map_hash = attached.map().hash();
    shared.is_remote = std::vector<std::atomic<bool>>(ids_of(attached.map()));
    cards = std::make_unique<Cards>(attached, ring);
    shared.cards = cards.get();
    outbox = std::make_unique<Outbox>(ring, shared);
    shared.sender = &outbox->waiter();
    shared.reader = &outbox->reader();
    inbox = std::make_unique<Inbox>(ring, shared);
    sender = std::thread{[this] { outbox->run(); }};
    receiver = std::thread{[this] { inbox->run(); }};
    keeper = std::thread{[this] { Contact{shared}.run(); }};
  }
  ~State() {
    shared.ends = true;
    keeper.join();
    sender.join();
    receiver.join();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::unique_ptr<Carrier> carrier;
  Shared shared;
  std::unique_ptr<Cards> cards;
  std::unique_ptr<Outbox> outbox;
  std::unique_ptr<Inbox> inbox;
  std::thread sender, receiver, keeper;
};

Gateway::Gateway(const std::string& ring, std::unique_ptr<Carrier> carrier, GatewayOptions options)
    : state_{std::make_unique<State>(ring, std::move(carrier), std::move(options))} {}
Gateway::~Gateway() = default;

GatewayCounts Gateway::counts() const {
  const auto& c = state_->shared.counts;
  return {c.frames_sent,
          c.updates_sent,
          c.frames_received,
          c.updates_received,
          c.bad_frames,
          c.repeated,
          c.gaps,
          c.sent_again,
          c.snapshots,
          c.mismatches,
          c.lapped,
          c.interrupts_sent,
          c.interrupts_lost,
          c.hold_off_ns,
          c.rejoins};
}

GatewayStatus Gateway::status() const {
  const std::lock_guard lock{state_->shared.mutex};
  return state_->shared.status;
}

}  // namespace rths::dds
