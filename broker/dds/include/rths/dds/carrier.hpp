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

/// A gateway of another host, as the network announces it apart from the bytes that it sends.
struct PresentHost {
  std::uint64_t id = 0;    ///< of its carrier
  std::string host, ring;  ///< names; any bytes
};

/// Carries bytes from one gateway to all others, whole or not at all. Bytes may be lost, repeated,
/// reordered or made by others: the gateway checks and repairs.
///
/// One thread sends, another one calls `present` and `rejoin`, and a thread of the carrier hands
/// over the bytes that arrive.
class Carrier {
 public:
  using Handler = std::function<void(std::span<const std::byte>)>;
  Carrier();
  virtual ~Carrier() = default;
  Carrier(const Carrier&) = delete;
  Carrier& operator=(const Carrier&) = delete;
  /// Tells this carrier from those of all other hosts and times. Random.
  [[nodiscard]] std::uint64_t id() const { return id_; }
  /// Sends to all others. Blocks while they are behind. @returns false if it gave up after a
  /// second
  [[nodiscard]] virtual bool send(std::span<const std::byte> bytes) = 0;
  /// Calls `handle` with all bytes that arrive from now on, one call at a time. Empty: ends this;
  /// after the return, no call is running.
  virtual void listen(Handler handle) = 0;
  /// The other gateways of this ring that run and can be reached, also if none of their bytes
  /// arrive.
  [[nodiscard]] virtual std::vector<PresentHost> present() = 0;
  /// Number of damaged datagrams that arrived so far, as far as the network noticed.
  [[nodiscard]] virtual std::uint64_t damaged() const = 0;
  /// Leaves the network and joins it anew, without its records of the other hosts, which damaged
  /// datagrams may have spoilt. Bytes on their way are lost. Blocks for a second at most.
  /// @throws Error if it cannot join; it carries nothing until another call succeeds
  virtual void rejoin() = 0;

 private:
  std::uint64_t id_;
};

struct CycloneOptions {
  std::uint32_t domain = 0;
  std::string interface;           ///< "eth1", or its address; empty: Cyclone's choice
  std::vector<std::string> peers;  ///< addresses; empty: multicast finds them
  std::string ring;                ///< hosts with the same name exchange data; "*": any ring
  std::string host;                ///< name of this host; empty: it is not announced
};
/// A carrier over Cyclone DDS. CYCLONEDDS_URI may name files with more settings. Its IPv4 sockets
/// are bound to the network interface in use, if it is one.
/// @throws Error if DDS cannot start, with its reason   @setup
[[nodiscard]] std::unique_ptr<Carrier> make_cyclone_carrier(const CycloneOptions& options);

}  // namespace rths::dds
