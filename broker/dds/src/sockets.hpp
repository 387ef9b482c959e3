// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

namespace rths::dds {

/// IPv4 UDP sockets of this process.
[[nodiscard]] std::set<int> udp_sockets();

/// Binds the UDP sockets that this process has made since to the network interface that one of them
/// has the address of: datagrams of other interfaces do not reach them. Programs that this one
/// starts do not inherit them. Sockets of several interfaces stay as they are.
/// @param before  the sockets at the beginning
/// @returns why not, such as a missing privilege; empty if they are bound or need not be
[[nodiscard]] std::string bind_new_sockets(const std::set<int>& before);

}  // namespace rths::dds
