// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <optional>
#include <string>

#include "endpoint.hpp"

namespace rths::adapters {

/// The peers that may drive an element.
struct Admission {
  std::string address;  ///< of the peer; "any": every peer; empty: a process of this host
  int process = 0;      ///< it or one of its descendants; 0: any process of the same user
};

/// Decides whether a peer may connect. A process of this host is found by its socket in /proc.
/// Takes milliseconds: only before the test.
/// @param peer  address of the peer   @param own  our end of the connection
/// @returns the reason of a refusal, with the peer's process and user; nothing if it is admitted
[[nodiscard]] std::optional<std::string> refusal(const Admission& admission, Transport transport,
                                                 const sockaddr_in& peer, const sockaddr_in& own);

}  // namespace rths::adapters
