// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::dds {

/// Carries bytes from one gateway to all others, whole or not at all. Bytes may be lost, repeated,
/// reordered or made by others: the gateway checks and repairs.
///
/// One thread sends, another receives.
class Carrier {
 public:
  virtual ~Carrier() = default;
  /// Sends to all others. Blocks while they are behind. @returns false if it gave up after a
  /// second
  [[nodiscard]] virtual bool send(std::span<const std::byte> bytes) = 0;
  /// Waits for the next bytes from others. @returns false if there were none until the timeout
  [[nodiscard]] virtual bool receive(std::vector<std::byte>& bytes, Duration timeout) = 0;
};

struct CycloneOptions {
  std::uint32_t domain = 0;
  std::string interface;           ///< "eth1", or its address; empty: Cyclone's choice
  std::vector<std::string> peers;  ///< addresses; empty: multicast finds them
  std::string ring;                ///< hosts with the same name exchange data
};
/// A carrier over Cyclone DDS.
/// @throws Error if DDS cannot start, with its reason   @setup
[[nodiscard]] std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options);

}  // namespace rths::dds
