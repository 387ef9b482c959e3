// SPDX-License-Identifier: Apache-2.0
// The peers that may drive an element: the started script, the same user, or a stated address.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include <rths/adapters/opensees.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::adapters {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kWords = 256;
constexpr std::array<std::int32_t, 11> kFirstMessage{1, 1, 1, 0, 1, 0, 0, 0, 1, 0, kWords};

std::array<double, kWords> trial_of(double displacement) { return {3, displacement}; }

OpenSeesSettings one_element_at(std::uint16_t port, bool is_udp = false) {
  OpenSeesSettings settings;
  OpenSeesElement element;
  element.name = "specimen";
  element.port = port;
  element.is_udp = is_udp;
  element.is_rotation = {false};
  element.axes = {{"long", 0}};
  element.initial_stiffness = SquareMatrix::diagonal(1, 1);
  element.damping = element.mass = SquareMatrix::diagonal(1, 0);
  settings.elements = {element};
  settings.layout.commands = {{"opf.long", "long", OpfQuantity::Displacement, "m"}};
  settings.layout.feedbacks = {{"daq.long", "long", OpfQuantity::Force, "N"}};
  return settings;
}

/// A client at an address of this host that sends its sizes and a trial.
class PeerClient {
 public:
  explicit PeerClient(std::uint16_t port, bool is_udp = false, const char* address = "127.0.0.1",
                      double displacement = 0.01)
      : fd_{socket(AF_INET, is_udp ? SOCK_DGRAM : SOCK_STREAM, 0)} {
    sockaddr_in own{}, server{};
    own.sin_family = server.sin_family = AF_INET;
    inet_pton(AF_INET, address, &own.sin_addr);
    bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own);
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connect(fd_, reinterpret_cast<const sockaddr*>(&server), sizeof server);
    if (is_udp) send_bytes("a", 1);
    const auto sent = trial_of(displacement);
    send_bytes(kFirstMessage.data(), sizeof kFirstMessage);
    send_bytes(sent.data(), sizeof sent);
  }
  ~PeerClient() { close(fd_); }
  PeerClient(const PeerClient&) = delete;
  PeerClient& operator=(const PeerClient&) = delete;

  /// Whether the server has closed the connection.
  [[nodiscard]] bool is_closed() const {
    pollfd readable{fd_, POLLIN, 0};
    char byte = 0;
    return poll(&readable, 1, 2000) == 1 && recv(fd_, &byte, 1, 0) <= 0;
  }

 private:
  void send_bytes(const void* bytes, std::size_t size) const {
    static_cast<void>(send(fd_, bytes, size, MSG_NOSIGNAL));
  }
  int fd_;
};

/// The adapter at rest, with a controller that is ready for a target.
class OneElement {
 public:
  explicit OneElement(const OpenSeesSettings& settings) : adapter_{make_opensees(settings)} {
    outputs_.resize(adapter_->ports().size() - inputs_.size());
    adapter_->activate();
  }
  ~OneElement() {
    try {
      adapter_->deactivate();
    } catch (const Error&) {  // the script is killed here
    }
  }
  OneElement(const OneElement&) = delete;
  OneElement& operator=(const OneElement&) = delete;

  /// Steps until a target is posted, up to a time. @returns the status of the last step
  Status run(milliseconds longest = milliseconds{300}) {
    const auto end = std::chrono::steady_clock::now() + longest;
    Status status = Status::Ok;
    while (status == Status::Ok && !has_target() && std::chrono::steady_clock::now() < end) {
      StepData step{time_ += 1e-6, 0, false, inputs_, outputs_};
      status = adapter_->step(step);
      message_ = step.message;
      std::this_thread::sleep_for(milliseconds{1});
    }
    return status;
  }
  [[nodiscard]] bool has_target() const { return outputs_[1] > 0; }
  [[nodiscard]] double target() const { return outputs_[0]; }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  std::unique_ptr<Adapter> adapter_;
  std::vector<double> inputs_{1, 0, 0}, outputs_;
  double time_ = 0;
  std::string message_;
};

// A script that connects after a while and sends a trial of 20 mm.
OpenSeesScript script_at(const test::TemporaryFolder& folder, std::uint16_t port, bool is_udp) {
  const auto file = [&](const char* name, const void* bytes, std::size_t size) {
    std::ofstream{folder.path() / name, std::ios::binary}.write(static_cast<const char*>(bytes),
                                                                static_cast<std::streamsize>(size));
  };
  const auto sent = trial_of(0.02);
  file("sizes", kFirstMessage.data(), sizeof kFirstMessage);
  file("trial", sent.data(), sizeof sent);
  // The connection belongs to a child of the started process.
  const auto script =
      folder.write("script.sh", std::string{"sleep 0.3\n(exec 3<>/dev/"} +
                                    (is_udp ? "udp" : "tcp") + "/127.0.0.1/" +
                                    std::to_string(port) + "\n" + (is_udp ? "printf a >&3\n" : "") +
                                    "cat sizes >&3\ncat trial >&3\nsleep 10)\n");
  OpenSeesScript result;
  result.command = {"/bin/bash", script.string()};
  result.log = folder.path() / "log";
  return result;
}

class OpenSeesPeer : public testing::TestWithParam<bool> {};

TEST_P(OpenSeesPeer, IsTheStartedScriptAndNoOtherProcess) {
  const test::TemporaryFolder folder;
  const std::uint16_t port = test::free_port();
  auto settings = one_element_at(port, GetParam());
  settings.script = script_at(folder, port, GetParam());
  OneElement adapter{settings};
  const PeerClient intruder{port, GetParam()};
  testing::internal::CaptureStderr();

  EXPECT_EQ(adapter.run(milliseconds{5000}), Status::Ok) << adapter.message();

  EXPECT_TRUE(adapter.has_target());
  EXPECT_EQ(adapter.target(), 0.02);
  const std::string lines = testing::internal::GetCapturedStderr();
  EXPECT_EQ(lines.find("element 'specimen': refused process " + std::to_string(getpid()) + " ("),
            0U)
      << lines;
  EXPECT_NE(lines.find(", which this run started\n"), std::string::npos) << lines;
  if (!GetParam()) {
    EXPECT_TRUE(intruder.is_closed());
  }
}

TEST_P(OpenSeesPeer, IsAProcessOfTheSameUserIfNoScriptIsStarted) {
  const std::uint16_t port = test::free_port();
  OneElement adapter{one_element_at(port, GetParam())};
  const PeerClient client{port, GetParam()};

  EXPECT_EQ(adapter.run(), Status::Ok);

  EXPECT_EQ(adapter.target(), 0.01);
}

TEST_P(OpenSeesPeer, IsNoProcessOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can start a process of another user";
  const std::uint16_t port = test::free_port();
  OneElement adapter{one_element_at(port, GetParam())};
  const pid_t other = fork();
  if (other == 0) {
    if (setuid(65'534) != 0) _exit(1);
    const PeerClient client{port, GetParam()};
    pause();
  }
  testing::internal::CaptureStderr();

  EXPECT_EQ(adapter.run(), Status::Ok);

  EXPECT_FALSE(adapter.has_target());
  EXPECT_EQ(testing::internal::GetCapturedStderr().find("element 'specimen': refused process " +
                                                        std::to_string(other) + " ("),
            0U);
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
}

TEST_P(OpenSeesPeer, HasTheStatedAddress) {
  const std::uint16_t port = test::free_port();
  auto settings = one_element_at(port, GetParam());
  settings.elements[0].peer = "127.0.0.2";
  OneElement adapter{settings};
  const PeerClient other{port, GetParam(), "127.0.0.1"};
  testing::internal::CaptureStderr();
  EXPECT_EQ(adapter.run(), Status::Ok);
  EXPECT_FALSE(adapter.has_target());
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "element 'specimen': refused 127.0.0.1, expected 127.0.0.2\n");

  const PeerClient client{port, GetParam(), "127.0.0.2", 0.03};
  EXPECT_EQ(adapter.run(), Status::Ok);
  EXPECT_EQ(adapter.target(), 0.03);
}

TEST_P(OpenSeesPeer, IsEveryoneOnlyIfTheExperimentSaysSo) {
  const test::TemporaryFolder folder;
  const std::uint16_t port = test::free_port();
  auto settings = one_element_at(port, GetParam());
  settings.elements[0].peer = "any";
  settings.script = script_at(folder, port, GetParam());
  OneElement adapter{settings};
  const PeerClient client{port, GetParam()};

  EXPECT_EQ(adapter.run(), Status::Ok);

  EXPECT_EQ(adapter.target(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Over, OpenSeesPeer, testing::Bool(),
                         [](const auto& is_udp) { return is_udp.param ? "Udp" : "Tcp"; });

TEST(OpenSeesPeers, AreWarnedAboutWhenOtherHostsCanConnect) {
  auto settings = one_element_at(test::free_port());
  settings.elements[0].address = "0.0.0.0";
  testing::internal::CaptureStderr();
  const OneElement adapter{settings};
  EXPECT_NE(testing::internal::GetCapturedStderr().find("can be reached from other hosts"),
            std::string::npos);
}

struct FirstTrial {
  const char* name;
  double displacement, allowed;
  const char* message;  ///< empty: the target is posted
};

class OpenSeesFirstTrial : public testing::TestWithParam<FirstTrial> {};

TEST_P(OpenSeesFirstTrial, IsRefusedFarFromRest) {
  const std::uint16_t port = test::free_port();
  auto settings = one_element_at(port);
  settings.layout.commands[0].lowest = -8e36;
  settings.layout.commands[0].highest = 8e36;
  settings.elements[0].first_trial = GetParam().allowed;
  OneElement adapter{settings};
  const PeerClient client{port, false, "127.0.0.1", GetParam().displacement};
  const std::string message = GetParam().message;

  EXPECT_EQ(adapter.run(), message.empty() ? Status::Ok : Status::Fault);

  EXPECT_EQ(adapter.has_target(), message.empty());
  EXPECT_EQ(adapter.message(), message);
}

INSTANTIATE_TEST_SUITE_P(
    Of, OpenSeesFirstTrial,
    testing::Values(FirstTrial{"Near", 0.05, 0.05, ""}, FirstTrial{"Allowed", 0.5, 1, ""},
                    FirstTrial{
                        "Far", -0.5, 0.05,
                        "element 'specimen': the first trial moves 'opf.long' by 0.5 m from rest, "
                        "expected at most 0.05 (first_trial_m)"},
                    FirstTrial{"TooLargeForItsWord", 1e300, 1e301,
                               "'opf.long' would be 1e+300 m, its word holds -8e+36 to 8e+36"}),
    [](const auto& trial) { return std::string{trial.param.name}; });

}  // namespace
}  // namespace rths::adapters
