// SPDX-License-Identifier: Apache-2.0
//
// Programs modelled on those written for the cards, each in a process of its own.
#include <memory>

#include <unistd.h>

#include "support/long_run.hpp"
#include "vendor_ring.hpp"

namespace {

using rths::test::Finished;
using rths::test::Running;

class Clients : public rths::test::VendorRing {
 protected:
  static std::string clients_ring() { return ring() + "_clients"; }
  void SetUp() override {
    use(clients_ring());
    rths::broker::remove_ring(clients_ring());
  }
  void TearDown() override {
    rths::broker::remove_ring(clients_ring());
    use(ring());
  }

  static void expect_ok(const std::string& name, const std::vector<std::string>& arguments = {}) {
    const Finished finished = Running{client(name, arguments)}.wait();
    EXPECT_EQ(finished.exit_code, 0) << name << ": " << finished.err;
    EXPECT_EQ(finished.out, "ok\n") << name;
  }
  /// Two nodes pass a number around the ring by interrupts.
  static void pass_round(const std::string& name, const std::string& how) {
    Running first{client(name, {"0", "2", "300", how})};
    Running second{client(name, {"1", "2", "300", how})};
    for (Running* node : {&first, &second}) {
      const Finished finished = node->wait();
      EXPECT_EQ(finished.exit_code, 0) << finished.err;
      EXPECT_EQ(finished.out, "ok\n");
    }
  }
};

TEST_F(Clients, OfEachTypeRun) {
  expect_ok("lehigh");
  expect_ok("vendor_tool");
  expect_ok("old_device");
  expect_ok("old_device_static");
}

TEST_F(Clients, CompleteEveryStepOfOpenFrescosHandshake) {
  const std::string steps = rths::test::is_long() ? "10000" : "1000";
  Running controller{client("controller")};
  Running solver{client("openfresco", {steps})};

  const Finished of_solver = solver.wait(110);
  const Finished of_controller = controller.wait(5);

  EXPECT_EQ(of_solver.exit_code, 0) << of_solver.err;
  EXPECT_EQ(of_controller.exit_code, 0) << of_controller.err;
  EXPECT_EQ(of_solver.out, steps + " steps\n");
  EXPECT_EQ(of_controller.out, steps + " steps\n");
}

TEST_F(Clients, PassANumberAroundByWaiting) { pass_round("dueca", "wait"); }
TEST_F(Clients, PassANumberAroundBySignals) { pass_round("dueca", "signal"); }
TEST_F(Clients, PassANumberAroundWhenLinkedStatically) { pass_round("dueca_static", "wait"); }

// Writes between two scans count once, but the last one always interrupts.
TEST_F(Clients, GetAnInterruptForTheLastOfManyWrites) {
  for (const std::string how : {"wait", "signal"}) {
    Running counter{client("ticks", {how})};
    Running writer{client("ticks", {"write", "200", "100"})};
    EXPECT_EQ(writer.wait().exit_code, 0);
    const Finished counted = counter.wait();
    EXPECT_EQ(counted.exit_code, 0) << counted.err;
    EXPECT_GE(std::stoi(counted.out), 1) << how;
    EXPECT_LE(std::stoi(counted.out), 200) << how;
    rths::broker::remove_ring(clients_ring());
  }
}

TEST_F(Clients, CreateOneRingWhenSeveralStartAtOnce) {
  std::vector<std::unique_ptr<Running>> starting;
  for (unsigned i = 0; i < 8; ++i)
    starting.push_back(
        std::make_unique<Running>(client("peer", {std::to_string(100 * i), "2", "20000"})));
  for (auto& process : starting) {
    const Finished finished = process->wait();
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
  }
  const auto report = rths::broker::inspect_ring(clients_ring());
  ASSERT_TRUE(report && report->usable);
  EXPECT_TRUE(report->occupants.empty());
}

TEST_F(Clients, RunTheExample) {
  const auto map = rths::test::source_tree() / "examples" / "scramnet" / "sums.ringmap.toml";
  Running sums{client("example_sums", {clients_ring(), map.string()})};
  for (int i = 0; i < 5000 && !rths::broker::inspect_ring(clients_ring()); ++i) usleep(1000);
  setenv("RTHS_SCRAMNET_NODE", "adder", 1);
  Running counter{client("example_counter")};
  unsetenv("RTHS_SCRAMNET_NODE");

  const Finished of_sums = sums.wait(20);

  EXPECT_EQ(of_sums.exit_code, 0) << of_sums.err;
  EXPECT_NE(of_sums.out.find("sum of 1 to 10: 55\n"), std::string::npos);
  EXPECT_EQ(counter.wait(5).out, "vendor's side: summed 10 numbers\n");
}

// A node of the ring reads the words that a vendor client wrote.
TEST_F(Clients, WriteWordsThatNodesOfTheRingRead) {
  const Finished finished = Running{client("peer", {"40", "2", "0"})}.wait();
  ASSERT_EQ(finished.exit_code, 0);
  auto attached = rths::broker::Ring::attach(clients_ring());
  EXPECT_EQ(attached.observe().read(rths::LongwordOffset{41}), 2U);
}

}  // namespace
