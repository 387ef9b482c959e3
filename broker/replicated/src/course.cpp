// SPDX-License-Identifier: Apache-2.0

#include <rths/replicated/scenario.hpp>

namespace rths::replicated {
namespace {

constexpr Time kRetry = std::chrono::nanoseconds{240};  ///< of a host that is held off

}  // namespace

Course::Course(Scenario scenario) : scenario_{std::move(scenario)}, ring_{scenario_.setup} {
  for (std::size_t i = 0; i < scenario_.traffic.size(); ++i) {
    Host host;
    host.next = scenario_.traffic[i].from;
    host.random.seed(static_cast<std::uint32_t>(scenario_.setup.seed * 1000 + i));
    hosts_.push_back(host);
  }
}

// At one time, actions come before traffic, each in the order of the file.
void Course::run_until(Time time) {
  for (;;) {
    Time next = Time::max();
    if (next_action_ < scenario_.actions.size()) next = scenario_.actions[next_action_].at;
    std::size_t first = hosts_.size();
    for (std::size_t i = 0; i < hosts_.size(); ++i)
      if (hosts_[i].next < scenario_.traffic[i].until && hosts_[i].next < next) {
        next = hosts_[i].next;
        first = i;
      }
    if (next > time) break;
    ring_.run_until(next);
    if (first == hosts_.size())
      act(ring_, scenario_.actions[next_action_++]);
    else
      store(scenario_.traffic[first], hosts_[first]);
  }
  ring_.run_until(time);
}

void act(Ring& ring, const Action& action) {
  Card card = ring.card(action.node);
  switch (action.kind) {
    case Action::Kind::Write:
      static_cast<void>(card.write(to_byte_offset(LongwordOffset{action.index}), action.value));
      return;
    case Action::Kind::Csr:
      return card.write_csr(static_cast<int>(action.index), action.value);
    case Action::Kind::Interrupt:
      static_cast<void>(card.send_interrupt(1, action.index, action.value));
      return;
    case Action::Kind::PowerOff:
    case Action::Kind::PowerOn:
      return card.set_power(action.kind == Action::Kind::PowerOn);
    case Action::Kind::CutFibre:
    case Action::Kind::RepairFibre:
      return ring.set_fibre(action.node, action.kind == Action::Kind::RepairFibre);
    case Action::Kind::BitErrorRate:
      return ring.set_bit_error_rate(action.rate);
    case Action::Kind::Delay:
      return card.set_extra_delay(action.delay);
    case Action::Kind::Id:
      return card.set_id(action.value);
  }
}

void Course::store(const Traffic& traffic, Host& host) {
  if (!host.held_off)
    host.index = traffic.longword +
                 (traffic.random ? static_cast<std::uint32_t>(host.random()) : host.stored) %
                     traffic.longwords;
  const Access access =
      ring_.card(traffic.node).write(to_byte_offset(LongwordOffset{host.index}), host.stored + 1);
  if (access == Access::HeldOff) {
    stalls_ += host.held_off ? 0 : 1;
    host.held_off = true;
    host.next += kRetry;
    return;
  }
  host.held_off = false;
  ++host.stored;
  host.next += traffic.period;
}

}  // namespace rths::replicated
