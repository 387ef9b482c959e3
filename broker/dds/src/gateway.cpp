// SPDX-License-Identifier: Apache-2.0
#include <rths/dds/gateway.hpp>

#include <random>
#include <thread>
#include <utility>

#include "inbox.hpp"
#include "outbox.hpp"
#include "shared.hpp"

namespace rths::dds {
namespace {

HostId new_host_id() {
  std::random_device random;
  return (HostId{random()} << 32U | random()) | 1U;
}

}  // namespace

struct Gateway::State {
  State(const std::string& ring, std::unique_ptr<Carrier> with, GatewayOptions options)
      : carrier{std::move(with)} {
    shared.host = new_host_id();
    shared.options = std::move(options);
    shared.carrier = carrier.get();
    shared.map_hash = broker::Ring::attach(ring).map().hash();
    outbox = std::make_unique<Outbox>(ring, shared);
    inbox = std::make_unique<Inbox>(ring, shared);
    sender = std::thread{[this] { outbox->run(); }};
    receiver = std::thread{[this] { inbox->run(); }};
  }
  ~State() {
    shared.ends = true;
    sender.join();
    receiver.join();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::unique_ptr<Carrier> carrier;
  Shared shared;
  std::unique_ptr<Outbox> outbox;
  std::unique_ptr<Inbox> inbox;
  std::thread sender, receiver;
};

Gateway::Gateway(const std::string& ring, std::unique_ptr<Carrier> carrier, GatewayOptions options)
    : state_{std::make_unique<State>(ring, std::move(carrier), std::move(options))} {}
Gateway::~Gateway() = default;

GatewayCounts Gateway::counts() const {
  const auto& c = state_->shared.counts;
  return {c.frames_sent, c.updates_sent, c.frames_received, c.updates_received, c.bad_frames,
          c.repeated,    c.gaps,         c.sent_again,      c.snapshots,        c.mismatches,
          c.lapped,      c.hold_off_ns};
}

std::vector<std::string> Gateway::hosts() const {
  const std::lock_guard lock{state_->shared.mutex};
  const TimePoint now = WallClock{}.now();
  std::vector<std::string> names;
  for (const auto& [name, heard] : state_->shared.heard)
    if (now - heard < std::chrono::seconds{1}) names.push_back(name);
  return names;
}

}  // namespace rths::dds
