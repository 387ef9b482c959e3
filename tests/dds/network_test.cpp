// SPDX-License-Identifier: Apache-2.0
//
// `rths bridge` between two hosts: network namespaces with a cable between them, and real sockets.
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include <gtest/gtest.h>

#include "hosts.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using test::becomes_true;
using test::kMachineWord;

/// Two network namespaces, 10.77.0.1 and 10.77.0.2, removed at the end.
class TwoHosts : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string script = "set -e; ip netns add " + name(1) + "; ip netns add " + name(2) +
                               "; ip link add " + link(1) + " netns " + name(1) +
                               " type veth peer name " + link(2) + " netns " + name(2);
    if (std::system(("(" + script + ") >/dev/null 2>&1").c_str()) != 0)
      GTEST_SKIP() << "SKIPPED: network namespaces cannot be made here";
    for (const int i : {1, 2})
      ASSERT_EQ(std::system((in(i) + "sh -c 'ip link set lo up; ip addr add 10.77.0." +
                             std::to_string(i) + "/24 dev " + link(i) + "; ip link set " + link(i) +
                             " up'")
                                .c_str()),
                0);
  }
  void TearDown() override {
    for (const int i : {1, 2})
      if (std::system(("ip netns del " + name(i) + " >/dev/null 2>&1").c_str()) != 0) continue;
  }
  static std::string name(int host) {
    return "rths" + std::to_string(getpid()) + "_" + std::to_string(host);
  }
  static std::string link(int host) {
    return "v" + std::to_string(getpid() % 100'000) + "_" + std::to_string(host);
  }
  static std::string in(int host) { return "ip netns exec " + name(host) + " "; }

  // `ip netns exec` becomes the command, so it has the process id.
  static std::vector<std::string> bridge(int host, const std::string& ring,
                                         const std::string& more = "") {
    return {"/bin/sh", "-c",
            "exec " + in(host) + test::rths_command() + " bridge " + ring +
                " --as joint --domain 7 --interface " + link(host) + " --host host" +
                std::to_string(host) + " " + more};
  }
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
  ASSERT_TRUE(becomes_true([&] { return there.read(kMachineWord) == 5; }, 20));
  broker::Node controller = second.ring().join("controller", 0);
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    ASSERT_EQ(controller.write(test::kControllerWord, i), Status::Ok);
    ASSERT_TRUE(becomes_true([&] { return here.read(test::kControllerWord) == i; })) << i;
    ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);
    ASSERT_TRUE(becomes_true([&] { return there.read(kMachineWord) == i; })) << i;
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
  EXPECT_TRUE(becomes_true([&] { return there.read(kMachineWord) == 9; }, 20));
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
    EXPECT_TRUE(becomes_true([&] { return there.read(kMachineWord) == 10 * round; }, 20)) << round;
    kill(one.pid(), SIGKILL);
    ASSERT_EQ(machine.write(kMachineWord, 10 * round + 1), Status::Ok);
  }
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
