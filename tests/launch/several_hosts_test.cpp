// SPDX-License-Identifier: Apache-2.0
//
// Experiments on several hosts: network namespaces, real sockets, one `rths run --host` on each.
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/recording/recording.hpp>

#include "dds/faulty_switch.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/network.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;

class SeveralHosts : public ::testing::Test {
 protected:
  static constexpr const char* kHosts[] = {"simulation", "control", "machine"};
  explicit SeveralHosts(bool has_switch = true) : network_{3, has_switch} {}
  void SetUp() override {
    if (!network_.exists()) GTEST_SKIP() << "SKIPPED: network namespaces cannot be made here";
  }
  [[nodiscard]] std::filesystem::path out(const std::string& host) const {
    return folder_.path() / host;
  }
  /// Starts the example on one host. All hosts share this computer's memory, so that each ring has
  /// a name of its own.
  void start(int host, const std::string& options) {
    const std::string name = kHosts[host];
    running_[name] = std::make_unique<test::Running>(std::vector<std::string>{
        "/bin/sh", "-c",
        fmt::format("exec {}{} run {} --host {} --ring hosts_{}_{} --out {} --interface eth0 "
                    "--no-diagnosis {}",
                    network_.on(host + 1), test::rths_command(),
                    (test::source_tree() / "examples/srmd_lprb_2d_hosts.toml").string(), name,
                    getpid(), name, out(name).string(), options)});
  }
  /// Options of a host in examples/containers/compose.yaml, with the addresses of this network.
  [[nodiscard]] static std::string options_in_compose_file(const std::string& host) {
    std::string text = test::content_of(test::source_tree() / "examples/containers/compose.yaml");
    const auto begin = text.find("--host, ", text.find("\n  " + host + ":"));
    text = text.substr(begin, text.find(']', begin) - begin);
    for (const auto& [from, to] :
         std::vector<std::pair<std::string, std::string>>{{",", ""},
                                                          {"\n", " "},
                                                          {"172.30.77.2", "10.77.0.1"},
                                                          {"172.30.77.3", "10.77.0.2"},
                                                          {"172.30.77.4", "10.77.0.3"},
                                                          {"--out /work/results --force", ""}})
      for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
    EXPECT_EQ(text.rfind("--host " + host + " --clock virtual", 0), 0U) << text;
    return text.substr(std::string{"--host "}.size() + host.size());
  }
  void start_all(const std::string& options) {
    for (int host = 0; host < 3; ++host) start(host, options);
  }
  [[nodiscard]] test::Finished end_of(const std::string& host, double deadline = 60) {
    return running_.at(host)->wait(deadline);
  }

  /// Runs the test on one host, too, and compares the recordings.
  void expect_bytes_of_one_host(const std::string& options) const {
    const auto alone = folder_.path() / "alone";
    const auto ended = test::Running{
        {"/bin/sh", "-c",
         fmt::format(
             "exec {} run {} --out {} --no-diagnosis {}{}", test::rths_command(),
             (test::source_tree() / "examples/srmd_lprb_2d_hosts.toml").string(), alone.string(),
             options_in_compose_file("simulation"),
             options)}}.wait(200);
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    const std::string command =
        fmt::format("h5diff --exclude-path=/meta {} {}", (out("simulation") / "run.h5").string(),
                    (alone / "run.h5").string());
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(recording::Reader{out("simulation") / "run.h5"}.rows(),
              recording::Reader{alone / "run.h5"}.rows());
  }

  const test::Network network_;
  const test::TemporaryFolder folder_;
  std::map<std::string, std::unique_ptr<test::Running>> running_;
};

TEST_F(SeveralHosts, GiveTheBytesOfOneHostInVirtualTime) {
  const std::string shorter = test::is_long() ? "" : " --set duration_s=2 --set rest_s=0.2";
  for (int host = 0; host < 3; ++host) start(host, options_in_compose_file(kHosts[host]) + shorter);
  for (const char* host : kHosts) {
    const auto ended = end_of(host, 400);
    EXPECT_EQ(ended.exit_code, 0) << host << ended.err;
    std::printf("%s: %.1f s\n", host, ended.seconds);
  }
  expect_bytes_of_one_host(shorter);
  EXPECT_FALSE(std::filesystem::exists(out("control") / "run.h5"));
}

class GarbledHosts : public SeveralHosts {
 protected:
  GarbledHosts() : SeveralHosts{false} {}
  void SetUp() override {
    SeveralHosts::SetUp();
    if (!switch_.works()) GTEST_SKIP() << "SKIPPED: packet sockets cannot be made here";
  }
  void garble(double share) {
    test::SwitchFaults faults;
    faults.garbling = share;
    switch_.set(faults);
  }
  /// Garbles half of the datagrams for a while, however fast the hosts send them.
  void garble_some() {
    const auto before = switch_.garbled();
    garble(0.5);
    EXPECT_TRUE(test::comes_true([&] { return switch_.garbled() > before + 150; }));
    garble(0);
  }
  /// True soon after the test has begun.
  [[nodiscard]] bool is_recording() const {
    return test::comes_true(
        [&] {
          std::error_code error;
          return std::filesystem::file_size(out("simulation") / "run.h5", error) > 0 && !error;
        },
        std::chrono::seconds{30});
  }
  test::FaultySwitch switch_{test::Network::ports(), 3, 20261129};
};

// Datagrams are garbled so that hosts split for good: the gateways join the network anew.
TEST_F(GarbledHosts, GiveTheBytesOfOneHostInVirtualTime) {
  const std::string shorter = " --set duration_s=4 --set rest_s=0.2";
  for (int host = 0; host < 3; ++host) start(host, options_in_compose_file(kHosts[host]) + shorter);
  ASSERT_TRUE(is_recording());
  for (int burst = 0; burst < 2; ++burst) {
    garble_some();
    std::this_thread::sleep_for(std::chrono::seconds{6});
  }
  int joined = 0;
  for (const char* host : kHosts) {
    const auto ended = end_of(host, 400);
    EXPECT_EQ(ended.exit_code, 0) << host << ended.err;
    if (ended.err.find("joins the network anew") != std::string::npos) ++joined;
    std::printf("%s: %.1f s\n", host, ended.seconds);
  }
  std::printf("%d hosts joined the network anew\n", joined);
  expect_bytes_of_one_host(shorter);
}

TEST_F(GarbledHosts, EndATestInRealTimeTogether) {
  start_all("--set duration_s=30");
  ASSERT_TRUE(is_recording());
  std::this_thread::sleep_for(std::chrono::seconds{1});
  garble(0.4);
  std::this_thread::sleep_for(std::chrono::milliseconds{2400});
  garble(0);
  for (const char* host : kHosts) {
    const auto ended = end_of(host, 20);
    EXPECT_GT(ended.exit_code, 0) << host << ended.err;
  }
  EXPECT_EQ(recording::Reader{out("simulation") / "run.h5"}.meta().count("ending"), 1U);
}

TEST_F(SeveralHosts, RunOneTestInRealTime) {
  start_all("--set duration_s=3 --set rest_s=0.5");
  for (const char* host : kHosts) {
    const auto ended = end_of(host);
    // 1: a busy computer makes the test inconclusive
    EXPECT_LE(ended.exit_code, 1) << host << ended.out << ended.err;
    EXPECT_GE(ended.exit_code, 0) << host << ended.err;
  }
  const recording::Reader run{out("simulation") / "run.h5"};
  EXPECT_EQ(run.meta().at("ending"), "completed");
  EXPECT_GT(run.rows(), 3500U);
  // Ages of all hops: of the nodes of other hosts, on each host.
  for (const char* signal : {"gateway.simulation.age.srmd", "gateway.simulation.age.xpc",
                             "gateway.control.age.opf", "gateway.machine.delay.xpc"}) {
    const auto values = run.signal(signal);
    ASSERT_FALSE(values.empty()) << signal;
    std::vector<double> sorted{values.begin() + static_cast<long>(values.size() / 2), values.end()};
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[sorted.size() / 2];
    EXPECT_GT(median, 1e-6) << signal;
    EXPECT_LT(median, 0.05) << signal;
    std::printf("%s: median %.3f ms, p99 %.3f ms\n", signal, 1e3 * median,
                1e3 * sorted[sorted.size() * 99 / 100]);
  }
}

TEST_F(SeveralHosts, ComeToRestWhenOneIsLost) {
  start_all("--set duration_s=30");
  ASSERT_TRUE(test::comes_true(
      [&] {
        return !test::children_of(running_.at("machine")->pid()).empty() &&
               std::filesystem::exists(out("simulation") / "run.h5");
      },
      std::chrono::seconds{30}));
  std::this_thread::sleep_for(std::chrono::seconds{1});
  kill(running_.at("control")->pid(), SIGKILL);
  const auto simulation = end_of("simulation", 15), machine = end_of("machine", 15);
  for (const auto& ended : {simulation, machine}) {
    EXPECT_EQ(ended.exit_code, 2) << ended.err;
    EXPECT_NE(ended.err.find("silent"), std::string::npos) << ended.err;
  }
  EXPECT_EQ(recording::Reader{out("simulation") / "run.h5"}.meta().count("ending"), 1U);
}

TEST_F(SeveralHosts, SayWhichOneIsMissing) {
  start(0, "--set network.deadline_s=2");
  const auto ended = end_of("simulation", 20);
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("host 'control', 'machine' not ready after 2 s"), std::string::npos)
      << ended.err;
}

TEST_F(SeveralHosts, RefuseAnotherExperiment) {
  start(0, "");
  start(1, "--set seed=7");
  for (const char* host : {"simulation", "control"}) {
    const auto ended = end_of(host, 20);
    EXPECT_EQ(ended.exit_code, 2);
    EXPECT_NE(ended.err.find("runs another experiment"), std::string::npos) << ended.err;
  }
}

TEST_F(SeveralHosts, NameAHostWithAnotherMap) {
  start(0, "--set network.deadline_s=2");
  start(1, "--set network.deadline_s=2 --set node.xpc.tune.inverse.enabled=0");
  const auto ended = end_of("simulation", 20);
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("host 'control' has another map"), std::string::npos) << ended.err;
}

TEST(SeveralHostsOnTheCommandLine, RefuseAnUnknownName) {
  const auto ended =
      test::run_rths({"run", (test::source_tree() / "examples/srmd_lprb_2d_hosts.toml").string(),
                      "--host", "lab"});
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_NE(ended.err.find("has no host 'lab', expected one of control, machine, simulation"),
            std::string::npos)
      << ended.err;
}

}  // namespace
}  // namespace rths::launch
