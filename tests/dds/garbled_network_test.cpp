// SPDX-License-Identifier: Apache-2.0
//
// `rths bridge` on three hosts whose switch garbles, loses and repeats datagrams or cuts hosts off.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "faulty_switch.hpp"
#include "hosts.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/network.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

constexpr int kHosts = 3;
constexpr std::uint64_t kSeedOfFaults = 20261129;
constexpr Duration kEqualWithin = std::chrono::seconds{5};
constexpr Duration kNoticed = std::chrono::milliseconds{1500};  // a silent host, by the others

LongwordOffset word_of(int host) { return LongwordOffset{static_cast<std::uint32_t>(16 * host)}; }

memmap::Map map_of_three() {
  std::string text =
      "ringmap = 1\n[ring]\nname = \"three\"\nversion = 1\nsize_bytes = 8192\n[nodes]\n";
  for (int host = 0; host < kHosts; ++host) text += fmt::format("node{} = {}\n", host, host + 1);
  for (int host = 0; host < kHosts; ++host)
    text += fmt::format(
        "[[partition]]\nname = \"p{0}\"\nnode = \"node{0}\"\noffset = {1}\nlongwords = 4\n", host,
        16 * host);
  return memmap::parse_map(text, "three");
}

class GarbledNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!network_.exists() || !switch_.works())
      GTEST_SKIP() << "SKIPPED: network namespaces and packet sockets cannot be made here";
    for (int host = 0; host < kHosts; ++host) {
      rings_.push_back(std::make_unique<test::RingHost>(fmt::format("host{}", host + 1), map_));
      auto& ring = rings_.back()->ring();
      readers_.push_back(ring.observe());
      writers_.push_back(ring.join(fmt::format("node{}", host), 0));
      gateways_.push_back(std::make_unique<test::Running>(
          on(host, fmt::format("bridge {} --as joint --domain 7 --interface eth0 --host host{}",
                               rings_.back()->ring_name(), host + 1))));
    }
    write_for(std::chrono::milliseconds{100});
    ASSERT_TRUE(test::comes_true([&] { return are_equal(); }, std::chrono::seconds{20}));
  }
  [[nodiscard]] std::vector<std::string> on(int host, const std::string& words) const {
    return {"/bin/sh", "-c",
            fmt::format("exec {}{} {}", network_.on(host + 1), test::rths_command(), words)};
  }
  [[nodiscard]] test::Finished doctor(int host) const {
    return test::Running{on(host, "doctor --domain 7 --interface eth0")}.wait(20);
  }
  void write_for(Duration duration) {
    const WallClock clock;
    const TimePoint end = clock.now() + duration;
    while (clock.now() < end) {
      ++value_;
      for (int host = 0; host < kHosts; ++host)
        ASSERT_EQ(writers_[static_cast<std::size_t>(host)].write(word_of(host), value_),
                  Status::Ok);
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
  }
  [[nodiscard]] bool are_equal() const {
    return std::all_of(readers_.begin(), readers_.end(), [&](const auto& reader) {
      for (int host = 0; host < kHosts; ++host)
        if (reader.read(word_of(host)) != value_) return false;
      return true;
    });
  }
  /// Ends the faults. @returns the time until all images are equal [s]
  [[nodiscard]] double heal() {
    switch_.set({});
    write_for(std::chrono::milliseconds{20});
    const WallClock clock;
    const TimePoint begun = clock.now();
    EXPECT_TRUE(test::comes_true([&] { return are_equal(); }, kEqualWithin));
    return to_seconds(clock.now() - begun);
  }
  /// What the gateways print when they end.
  [[nodiscard]] std::string end() {
    std::string text;
    for (auto& gateway : gateways_) kill(gateway->pid(), SIGTERM);
    for (auto& gateway : gateways_) {
      const auto ended = gateway->wait(20);
      EXPECT_EQ(ended.exit_code, 0) << ended.err;
      text += ended.err + ended.out;
    }
    return text;
  }

  const memmap::Map map_ = map_of_three();
  const test::Network network_{kHosts, false};
  test::FaultySwitch switch_{test::Network::ports(), kHosts, kSeedOfFaults};
  std::vector<std::unique_ptr<test::RingHost>> rings_;
  std::vector<broker::Node> readers_, writers_;
  std::vector<std::unique_ptr<test::Running>> gateways_;
  std::uint32_t value_ = 0;
};

TEST_F(GarbledNetwork, IsJoinedAnewAfterItSplitForGood) {
  std::vector<double> times;
  const int rounds = test::is_long() ? 20 : 3;
  for (int round = 0; round < rounds; ++round) {
    test::SwitchFaults faults;
    faults.garbling = 0.3;
    switch_.set(faults);
    ASSERT_NO_FATAL_FAILURE(write_for(std::chrono::milliseconds{2400}));
    times.push_back(heal());
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
  const auto healthy = doctor(0);
  EXPECT_EQ(healthy.exit_code, 0) << healthy.out;
  const std::string text = end();
  EXPECT_NE(text.find("this host joins the network anew"), std::string::npos) << text;
  std::printf("seed %llu: %llu datagrams garbled; equal after at most %.2f s\n",
              static_cast<unsigned long long>(kSeedOfFaults),
              static_cast<unsigned long long>(switch_.garbled()),
              *std::max_element(times.begin(), times.end()));
}

TEST_F(GarbledNetwork, IsExaminedByTheDoctorWhileAHostIsCutOff) {
  EXPECT_EQ(doctor(0).exit_code, 0);
  test::SwitchFaults faults;
  faults.cut = {3};
  switch_.set(faults);
  std::this_thread::sleep_for(kNoticed);
  const auto here = doctor(0), there = doctor(2);
  EXPECT_EQ(here.exit_code, 1) << here.out;
  EXPECT_NE(here.out.find("host 'host1' has received nothing of host 'host3' for"),
            std::string::npos)
      << here.out;
  EXPECT_EQ(there.exit_code, 1) << there.out;
  EXPECT_NE(there.out.find("host 'host3' has received nothing of host 'host1' for"),
            std::string::npos)
      << there.out;
  static_cast<void>(heal());
  EXPECT_EQ(doctor(0).exit_code, 0);

  kill(gateways_[1]->pid(), SIGTERM);
  EXPECT_EQ(gateways_[1]->wait(10).exit_code, 0);
  std::this_thread::sleep_for(kNoticed);
  const auto left = doctor(0);
  EXPECT_EQ(left.exit_code, 0) << "a host that ended in order is no fault: " << left.out;
  gateways_.erase(gateways_.begin() + 1);
}

// A firewall does this: only the announcement of DDS itself comes through.
TEST_F(GarbledNetwork, IsExaminedByTheDoctorWhileAHostIsDeaf) {
  test::SwitchFaults faults;
  faults.deaf = {3};
  switch_.set(faults);
  std::this_thread::sleep_for(std::chrono::seconds{4});
  const auto here = doctor(0), there = doctor(2);
  EXPECT_EQ(here.exit_code, 1) << here.out;
  EXPECT_NE(here.out.find("host 'host3'"), std::string::npos) << here.out;
  EXPECT_EQ(there.exit_code, 1) << there.out;
  EXPECT_NE(there.out.find("host 'host3' has received nothing of host 'host1' for"),
            std::string::npos)
      << there.out;
  ASSERT_NO_FATAL_FAILURE(write_for(std::chrono::milliseconds{20}));
  EXPECT_TRUE(test::comes_true([&] { return readers_[0].read(word_of(1)) == value_; }))
      << "the other hosts remain in contact";
  static_cast<void>(heal());
  EXPECT_EQ(doctor(0).exit_code, 0);
}

TEST_F(GarbledNetwork, IsExaminedByTheDoctorWhileTwoHostsAreApart) {
  test::SwitchFaults faults;
  faults.apart = {{1, 2}};
  switch_.set(faults);
  std::this_thread::sleep_for(kNoticed);
  const auto examined = doctor(2);
  EXPECT_EQ(examined.exit_code, 1) << examined.out;
  EXPECT_TRUE(examined.out.find("hosts 'host1' and 'host2' do not receive each other") !=
                  std::string::npos ||
              examined.out.find("hosts 'host2' and 'host1' do not receive each other") !=
                  std::string::npos)
      << examined.out;
  EXPECT_EQ(examined.out.find("host3' "), std::string::npos) << examined.out;
  static_cast<void>(heal());
  EXPECT_EQ(doctor(2).exit_code, 0);
}

/// Faults of a random kind and strength.
test::SwitchFaults draw_faults(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share{0.02, 0.4};
  test::SwitchFaults faults;
  const auto kinds = 1 + random() % 31;
  if ((kinds & 1U) != 0) faults.garbling = share(random);
  if ((kinds & 2U) != 0) faults.loss = share(random);
  if ((kinds & 4U) != 0) faults.cut.insert(static_cast<int>(1 + random() % kHosts));
  if ((kinds & 8U) != 0) faults.duplication = faults.reordering = share(random);
  if ((kinds & 16U) != 0) faults.deaf.insert(static_cast<int>(1 + random() % kHosts));
  return faults;
}

TEST_F(GarbledNetwork, HasEqualImagesSoonAfterRandomFaults) {
  const Duration total = std::chrono::seconds{test::is_long() ? 600 : 15};
  const char* const other = std::getenv("RTHS_SEED");
  const std::uint64_t seed = other == nullptr ? kSeedOfFaults : std::strtoull(other, nullptr, 10);
  std::mt19937_64 random{seed};
  std::uniform_int_distribution<int> steps{1, 3}, duration{300, 4000};  // [ms]
  const WallClock clock;
  const TimePoint end_of_test = clock.now() + total;
  std::vector<double> times;
  int examined = 0;
  while (clock.now() < end_of_test) {
    for (int step = steps(random); step > 0; --step) {
      const auto faults = draw_faults(random);
      switch_.set(faults);
      ASSERT_NO_FATAL_FAILURE(write_for(std::chrono::milliseconds{duration(random)}));
    }
    times.push_back(heal());
    ASSERT_FALSE(HasFailure()) << "seed " << seed << ", sequence " << times.size();
    if (times.size() % 4 != 1) continue;
    const auto healthy = doctor(static_cast<int>(random() % kHosts));
    EXPECT_EQ(healthy.exit_code, 0) << "sequence " << times.size() << ": " << healthy.out;
    ++examined;
  }
  std::sort(times.begin(), times.end());
  std::printf(
      "seed %llu: %zu sequences, %llu datagrams garbled, %d times examined; equal after "
      "%.2f s (median), at most %.2f s\n",
      static_cast<unsigned long long>(kSeedOfFaults), times.size(),
      static_cast<unsigned long long>(switch_.garbled()), examined, times[times.size() / 2],
      times.back());
  const std::string text = end();
  for (std::size_t at = 0; (at = text.find("joined the network anew ", at)) != std::string::npos;
       ++at)
    std::printf("  %s\n", text.substr(at, text.find('\n', at) - at).c_str());
}

// The switch of strangers, where present: 10 % of the datagrams are garbled for 2.4 s.
TEST(GarbledNetworkOfStrangers, HasOneImageAgain) {
  const auto data = test::source_tree() / "../shared/data/strangers/multi_host";
  if (!std::filesystem::exists(data) || access("/dev/net/tun", R_OK | W_OK) != 0)
    GTEST_SKIP() << "SKIPPED: there is no ../shared/data/strangers or /dev/net/tun";
  if (test::Running{{"/bin/sh", "-c", "unshare -m true"}}.wait(10).exit_code != 0)
    GTEST_SKIP() << "SKIPPED: mount namespaces cannot be made here";
  const test::TemporaryFolder folder;
  std::filesystem::copy(data, folder.path());
  const auto library = (test::build_tree() / "broker/scramnet").string();
  std::ofstream{folder.path() / "test.sh"} << fmt::format(
      R"(set -e
export PATH={rths}:$PATH RTHS=rths
cc -w peer.c -I{source}/broker/scramnet/include/scramnet -L{library} -Wl,-rpath,{library} -lplus -o peer
mkdir -p /run/netns
mount -t tmpfs tmpfs /run/netns
for i in 1 2 3; do ip netns add h$i; done
echo "0 0 0 0" > ctl
python3 switch.py & switch=$!
for i in $(seq 100); do [ -e ready ] || sleep .1; done
for i in 1 2 3; do
  nsenter --net=/run/netns/h$i unshare -m sh -c "mount -t tmpfs tmpfs /dev/shm && exec sleep 1000" & others="$others $!"
  echo $! > ns$i.pid
done
sleep .5
sed -i 's/-n -m /-n -m --wd=. /' run.sh
. ./run.sh
for i in 1 2 3; do
  on $i rths bridge three --map ./three.ringmap.toml --domain 7 --interface tp$i --host h$i > br$i.log 2>&1 & others="$others $!"
done
sleep 2
for i in 1 2 3; do on $i rths watch three > watch$i.log 2>&1 & others="$others $!"; done
sleep 1
bash wedge.sh "0 0.1 0 0"
on 1 rths doctor --domain 7 --interface tp1 || echo "the doctor names a fault"
kill $others $switch
)",
      fmt::arg("rths", std::filesystem::path{test::rths_command()}.parent_path().string()),
      fmt::arg("source", test::source_tree().string()), fmt::arg("library", library));

  const auto ended =
      test::Running{{"/bin/sh", "-c",
                     fmt::format("cd {} && exec unshare -m -n -p --fork --kill-child --mount-proc "
                                 "sh -c 'ip link set lo up; mount "
                                 "--make-rprivate /; exec bash test.sh'",
                                 folder.path().string())}}
          .wait(100);

  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  for (int host = 1; host <= kHosts; ++host)
    EXPECT_NE(ended.out.find(fmt::format("15 s later h{} 200 200 200 200 200 200", host)),
              std::string::npos)
        << ended.out << ended.err;
  EXPECT_EQ(ended.out.find("the doctor names a fault"), std::string::npos) << ended.out;
}

}  // namespace
}  // namespace rths
