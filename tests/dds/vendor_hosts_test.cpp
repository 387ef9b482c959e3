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

// Each node's control word, which interrupts, and the word that says that it is ready.
memmap::Map dueca_map() {
  return memmap::parse_map(R"(ringmap = 1
[ring]
name = "dueca"
version = 1
size_bytes = 2_097_152
[nodes]
first = 1
second = 2
[[partition]]
name = "control_0"
node = "first"
offset = 0
longwords = 1
[[partition]]
name = "control_1"
node = "second"
offset = 1
longwords = 1
[[partition]]
name = "ready_0"
node = "first"
offset = 1024
longwords = 1
[[partition]]
name = "ready_1"
node = "second"
offset = 1025
longwords = 1
)",
                           "dueca");
}

memmap::Map gt_map() {
  return memmap::parse_map(R"(ringmap = 1
[ring]
name = "gt"
version = 1
size_bytes = 2_097_152
[nodes]
sender = 1
receiver = 2
[[partition]]
name = "data"
node = "sender"
offset = 16
longwords = 1
[[partition]]
name = "unused"
node = "receiver"
offset = 32
longwords = 1
)",
                           "gt");
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
  [[nodiscard]] std::unique_ptr<test::Running> start_client(
      int host, const test::RingHost& ring, const std::string& node, const std::string& client,
      const std::string& api = "SCRAMNET") const {
    return start(host,
                 fmt::format("RTHS_{0}_RING={1} RTHS_{0}_NODE={2}", api, ring.ring_name(), node),
                 (test::build_tree() / "bin" / ("scramnet_" + client)).string());
  }
  /// Gateway and watch of each host.
  void connect(const test::RingHost& first, const test::RingHost& second) {
    for (const int host : {1, 2}) {
      const auto& ring = (host == 1 ? first : second).ring_name();
      const auto rths = test::rths_command();
      helpers_.push_back(start(
          host, "", fmt::format("{} bridge {} --as ring --domain 7 --interface eth0", rths, ring)));
      helpers_.push_back(start(host, "", fmt::format("{} watch {}", rths, ring)));
    }
  }
  const test::Network network_{2};
  std::vector<std::unique_ptr<test::Running>> helpers_;
};

TEST_F(VendorHosts, CompleteEveryStepOfAHandshake) {
  const int steps = test::is_long() ? 10'000 : 500;
  test::RingHost first{"first", handshake_map()}, second{"second", handshake_map()};
  connect(first, second);
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

// Each store into a control word interrupts the node of the other host.
TEST_F(VendorHosts, PassANumberAroundByInterrupts) {
  for (const std::string how : {"signal", "wait"}) {
    test::RingHost first{"first", dueca_map()}, second{"second", dueca_map()};
    connect(first, second);
    const auto one = start_client(1, first, "first", "dueca 0 2 300 " + how);
    const auto other = start_client(2, second, "second", "dueca 1 2 300 " + how);
    for (const auto* node : {&one, &other}) {
      const auto finished = (*node)->wait(50);
      EXPECT_EQ(finished.exit_code, 0) << how << ": " << finished.err;
      EXPECT_EQ(finished.out, "ok\n") << how;
    }
    helpers_.clear();
  }
}

TEST_F(VendorHosts, ReceiveEveryGtInterruptAfterItsData) {
  for (const std::string kind : {"broadcast 5", "unicast 9"}) {
    test::RingHost first{"first", gt_map()}, second{"second", gt_map()};
    connect(first, second);
    const auto receiver =
        start_client(2, second, "receiver", "gt_receiver " + kind + " 500", "SCGT");
    const auto sender =
        start_client(1, first, "sender", "gt_sender " + kind + " 500 " + kind.back(), "SCGT");
    const auto sent = sender->wait(30);
    EXPECT_EQ(sent.exit_code, 0) << kind << ": " << sent.err;
    const auto received = receiver->wait(30);
    EXPECT_EQ(received.exit_code, 0) << kind << ": " << received.err;
    EXPECT_EQ(received.out, "500 interrupts\n") << kind;
    helpers_.clear();
  }
}

}  // namespace
}  // namespace rths
