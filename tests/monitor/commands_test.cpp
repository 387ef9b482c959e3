// SPDX-License-Identifier: Apache-2.0
//
// `rths view`, `rths top` and `rths run --view` as commands.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "monitor/laboratory.hpp"
#include "monitor/web_socket.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::monitor {
namespace {

using test::Laboratory;
using test::run_rths;
using test::unique_ring;

TEST(Top, PrintsTheStateOnce) {
  const Laboratory laboratory{unique_ring("top")};

  const auto text = run_rths({"top", unique_ring("top"), "--once"});
  const auto json = run_rths({"top", unique_ring("top"), "--once", "--format", "json"});

  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_NE(text.out.find("xpc            alive"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("safety layer of srmd: running"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find('\033'), std::string::npos);
  EXPECT_EQ(json.exit_code, 0);
  EXPECT_TRUE(json.out.starts_with("{\"ring\":\"")) << json.out;
}

TEST(Top, NamesTheRingThatIsMissing) {
  const auto missing = run_rths({"top", "no_such_ring", "--once"});

  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("there is no ring 'no_such_ring'"), std::string::npos) << missing.err;
}

TEST(Top, EndsWithTheRingOrASignal) {
  std::optional<Laboratory> laboratory{std::in_place, unique_ring("end_of_top")};
  test::Running first{{test::rths_command(), "top", unique_ring("end_of_top")}};
  test::Running second{{test::rths_command(), "top", unique_ring("end_of_top")}};
  std::this_thread::sleep_for(std::chrono::milliseconds{800});

  kill(first.pid(), SIGINT);
  EXPECT_EQ(first.wait(20).exit_code, 0);
  laboratory.reset();
  const auto ended = second.wait(20);

  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_NE(ended.out.find("the ring has ended"), std::string::npos) << ended.out;
}

TEST(View, PrintsItsAddressAndThePortToForward) {
  const std::string port = std::to_string(test::free_port());
  setenv("SSH_CONNECTION", "192.0.2.1 50000 192.0.2.2 22", 1);

  const auto view = run_rths({"view", unique_ring("none"), "--port", port, "--timeout", "300"});

  unsetenv("SSH_CONNECTION");
  EXPECT_EQ(view.exit_code, 0) << view.err;
  EXPECT_EQ(view.out, "view      http://127.0.0.1:" + port + "/\nover ssh  forward port " + port +
                          ": ssh -L " + port + ":127.0.0.1:" + port + " HOST\n");
}

TEST(View, LeavesNoTraceOnTheRing) {
  const Laboratory laboratory{unique_ring("trace")};
  const auto port = test::free_port();
  test::Running view{
      {test::rths_command(), "view", unique_ring("trace"), "--port", std::to_string(port)}};
  std::string page;
  for (int i = 0; i < 500 && page.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
    page = test::http_get(port, "/");
  }

  EXPECT_NE(page.find("rths view"), std::string::npos);
  const auto report = broker::inspect_ring(unique_ring("trace"));
  for (const auto& occupant : report->occupants) EXPECT_EQ(occupant.pid, getpid());
  kill(view.pid(), SIGINT);
  EXPECT_EQ(view.wait(20).exit_code, 0);
}

TEST(View, IsServedByARun) {
  const test::TemporaryFolder folder;
  const auto run = run_rths({"run", (test::source_tree() / "examples/srmd_lprb_2d.toml").string(),
                             "--view", "--no-diagnosis", "--set", "duration_s=2", "--ring",
                             unique_ring("run"), "--out", (folder.path() / "out/run").string()},
                            100);

  EXPECT_NE(run.err.find("view      http://127.0.0.1:"), std::string::npos) << run.err;
  const auto refused =
      run_rths({"run", "examples/srmd_lprb_2d.toml", "--view", "--clock", "virtual"});
  EXPECT_EQ(refused.exit_code, 3);
}

}  // namespace
}  // namespace rths::monitor
