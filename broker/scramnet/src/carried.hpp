// SPDX-License-Identifier: Apache-2.0
//
// How a host waits for the thread that carries its stores as messages. May be called in a handler
// of a signal.
#pragma once

#include <rths/card/card.hpp>

namespace rths::scramnet {

/// Waits until stores and registers of before have had their effect, at most 0.1 s.
void wait_for_scan(const Carried& carried);
/// Waits until this host's stores have gone around the ring, at most 0.1 s.
void wait_for_own_stores(const Carried& carried);

}  // namespace rths::scramnet
