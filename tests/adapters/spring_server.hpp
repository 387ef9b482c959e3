// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "endpoint.hpp"
#include "generic_client.hpp"

namespace rths::adapters::test_support {

/// Messages that a spring server received.
struct Received {
  std::vector<int> codes;  ///< in order; 3: new displacement, −3: repeated displacement
  std::string error;       ///< empty: the client sent its end
};

/// A server for a generic client with a spring of stiffness 2.8, in a separate thread.
class SpringServer {
 public:
  explicit SpringServer(Transport transport);
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Waits for the client's end, at most ten seconds.
  [[nodiscard]] Received received();

 private:
  void serve();
  std::uint16_t port_;
  Endpoint endpoint_;
  Received received_;
  std::jthread thread_;  ///< last member: it uses the others
};

}  // namespace rths::adapters::test_support
