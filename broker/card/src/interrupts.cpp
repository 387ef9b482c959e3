// SPDX-License-Identifier: Apache-2.0
#include <rths/card/interrupts.hpp>

#include <csignal>

#include <rths/card/registers.hpp>

namespace rths::scramnet {
void deliver_if_due(Card& card, broker::Members members) {
  if (!Registers{card}.take_host_interrupt()) return;
  for (const auto& entry : card.plus.registered) {
    const broker::Claim process = entry.load();
    if (members.has(process) && broker::is_of_this_namespace(process))
      kill(broker::pid_of(process), SIGUSR1);
  }
}

bool is_registered(const PlusCard& card, broker::Claim process) {
  for (const auto& entry : card.registered)
    if (entry.load() == process) return true;
  return false;
}

bool add_registration(PlusCard& card, broker::Claim process, broker::Members members) {
  if (is_registered(card, process)) return true;
  for (auto& entry : card.registered) {
    broker::Claim holder = entry.load();
    if (members.has(holder)) continue;
    if (entry.compare_exchange_strong(holder, process)) return true;
  }
  return false;
}

bool remove_registration(PlusCard& card, broker::Claim process) {
  bool found = false;
  for (auto& entry : card.registered) {
    broker::Claim holder = process;
    found = entry.compare_exchange_strong(holder, 0) || found;
  }
  return found;
}

void remove_all_registrations(PlusCard& card) {
  for (auto& entry : card.registered) entry.store(0);
}

}  // namespace rths::scramnet
