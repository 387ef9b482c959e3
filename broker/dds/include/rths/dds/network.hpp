// SPDX-License-Identifier: Apache-2.0
//
// The network of a host as its gateways find it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <rths/dds/carrier.hpp>
#include <rths/dds/gateway.hpp>

namespace rths::dds {

/// A network interface of this host with an IPv4 address.
struct Interface {
  std::string name, address;
  int mtu = 0;  ///< largest datagram [B]; 0: unknown
  bool is_up = false, has_multicast = false;
};
/// All interfaces of this host, in the order of the system.   @setup
[[nodiscard]] std::vector<Interface> interfaces();

/// A gateway of another host, or another gateway of this one.
struct FoundGateway {
  RemoteHost host;
  std::uint64_t map_hash = 0;
  std::size_t nodes = 0;  ///< on its host
};
/// The gateways of a domain.
struct FoundDomain {
  std::vector<FoundGateway> gateways;
  /// Hosts of a ring that do not receive each other or this host, a sentence each. Empty: all do.
  std::vector<std::string> faults;
};
/// Listens for the gateways of a domain, of any ring, and compares clocks with them. Listens twice
/// as long if it finds none, or a fault.
/// @throws Error if DDS cannot start   @setup
[[nodiscard]] FoundDomain listen_for_gateways(CycloneOptions network, Duration listening);

}  // namespace rths::dds
