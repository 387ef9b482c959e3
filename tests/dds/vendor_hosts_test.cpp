// SPDX-License-Identifier: Apache-2.0
//
// Programs written for the cards, unchanged, on two hosts: plain stores, found by `rths watch`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>

#include "hosts.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/network.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

// The words of the clients: target and its flag, flags and feedback of the controller.
memmap::Map handshake_map() {
  return memmap::parse_map(R"(ringmap = 1
[ring]
name = "handshake"
version = 1
size_bytes = 2_097_152
[nodes]
solver = 1
controller = 2
[[partition]]
name = "target"
node = "solver"
offset = 1024
longwords = 5
[[partition.signal]]
name = "new"
offset = 1024
type = "i32"
event = true
[[partition]]
name = "answer"
node = "controller"
offset = 1029
longwords = 6
[[partition.signal]]
name = "switch"
offset = 1029
type = "i32"
event = true
[[partition.signal]]
name = "at_target"
offset = 1030
type = "i32"
event = true
)",
                           "handshake");
}

class VendorHosts : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!network_.exists()) GTEST_SKIP() << "SKIPPED: network namespaces cannot be made here";
  }
  /// Starts a command on a host, with a shell's variables before it.
  [[nodiscard]] std::unique_ptr<test::Running> start(int host, const std::string& variables,
                                                     const std::string& command) const {
    return std::make_unique<test::Running>(std::vector<std::string>{
        "/bin/sh", "-c", fmt::format("{} exec {}{}", variables, network_.on(host), command)});
  }
  [[nodiscard]] std::unique_ptr<test::Running> start_client(int host, const test::RingHost& ring,
                                                            const std::string& node,
                                                            const std::string& client) const {
    return start(host,
                 fmt::format("RTHS_SCRAMNET_RING={} RTHS_SCRAMNET_NODE={}", ring.ring_name(), node),
                 (test::build_tree() / "bin" / ("scramnet_" + client)).string());
  }
  const test::Network network_{2};
};

TEST_F(VendorHosts, CompleteEveryStepOfAHandshake) {
  const int steps = test::is_long() ? 10'000 : 2'000;
  test::RingHost first{"first", handshake_map()}, second{"second", handshake_map()};
  std::vector<std::unique_ptr<test::Running>> helpers;
  for (const int host : {1, 2}) {
    const auto& ring = host == 1 ? first : second;
    helpers.push_back(start(host, "",
                            fmt::format("{} bridge {} --as handshake --domain 7 --interface eth0",
                                        test::rths_command(), ring.ring_name())));
    helpers.push_back(
        start(host, "", fmt::format("{} watch {}", test::rths_command(), ring.ring_name())));
  }
  const auto controller = start_client(1, first, "controller", "controller");
  const auto solver = start_client(2, second, "solver", fmt::format("openfresco {}", steps));

  const auto of_solver = solver->wait(110);
  const auto of_controller = controller->wait(5);
  EXPECT_EQ(of_solver.exit_code, 0) << of_solver.err;
  EXPECT_EQ(of_controller.exit_code, 0) << of_controller.err;
  EXPECT_EQ(of_solver.out, fmt::format("{} steps\n", steps));
  EXPECT_EQ(of_controller.out, fmt::format("{} steps\n", steps));
  std::printf("%.2f ms per step\n", 1e3 * of_solver.seconds / steps);
}

}  // namespace
}  // namespace rths
