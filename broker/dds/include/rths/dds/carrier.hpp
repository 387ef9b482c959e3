// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rths::dds {

/// Carries bytes from one gateway to all others, whole or not at all. Bytes may be lost, repeated,
/// reordered or made by others: the gateway checks and repairs.
///
/// One thread sends; a thread of the carrier hands over the bytes that arrive.
class Carrier {
 public:
  using Handler = std::function<void(std::span<const std::byte>)>;
  virtual ~Carrier() = default;
  /// Sends to all others. Blocks while they are behind. @returns false if it gave up after a
  /// second
  [[nodiscard]] virtual bool send(std::span<const std::byte> bytes) = 0;
  /// Calls `handle` with all bytes that arrive from now on, one call at a time. Empty: ends this;
  /// after the return, no call is running.
  virtual void listen(Handler handle) = 0;
};

struct CycloneOptions {
  std::uint32_t domain = 0;
  std::string interface;           ///< "eth1", or its address; empty: Cyclone's choice
  std::vector<std::string> peers;  ///< addresses; empty: multicast finds them
  std::string ring;                ///< hosts with the same name exchange data
};
/// A carrier over Cyclone DDS. CYCLONEDDS_URI may name files with more settings.
/// @throws Error if DDS cannot start, with its reason   @setup
[[nodiscard]] std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options);

}  // namespace rths::dds
