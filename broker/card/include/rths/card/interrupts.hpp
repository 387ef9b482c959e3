// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/card/card.hpp>

namespace rths::scramnet {

/// Delivers one host interrupt if the card is armed, has host interrupts enabled and one pending;
/// then disarms it. Registered processes get SIGUSR1, except those of other PID namespaces.
void deliver_if_due(Card& card, broker::Members members);

/// Registers a process for SIGUSR1. @returns false if all kMaxRegistrations are in use
[[nodiscard]] bool add_registration(PlusCard& card, broker::Claim process, broker::Members members);
/// @returns false if it was not registered
bool remove_registration(PlusCard& card, broker::Claim process);
void remove_all_registrations(PlusCard& card);
[[nodiscard]] bool is_registered(const PlusCard& card, broker::Claim process);

}  // namespace rths::scramnet
