// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "vendor_ring.hpp"

namespace rths::test {

/// A ring of a run, with programs written for the cards beside it.
class RingUse : public VendorRing {
 protected:
  void SetUp() override { use(name); }
  void TearDown() override {
    for (const char* variable : {"RTHS_SCRAMNET_NODE", "RTHS_SCRAMNET_SHARE"}) unsetenv(variable);
    broker::remove_ring(name);
    use(ring());
  }
  static void be_node(const std::string& node) { setenv("RTHS_SCRAMNET_NODE", node.c_str(), 1); }
  /// A client that stores two words and ends.
  static Finished run_client() { return Running{client("peer", {"40", "2", "0"})}.wait(); }
  /// Starts a client that stays on the ring, and waits until it is there.
  [[nodiscard]] std::unique_ptr<Running> start_client(const std::string& node) const {
    auto started = std::make_unique<Running>(client("peer", {"40", "900", "20000"}));
    for (int i = 0; i < 5000 && !is_on_ring(node, started->pid()); ++i) usleep(1000);
    EXPECT_TRUE(is_on_ring(node, started->pid()));
    return started;
  }
  [[nodiscard]] bool is_on_ring(const std::string& node, int pid) const {
    const auto report = broker::inspect_ring(name);
    if (!report || report->cards == 0) return false;
    for (const auto& occupant : report->occupants)
      if (occupant.node == node && occupant.pid == pid) return true;
    return false;
  }

  std::string name = ring() + "_use";
};

}  // namespace rths::test
