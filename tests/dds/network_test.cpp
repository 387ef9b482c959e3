// SPDX-License-Identifier: Apache-2.0
//
// `rths bridge` between two hosts: network namespaces with a cable between them, and real sockets.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hosts.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
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
  [[nodiscard]] std::vector<std::string> doctor_command(int host) const {
    return {"/bin/sh", "-c",
            fmt::format("exec {}{} doctor --domain 7 --interface eth0", network_.on(host),
                        test::rths_command())};
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

// The files in examples/cyclone, without any option. All gateways of the loopback are on one host.
TEST_F(TwoHosts, HaveOneRingWithEachShippedProfile) {
  for (const std::string profile : {"loopback", "switch", "peers", "containers"}) {
    const memmap::Map map = test::small_map();
    test::RingHost first{"first", map}, second{"second", map};
    const auto gateway = [&](int host, const std::string& ring) {
      const auto file = test::source_tree() / "examples/cyclone" / (profile + ".xml");
      return test::Running{
          {"/bin/sh", "-c",
           fmt::format("CYCLONEDDS_URI=file://{} exec {}{} bridge {} --as joint --domain 7",
                       file.string(), network_.on(profile == "loopback" ? 1 : host),
                       test::rths_command(), ring)}};
    };
    broker::Node machine = first.ring().join("machine", 0);
    const broker::Node there = second.ring().observe();
    test::Running one = gateway(1, first.ring_name()), two = gateway(2, second.ring_name());
    for (std::uint32_t i = 1; i <= 100; ++i) ASSERT_EQ(machine.write(kMachineWord, i), Status::Ok);
    EXPECT_TRUE(
        comes_true([&] { return there.read(kMachineWord) == 100; }, std::chrono::seconds{20}))
        << profile;
    kill(one.pid(), SIGTERM);
    const auto ended = one.wait(10);
    EXPECT_EQ(ended.exit_code, 0) << profile << ": " << ended.err;
    EXPECT_EQ(ended.err.find("config"), std::string::npos) << profile << ": " << ended.err;
  }
}

TEST_F(TwoHosts, RefuseAProfileThatIsNotThere) {
  test::RingHost first{"first", test::small_map()};
  setenv("CYCLONEDDS_URI", "file:///nowhere.xml", 1);
  const auto refused = test::Running{bridge(1, first.ring_name())}.wait(10);
  unsetenv("CYCLONEDDS_URI");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("CYCLONEDDS_URI, which is 'file:///nowhere.xml'"), std::string::npos)
      << refused.err;
}

// Iceoryx would end the process after a minute, as there is no RouDi.
TEST_F(TwoHosts, IgnoreTheSharedMemoryOfOtherSoftware) {
  const std::string enabled =
      "<CycloneDDS><Domain Id=\"any\"><SharedMemory><Enable>true</Enable></SharedMemory></Domain>"
      "</CycloneDDS>";
  const std::string of_domain =
      "<CycloneDDS><Domain Id=\"7\"><SharedMemory><Enable>true</Enable><LogLevel>info</LogLevel>"
      "</SharedMemory></Domain></CycloneDDS>";
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "ros.xml").string();
  std::ofstream{file} << enabled;
  const test::RingRemoval removal{test::unique_ring("dds_ros")};
  for (const auto& setting : {enabled, of_domain, "file://" + file}) {
    setenv("CYCLONEDDS_URI", setting.c_str(), 1);
    const auto bridged =
        test::Running{bridge(1, removal.name, "--map srmd --timeout 300")}.wait(20);
    EXPECT_EQ(bridged.exit_code, 0) << setting << bridged.err;
    EXPECT_EQ(test::run_rths({"doctor"}).out.find(removal.name), std::string::npos);
    const auto examined = test::Running{doctor_command(2)}.wait(20);
    EXPECT_EQ(examined.exit_code, 1) << setting << examined.err;
    EXPECT_NE(examined.out.find("no gateway answered"), std::string::npos) << examined.err;
    const auto run =
        test::Running{
            {"/bin/sh", "-c",
             fmt::format("exec {}{} run {} --host control --ring {} --out {} --interface eth0 "
                         "--no-diagnosis --set network.deadline_s=1",
                         network_.on(1), test::rths_command(),
                         (test::source_tree() / "examples/srmd_lprb_2d_hosts.toml").string(),
                         removal.name, (folder.path() / "out").string())}}
            .wait(20);
    EXPECT_EQ(run.exit_code, 2) << setting << run.out << run.err;
    EXPECT_NE(run.err.find("not ready after 1 s"), std::string::npos) << run.err;
    std::filesystem::remove_all(folder.path() / "out");
  }
  unsetenv("CYCLONEDDS_URI");
}

// The sockets of a process: lines of `ss`.
std::vector<std::string> sockets_of(int host, int pid) {
  const auto listed =
      test::Running{{"/bin/sh", "-c", test::Network::on(host) + "ss -lunpH"}}.wait(10);
  std::istringstream lines{listed.out};
  std::vector<std::string> sockets;
  for (std::string line; std::getline(lines, line);)
    if (line.find(fmt::format("pid={},", pid)) != std::string::npos) sockets.push_back(line);
  return sockets;
}

// Names of the interfaces of a host that are in the multicast group of discovery, 239.255.0.1.
std::set<std::string> interfaces_in_group(int host) {
  const auto listed =
      test::Running{{"/bin/sh", "-c", test::Network::on(host) + "cat /proc/net/igmp"}}.wait(10);
  std::istringstream lines{listed.out};
  std::set<std::string> interfaces;
  std::string interface;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::string first, second;
    words >> first >> second;
    if (line[0] != '\t') interface = second;
    if (first == "0100FFEF") interfaces.insert(interface);
  }
  return interfaces;
}

TEST_F(TwoHosts, ReceiveOnlyOnTheStatedInterface) {
  ASSERT_TRUE(test::Network::configure(1, "link add eth1 type veth peer name eth1_peer") &&
              test::Network::configure(1, "addr add 10.78.0.1/24 dev eth1") &&
              test::Network::configure(1, "link set eth1 up") &&
              test::Network::configure(1, "link set eth1_peer up"));
  const test::RingHost first{"first", test::small_map()};
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "interface.xml").string();
  std::ofstream{file} << "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface "
                         "name=\"eth1\"/></Interfaces></General></Domain></CycloneDDS>";
  const std::vector<std::array<std::string, 3>> cases{
      {"", "--interface eth1", "eth1"},
      {"", "--interface 10.78.0.1", "eth1"},
      {"", "--interface eth0", "eth0"},
      {"", "--interface eth0 --peer 10.77.0.2", "eth0"},
      {"CYCLONEDDS_URI=file://" + file, "", "eth1"},
  };
  for (const auto& [variable, options, interface] : cases) {
    const test::Running gateway{
        {"/bin/sh", "-c",
         fmt::format("{} exec {}{} bridge {} --domain 7 {}", variable, network_.on(1),
                     test::rths_command(), first.ring_name(), options)}};
    std::vector<std::string> sockets;
    ASSERT_TRUE(comes_true([&] { return (sockets = sockets_of(1, gateway.pid())).size() >= 2; }))
        << options;
    std::this_thread::sleep_for(std::chrono::milliseconds{200});
    for (const auto& socket : sockets_of(1, gateway.pid()))
      EXPECT_NE(socket.find("%" + interface + ":"), std::string::npos) << options << socket;
    if (options.find("--peer") == std::string::npos) {
      EXPECT_EQ(interfaces_in_group(1), std::set<std::string>{interface}) << options;
    }
  }
}

// Each round writes while the gateway dies at a random moment, and then measures until a new
// gateway has made the hosts equal.
TEST_F(TwoHosts, ConvergeAfterAGatewayIsKilled) {
  constexpr unsigned kSeed = 20261123;
  const int rounds = test::is_long() ? 200 : 4;
  std::mt19937 random{kSeed};
  std::uniform_int_distribution<int> moment{20, 400};  // [ms]
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  broker::Node machine = first.ring().join("machine", 0);
  broker::Node controller = second.ring().join("controller", 0);
  const broker::Node here = first.ring().observe(), there = second.ring().observe();
  const WallClock clock;
  std::vector<double> times;
  std::uint32_t value = 0;
  std::array<std::unique_ptr<test::Running>, 2> gateways;
  const auto start = [&](std::size_t side) {
    const int host = static_cast<int>(side) + 1;
    gateways[side] = std::make_unique<test::Running>(
        bridge(host, side == 0 ? first.ring_name() : second.ring_name()));
  };
  start(0);
  start(1);
  for (int round = 0; round < rounds; ++round) {
    const TimePoint death = clock.now() + std::chrono::milliseconds{moment(random)};
    while (clock.now() < death) {
      ASSERT_EQ(machine.write(kMachineWord, ++value), Status::Ok);
      ASSERT_EQ(controller.write(test::kControllerWord, value), Status::Ok);
      std::this_thread::sleep_for(std::chrono::microseconds{500});
    }
    const std::size_t side = random() % 2;
    kill(gateways[side]->pid(), SIGKILL);
    ASSERT_EQ(machine.write(kMachineWord, ++value), Status::Ok);
    ASSERT_EQ(controller.write(test::kControllerWord, value), Status::Ok);
    gateways[side].reset();
    start(side);
    const TimePoint begun = clock.now();
    ASSERT_TRUE(comes_true(
        [&] {
          return there.read(kMachineWord) == value && here.read(test::kControllerWord) == value;
        },
        std::chrono::seconds{20}))
        << round;
    times.push_back(to_seconds(clock.now() - begun));
  }
  std::sort(times.begin(), times.end());
  std::printf("seed %u: %d kills; equal after %.2f s (median), at most %.2f s\n", kSeed, rounds,
              times[times.size() / 2], times.back());
}

TEST_F(TwoHosts, ConvergeAfterTheCableWasPulled) {
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  broker::Node machine = first.ring().join("machine", 0);
  const broker::Node there = second.ring().observe();
  test::Running one{bridge(1, first.ring_name())}, two{bridge(2, second.ring_name())};
  std::uint32_t value = 0;
  const auto write_for = [&](Duration duration) {
    const WallClock clock;
    const TimePoint end = clock.now() + duration;
    while (clock.now() < end) {
      ASSERT_EQ(machine.write(kMachineWord, ++value), Status::Ok);
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
  };
  write_for(std::chrono::milliseconds{500});
  ASSERT_TRUE(comes_true([&] { return there.read(kMachineWord) == value; }));
  ASSERT_TRUE(network_.connect(2, false));
  write_for(std::chrono::seconds{test::is_long() ? 10 : 2});
  EXPECT_LT(there.read(kMachineWord), value);
  ASSERT_TRUE(network_.connect(2, true));
  const WallClock clock;
  const TimePoint begun = clock.now();
  write_for(std::chrono::milliseconds{100});
  EXPECT_TRUE(
      comes_true([&] { return there.read(kMachineWord) == value; }, std::chrono::seconds{30}));
  std::printf("equal %.2f s after the cable was back\n", to_seconds(clock.now() - begun));
}

TEST_F(TwoHosts, GetAWordOfAProgramThatEndsAtOnce) {
  const memmap::Map map = test::small_map();
  test::RingHost first{"first", map}, second{"second", map};
  test::Running one{bridge(1, first.ring_name())}, two{bridge(2, second.ring_name())};
  const broker::Node there = second.ring().observe();
  const broker::Node machine = first.ring().join("machine", 0);
  ASSERT_TRUE(comes_true([&] {
    return there.presence_of(map.node("machine")).state == broker::Presence::State::Alive;
  }));
  const auto send = [&](float value) {
    const auto sent =
        test::run_rths({"send", first.ring_name(), fmt::format("ref.long={}", value)});
    ASSERT_EQ(sent.exit_code, 0) << sent.err;
  };
  const auto arrives = [&](float value) {
    return comes_true(
        [&] { return std::bit_cast<float>(there.read(test::kControllerWord)) == value; });
  };
  for (const float value : {11.F, 12.F}) {
    send(value);
    EXPECT_TRUE(arrives(value));
  }
  // The other gateway is stopped for a while.
  kill(two.pid(), SIGSTOP);
  send(13.F);
  std::this_thread::sleep_for(std::chrono::milliseconds{700});
  kill(two.pid(), SIGCONT);
  EXPECT_TRUE(arrives(13.F));
  // It is killed, and another one begins.
  kill(two.pid(), SIGKILL);
  static_cast<void>(two.wait(5));
  send(14.F);
  std::this_thread::sleep_for(std::chrono::milliseconds{700});
  const test::Running three{bridge(2, second.ring_name())};
  EXPECT_TRUE(arrives(14.F));
}

TEST_F(TwoHosts, HaveOneGatewayEach) {
  test::RingHost first{"first", test::small_map()};
  test::Running one{bridge(1, first.ring_name())};
  const auto wait_for_it = [&] {
    return test::run_rths({"doctor"}).out.find("observer") != std::string::npos;
  };
  ASSERT_TRUE(comes_true(wait_for_it));
  test::Running another{bridge(1, first.ring_name())};
  const auto ended = another.wait(20);
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("has a gateway to domain 7 already"), std::string::npos) << ended.err;
}

// The lines "host$ command" of the page, on hosts of this test.
TEST_F(TwoHosts, AreConnectedByTheCommandsOfThePage) {
  const auto text = test::content_of(test::source_tree() / "docs/multi_host.md");
  const std::regex line{R"(\n(first|second)\$ rths ([^\n]*))"};
  const test::RingRemoval rings[]{{fmt::format("page_first_{}", getpid())},
                                  {fmt::format("page_second_{}", getpid())}};
  const test::TemporaryFolder folder;
  std::vector<std::unique_ptr<test::Running>> gateways;
  int lines = 0;
  for (auto found = std::sregex_iterator{text.begin(), text.end(), line};
       found != std::sregex_iterator{}; ++found, ++lines) {
    const std::string host = (*found)[1];
    // Both hosts share the memory of this computer, so their rings need names of their own.
    const std::string ring = fmt::format("page_{}_{}", host, getpid());
    std::string command = (*found)[2];
    const auto name = command.find(" lab");
    ASSERT_NE(name, std::string::npos) << command;
    command.replace(name, 4, " " + ring);
    const bool is_gateway = command.rfind("bridge", 0) == 0;
    if (is_gateway) command += " --as lab 2>" + (folder.path() / host).string();
    const std::vector<std::string> words{
        "/bin/sh", "-c",
        fmt::format("exec {}{} {}", network_.on(host == "first" ? 1 : 2), test::rths_command(),
                    command)};
    if (is_gateway) {
      gateways.push_back(std::make_unique<test::Running>(words));
      continue;
    }
    // As the page says, "each prints that the other host is here".
    for (const std::string gateway : {"first", "second"})
      ASSERT_TRUE(comes_true([&] {
        return test::content_of(folder.path() / gateway).find("is here") != std::string::npos;
      })) << gateway;
    ASSERT_TRUE(comes_true([&] {
      const auto ended = test::Running{words}.wait(10);
      return ended.exit_code == 0 &&
             (command.rfind("dump", 0) != 0 || ended.out.find("2.5") != std::string::npos);
    })) << command;
  }
  EXPECT_EQ(lines, 4);
}

TEST_F(TwoHosts, AreHeardByTheDoctor) {
  test::RingHost first{"first", test::small_map()};
  const broker::Node machine = first.ring().join("machine", 0);
  test::Running one{bridge(1, first.ring_name())};
  test::Running doctor{doctor_command(2)};
  const auto found = doctor.wait(20);
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_NE(found.out.find("eth0         10.77.0.2        up, multicast, MTU "), std::string::npos)
      << found.out;
  EXPECT_NE(found.out.find("host 'host1': 1 nodes, map " +
                           memmap::hash_text(first.ring().map().hash()) + ", clock known to 0."),
            std::string::npos)
      << found.out;
  kill(one.pid(), SIGTERM);
  EXPECT_EQ(one.wait(10).err, "") << "the doctor is no host";

  test::Running alone{{"/bin/sh", "-c",
                       fmt::format("exec {}{} doctor --domain 9 --interface eth0", network_.on(2),
                                   test::rths_command())}};
  const auto nothing = alone.wait(20);
  EXPECT_EQ(nothing.exit_code, 1) << nothing.err;
  EXPECT_NE(nothing.out.find("no gateway answered within 4 s"), std::string::npos) << nothing.out;
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
