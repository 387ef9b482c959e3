// SPDX-License-Identifier: Apache-2.0
//
// A network interface that is removed while a gateway uses it.
#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hosts.hpp"
#include "support/network.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

using test::comes_true;
using test::kMachineWord;

// Receivers of DDS wait for a datagram that cannot come. Before the end, the host has tried to join
// anew.
TEST(GoneInterface, LetsTheGatewayEnd) {
  const test::Network network{2};
  if (!network.exists()) GTEST_SKIP() << "SKIPPED: network namespaces cannot be made here";
  const auto bridge = [&](int host, const std::string& ring) {
    return std::vector<std::string>{
        "/bin/sh", "-c",
        fmt::format("exec {}{} bridge {} --as joint --domain 7 --interface eth0 --host host{}",
                    network.on(host), test::rths_command(), ring, host)};
  };
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  test::Running one{bridge(1, first.ring_name())}, two{bridge(2, second.ring_name())};
  broker::Node machine = first.ring().join("machine", 0);
  const broker::Node there = second.ring().observe();
  ASSERT_EQ(machine.write(kMachineWord, 5), Status::Ok);
  ASSERT_TRUE(comes_true([&] { return there.read(kMachineWord) == 5; }, std::chrono::seconds{20}));

  test::Running remover{{"/bin/sh", "-c", network.on(1) + "ip link del eth0"}};
  ASSERT_EQ(remover.wait(10).exit_code, 0);
  std::this_thread::sleep_for(std::chrono::seconds{6});
  kill(one.pid(), SIGTERM);
  kill(two.pid(), SIGTERM);

  const auto ended = one.wait(20);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.err.find("its interface is gone"), std::string::npos) << ended.err;
  EXPECT_EQ(two.wait(20).exit_code, 0);
}

}  // namespace
}  // namespace rths
