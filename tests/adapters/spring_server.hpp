// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "endpoint.hpp"
#include "generic_client.hpp"

namespace rths::adapters::test {

/// What a spring server heard.
struct Heard {
  std::vector<int> codes;  ///< in order; a new displacement is 3, one that is repeated −3
  std::string trouble;     ///< empty: the client took leave
};

/// A spring of 2.8 at the far end of a generic client, in a thread of its own.
class SpringServer {
 public:
  explicit SpringServer(Transport transport);
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Waits for the client to leave, at most ten seconds.
  [[nodiscard]] Heard heard();

 private:
  void serve();
  std::uint16_t port_;
  Endpoint endpoint_;
  Heard heard_;
  std::jthread thread_;  ///< last: it uses all of the above
};

}  // namespace rths::adapters::test
