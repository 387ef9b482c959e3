// SPDX-License-Identifier: Apache-2.0
//
// `rths bridge` between two hosts: network namespaces with a cable between them, and real sockets.
#include <csignal>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hosts.hpp"
#include "support/network.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using test::comes_true;
using test::kMachineWord;

class TwoHosts : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!network_.exists()) GTEST_SKIP() << "SKIPPED: network namespaces cannot be made here";
  }
  [[nodiscard]] std::vector<std::string> bridge(int host, const std::string& ring,
                                                const std::string& more = "") const {
    return {
        "/bin/sh", "-c",
        fmt::format("exec {}{} bridge {} --as joint --domain 7 --interface eth0 --host host{} {}",
                    network_.on(host), test::rths_command(), ring, host, more)};
  }
  const test::Network network_{2};
};

TEST_F(TwoHosts, HaveOneRing) {
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  broker::Node machine = first.ring().join("machine", 0);
  const broker::Node there = second.ring().observe();
  const broker::Node here = first.ring().observe();
  test::Running one{bridge(1, first.ring_name())};
  test::Running two{bridge(2, second.ring_name())};

  ASSERT_EQ(machine.write(kMachineWord, 5), Status::Ok);
  ASSERT_TRUE(comes_true([&] { return there.read(kMachineWord) == 5; }, std::chrono::seconds{20}));
  broker::Node controller = second.ring().join("controller", 0);
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    ASSERT_EQ(controller.write(test::kControllerWord, i), Status::Ok);
    ASSERT_TRUE(comes_true([&] { return here.read(test::kControllerWord) == i; })) << i;
    ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);
    ASSERT_TRUE(comes_true([&] { return there.read(kMachineWord) == i; })) << i;
  }
  kill(one.pid(), SIGTERM);
  kill(two.pid(), SIGTERM);
  const auto ended = one.wait(10);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  // The first write may precede the gateway; then a snapshot brings it.
  EXPECT_TRUE(ended.out.find("sent 1000 updates") != std::string::npos ||
              ended.out.find("sent 1001 updates") != std::string::npos)
      << ended.out;
  EXPECT_NE(ended.err.find("host 'host2' is here"), std::string::npos) << ended.err;
  EXPECT_EQ(two.wait(10).exit_code, 0);
}

TEST_F(TwoHosts, FindEachOtherWithoutMulticast) {
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  broker::Node machine = first.ring().join("machine", 0);
  const broker::Node there = second.ring().observe();
  test::Running one{bridge(1, first.ring_name(), "--peer 10.77.0.2")};
  test::Running two{bridge(2, second.ring_name(), "--peer 10.77.0.1")};
  ASSERT_EQ(machine.write(kMachineWord, 9), Status::Ok);
  EXPECT_TRUE(comes_true([&] { return there.read(kMachineWord) == 9; }, std::chrono::seconds{20}));
}

TEST_F(TwoHosts, ConvergeAfterAGatewayIsKilled) {
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  broker::Node machine = first.ring().join("machine", 0);
  const broker::Node there = second.ring().observe();
  test::Running two{bridge(2, second.ring_name())};
  for (std::uint32_t round = 1; round <= 3; ++round) {
    test::Running one{bridge(1, first.ring_name())};
    ASSERT_EQ(machine.write(kMachineWord, 10 * round), Status::Ok);
    EXPECT_TRUE(comes_true([&] { return there.read(kMachineWord) == 10 * round; },
                           std::chrono::seconds{20}))
        << round;
    kill(one.pid(), SIGKILL);
    ASSERT_EQ(machine.write(kMachineWord, 10 * round + 1), Status::Ok);
  }
}

TEST_F(TwoHosts, AreHeardByTheDoctor) {
  test::RingHost first{"first", test::small_map()};
  const broker::Node machine = first.ring().join("machine", 0);
  test::Running one{bridge(1, first.ring_name())};
  test::Running doctor{{"/bin/sh", "-c",
                        fmt::format("exec {}{} doctor --domain 7 --interface eth0", network_.on(2),
                                    test::rths_command())}};
  const auto heard = doctor.wait(20);
  EXPECT_EQ(heard.exit_code, 0) << heard.err;
  EXPECT_NE(heard.out.find("eth0         10.77.0.2        up, multicast, MTU "), std::string::npos)
      << heard.out;
  EXPECT_NE(heard.out.find("host 'host1': 1 nodes, map " +
                           memmap::hash_text(first.ring().map().hash()) + ", clock known to 0."),
            std::string::npos)
      << heard.out;
  kill(one.pid(), SIGTERM);
  EXPECT_EQ(one.wait(10).err, "") << "the doctor is no host";

  test::Running alone{{"/bin/sh", "-c",
                       fmt::format("exec {}{} doctor --domain 9 --interface eth0", network_.on(2),
                                   test::rths_command())}};
  const auto nothing = alone.wait(20);
  EXPECT_EQ(nothing.exit_code, 1) << nothing.err;
  EXPECT_NE(nothing.out.find("no gateway was heard within 2 s"), std::string::npos) << nothing.out;
  EXPECT_NE(nothing.out.find("UDP ports 9650 to 9899"), std::string::npos) << nothing.out;
}

TEST_F(TwoHosts, NameAnInterfaceThatIsNotThere) {
  test::RingHost first{"first", test::small_map()};
  test::Running one{
      {test::rths_command(), "bridge", first.ring_name(), "--interface", "no_such_if"}};
  const auto ended = one.wait(20);
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("no_such_if"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace rths
