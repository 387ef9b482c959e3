// SPDX-License-Identifier: Apache-2.0
#include "interrupts.hpp"

#include <csignal>

#include "bits.hpp"
#include "fifo.hpp"
#include "registers.hpp"

namespace rths::scramnet {
namespace {

// A memory interrupt is in the FIFO; an error interrupt is in CSR1, with the FIFO empty.
bool has_pending_interrupt(Card& card) {
  if (peek(card.plus.fifo)) return true;
  const Registers registers{card};
  return registers.all_set(0, csr0::kErrorInterrupts) &&
         (card.plus.latched.load() & registers.peek(9)) != 0;
}

}  // namespace

void deliver_if_due(Card& card) {
  if (!Registers{card}.all_set(0, csr0::kHostInterrupts | csr0::kReceive)) return;
  if (!has_pending_interrupt(card)) return;
  if (card.plus.armed.exchange(0) == 0) return;
  card.plus.host_interrupts.fetch_add(1);
  for (const auto& entry : card.plus.registered) {
    const broker::Claim process = entry.load();
    if (process != 0 && broker::is_alive(process)) kill(broker::pid_of(process), SIGUSR1);
  }
}

bool is_registered(const PlusCard& card, broker::Claim process) {
  for (const auto& entry : card.registered)
    if (entry.load() == process) return true;
  return false;
}

bool add_registration(PlusCard& card, broker::Claim process) {
  if (is_registered(card, process)) return true;
  for (auto& entry : card.registered) {
    broker::Claim holder = entry.load();
    if (holder != 0 && broker::is_alive(holder)) continue;
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
