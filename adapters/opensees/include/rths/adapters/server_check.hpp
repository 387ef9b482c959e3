// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <rths/adapters/finding.hpp>

namespace rths::adapters {

/// A server for an `element genericClient` of OpenSees, and the values to try it with.
struct ServerCheck {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8090;
  bool is_udp = false;
  int dofs = 1;
  double amplitude = 0;  ///< of the trial displacements, in the server's units; 0: rest
  double deadline = 5;   ///< of an answer [s]
};

/// Tries a server against all rules: connect, matrices, force, repeat, move, restart. It plays
/// OpenSees: it sends sizes, requests the matrices, sends trials and ends, twice.
/// @throws Error if the address is invalid   @setup
[[nodiscard]] std::vector<Finding> check_server(const ServerCheck& check);

}  // namespace rths::adapters
