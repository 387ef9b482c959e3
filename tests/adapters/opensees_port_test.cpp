// SPDX-License-Identifier: Apache-2.0
// Malformed input at an element's port: the adapter reports it and ends, or waits for more; the
// machine does not move.
#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <rths/adapters/opensees.hpp>
#include <rths/core/error.hpp>

#include "support/long_run.hpp"
#include "support/process.hpp"

namespace rths::adapters {
namespace {

const int kTrials = test::Repetitions{600, 300, 100}.count();
constexpr std::uint32_t kSeed = 20261122;
constexpr std::size_t kDoubles = 256;

using Bytes = std::vector<std::byte>;
using Random = std::mt19937;

OpenSeesSettings settings_at(std::uint16_t port, bool is_udp) {
  OpenSeesSettings settings;
  OpenSeesElement element;
  element.name = "specimen";
  element.port = port;
  element.is_udp = is_udp;
  element.is_rotation = {false, false};
  element.axes = {{"long", 0}, {"lat", 1}};
  element.initial_stiffness = SquareMatrix::diagonal(2, 1);
  element.damping = element.mass = SquareMatrix::diagonal(2, 0);
  settings.elements = {element};
  for (const char* axis : {"long", "lat"}) {
    settings.layout.commands.push_back(
        {std::string{"opf."} + axis, axis, OpfQuantity::Displacement, "m"});
    settings.layout.feedbacks.push_back(
        {std::string{"daq."} + axis, axis, OpfQuantity::Force, "N"});
  }
  return settings;
}

template <class T, std::size_t n>
Bytes bytes_of(const std::array<T, n>& values) {
  const auto bytes = std::as_bytes(std::span{values});
  return {bytes.begin(), bytes.end()};
}

Bytes noise(Random& random, std::size_t most) {
  Bytes bytes(std::uniform_int_distribution<std::size_t>{1, most}(random));
  for (auto& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

Bytes sizes(std::int32_t dofs) {
  return bytes_of(std::array<std::int32_t, 11>{dofs, dofs, dofs, 0, 1, 0, 0, 0, dofs, 0, kDoubles});
}

Bytes message(double code, double displacement) {
  std::array<double, kDoubles> words{code, displacement, displacement};
  return bytes_of(words);
}

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Random bytes, or a valid first message with an error in it or after it.
Bytes malformed(Random& random) {
  const auto one_of = [&](std::initializer_list<double> values) {
    return *(values.begin() +
             std::uniform_int_distribution<std::ptrdiff_t>{0, std::ssize(values) - 1}(random));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Bytes bytes;
  switch (random() % 6) {
    case 0:
      return noise(random, 4096);
    case 1:  // sizes of another element
      return sizes(static_cast<std::int32_t>(one_of({-1, 0, 1, 3, 100, 1e9})));
    case 2:  // sizes with one wrong bit
      bytes = sizes(2);
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
      return bytes;
    case 3:  // an unknown code
      bytes = sizes(2);
      append(bytes, message(one_of({0, 6.5, 13.5, 16, 50, 98, -3, kNan, kInfinity}), 0.1));
      return bytes;
    case 4:  // a trial with NaN or infinity
      bytes = sizes(2);
      append(bytes, message(3, one_of({kNan, kInfinity, -kInfinity})));
      return bytes;
    default:  // an incomplete trial
      bytes = sizes(2);
      append(bytes, message(3, 0.1));
      bytes.resize(bytes.size() - 1 - random() % 2000);
      return bytes;
  }
}

/// A client that sends bytes and does not evaluate the answer.
class Client {
 public:
  Client(std::uint16_t port, bool is_udp, const Bytes& bytes)
      : fd_{socket(AF_INET, is_udp ? SOCK_DGRAM : SOCK_STREAM, 0)} {
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd_, reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
    if (is_udp) {
      EXPECT_EQ(send(fd_, "a", 1, 0), 1);
    }
    EXPECT_EQ(send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), std::ssize(bytes));
  }
  ~Client() { close(fd_); }
  [[nodiscard]] bool has_reply() const {
    pollfd readable{fd_, POLLIN, 0};
    return poll(&readable, 1, 0) == 1;
  }
  /// Waits for one message and returns it.
  [[nodiscard]] std::array<double, kDoubles> receive() const {
    std::array<double, kDoubles> reply{};
    EXPECT_EQ(recv(fd_, reply.data(), sizeof reply, MSG_WAITALL), std::ssize(reply) * 8);
    return reply;
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

 private:
  int fd_;
};

TEST(OpenSeesPort, NeverMovesTheMachineOnMalformedMessages) {
  Random random{kSeed};
  int faults = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const bool is_udp = trial % 3 == 2;
    const std::uint16_t port = test::free_port();
    const auto adapter = make_opensees(settings_at(port, is_udp));
    const auto ports = adapter->ports();
    std::vector<double> inputs{1, 0, 0, 0}, outputs(ports.size() - inputs.size());
    adapter->activate();
    Status status = Status::Ok;
    StepData step{0, 0, false, inputs, outputs};
    {
      const Client client{port, is_udp, malformed(random)};
      for (int i = 0; i < 20 && status == Status::Ok; ++i) {
        step.time = i * 1e-3;
        status = adapter->step(step);
        EXPECT_EQ(outputs[0], 0);
        EXPECT_EQ(outputs[1], 0);
        EXPECT_LE(outputs[2], 0) << "a target was posted in trial " << trial;
      }
    }
    if (status == Status::Fault) {
      ++faults;
      EXPECT_NE(std::string{step.message}.find("element 'specimen'"), std::string::npos)
          << step.message;
    }
    adapter->deactivate();
  }
  // The adapter waits for the rest of an incomplete trial and refuses everything else.
  EXPECT_GT(faults, kTrials / 2);
}

// A client of OpenFresco's SimAppSite server: all five quantities, at their offsets.
TEST(OpenSeesPort, AnswersAForeignProgramWithAllMeasurements) {
  const std::uint16_t port = test::free_port();
  auto settings = settings_at(port, false);
  for (const char* axis : {"long", "lat"})
    settings.layout.feedbacks.push_back(
        {std::string{"daq.displ."} + axis, axis, OpfQuantity::Displacement, "m"});
  const auto adapter = make_opensees(settings);
  enum In { kAtTarget, kSwitchPc, kForces, kDisplacements = 4, kInputs = 6 };
  std::vector<double> inputs(kInputs), outputs(adapter->ports().size() - kInputs);
  inputs[kAtTarget] = 1;
  adapter->activate();
  Bytes sent = bytes_of(std::array<std::int32_t, 11>{2, 2, 2, 0, 1, 2, 2, 2, 2, 1, kDoubles});
  append(sent, message(3, 0.02));
  append(sent, message(6, 0));
  Client client{port, false, sent};
  StepData step{0, 0, false, inputs, outputs};
  bool had_target = false;
  for (int i = 0; i < 20; ++i) {
    step.time = i * 1e-3;
    ASSERT_EQ(adapter->step(step), Status::Ok) << step.message;
    const bool has_target = outputs[2] > 0;
    had_target = had_target || has_target;
    inputs[kSwitchPc] = has_target ? 1 : 0;
    inputs[kAtTarget] = has_target ? 0 : 1;
    for (std::size_t k = 0; k < 2; ++k) {
      inputs[kDisplacements + k] = 0.9 * outputs[k];
      inputs[kForces + k] = 1e6 * outputs[k];
    }
  }
  EXPECT_TRUE(had_target);
  const auto reply = client.receive();
  EXPECT_DOUBLE_EQ(reply[0], 0.018);
  EXPECT_DOUBLE_EQ(reply[1], 0.018);
  EXPECT_DOUBLE_EQ(reply[6], 2e4);
  EXPECT_DOUBLE_EQ(reply[7], 2e4);
  adapter->deactivate();
}

/// The adapter with a controller, an ideal machine and a linear spring as the specimen.
class Bench {
 public:
  static constexpr std::size_t kInputs = 6;
  static constexpr double kStiffness = 1e6;
  explicit Bench(OpenSeesSettings settings)
      : adapter_{make_opensees(with_displacements(settings))} {
    inputs_.resize(kInputs);
    outputs_.resize(adapter_->ports().size() - kInputs);
    adapter_->activate();
  }
  ~Bench() { adapter_->deactivate(); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void step(bool has_controller = true) {
    StepData step{time_ += 1e-3, 0, false, inputs_, outputs_};
    ASSERT_EQ(adapter_->step(step), Status::Ok) << step.message;
    const bool has_target = outputs_[2] > 0;
    targets_ += has_target && inputs_[1] == 0 ? 1 : 0;
    inputs_[1] = has_target ? 1 : 0;
    inputs_[0] = has_controller && !has_target ? 1 : 0;
    for (std::size_t k = 0; k < 2; ++k) {
      inputs_[4 + k] = outputs_[k];
      inputs_[2 + k] = kStiffness * outputs_[k];
    }
  }
  [[nodiscard]] int targets() const { return targets_; }

 private:
  static OpenSeesSettings with_displacements(OpenSeesSettings settings) {
    for (const char* axis : {"long", "lat"})
      settings.layout.feedbacks.push_back(
          {std::string{"daq.displ."} + axis, axis, OpfQuantity::Displacement, "m"});
    return settings;
  }
  std::unique_ptr<Adapter> adapter_;
  std::vector<double> inputs_, outputs_;
  double time_ = 0;
  int targets_ = 0;
};

TEST(OpenSeesPort, AnswersTheStiffnessAfterIdentification) {
  const std::uint16_t port = test::free_port();
  auto settings = settings_at(port, false);
  settings.elements[0].initial_stiffness.reset();
  Bench bench{settings};
  Bytes sent = sizes(2);
  append(sent, message(3, 0));
  append(sent, message(12, 0));
  const Client client{port, false, sent};
  // The controller is not ready yet.
  for (int i = 0; i < 100; ++i) bench.step(false);
  EXPECT_FALSE(client.has_reply());
  EXPECT_EQ(bench.targets(), 0);
  for (int i = 0; i < 10'000 && !client.has_reply(); ++i) bench.step();
  EXPECT_GT(bench.targets(), 700);  // four seconds of each of two components
  const auto reply = client.receive();
  EXPECT_NEAR(reply[0], Bench::kStiffness, 1e-3);
  EXPECT_NEAR(reply[3], Bench::kStiffness, 1e-3);
}

TEST(OpenSeesPort, DoesNotProbeBeforeOpenSeesConnects) {
  auto settings = settings_at(test::free_port(), false);
  settings.elements[0].initial_stiffness.reset();
  Bench bench{settings};
  for (int i = 0; i < 100; ++i) bench.step();
  EXPECT_EQ(bench.targets(), 0);
}

TEST(OpenSeesPort, RefusesToIdentifyWithATooLongTargetInterval) {
  auto settings = settings_at(test::free_port(), false);
  settings.elements[0].mass.reset();
  settings.layout.feedbacks.push_back({"daq.d.long", "long", OpfQuantity::Displacement, "m"});
  settings.layout.feedbacks.push_back({"daq.d.lat", "lat", OpfQuantity::Displacement, "m"});
  settings.simulation_step = 0.2;
  EXPECT_THROW(static_cast<void>(make_opensees(settings)), Error);
}

}  // namespace
}  // namespace rths::adapters
