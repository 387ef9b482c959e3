// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/partner.hpp>

#include "socket.hpp"

namespace rths::bench {

/// Answers every message at once with one of the same length: the time of a round trip through the
/// socket alone.
class PingPong {
 public:
  /// Forks the answering process. @throws Error if that or the connection fails
  PingPong(Transport transport, std::size_t length, int cpu);

  /// Sends a message and overwrites it with the answer. @throws Error if there is none
  void exchange(std::span<std::byte> message) const;

 private:
  std::uint16_t port_;
  Socket server_;
  Partner partner_;
  Socket client_;
};

}  // namespace rths::bench
