// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/partner.hpp>

#include "socket.hpp"

namespace rths::bench {

/// Answers every message with one of the same length, as fast as the system lets it: what a round
/// trip takes of which the socket is all.
class PingPong {
 public:
  /// Forks. @throws Error if it cannot be set up
  PingPong(Transport transport, std::size_t length, int cpu);

  /// Sends a message and puts the answer in its place. @throws Error if there is none
  void exchange(std::span<std::byte> message) const;

 private:
  std::uint16_t port_;
  Socket served_;
  Partner partner_;
  Socket asking_;
};

}  // namespace rths::bench
