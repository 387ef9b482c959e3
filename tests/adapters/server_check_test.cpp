// SPDX-License-Identifier: Apache-2.0
//
// Servers for OpenSees' genericClient, one of them correct.
#include <rths/adapters/server_check.hpp>

#include <poll.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "endpoint.hpp"
#include "generic_client.hpp"
#include "support/process.hpp"

namespace rths::adapters {
namespace {

enum class Fault { None, NanForce, NanMass, NoStiffness, NoAnswer, Drifts, Constant, OneClient };

/// A spring of stiffness 2.8 with a fault, in a thread of its own.
class FaultyServer {
 public:
  explicit FaultyServer(Fault fault) : fault_{fault}, port_{test::free_port()} {
    endpoint_ = std::make_unique<Endpoint>(Transport::Tcp, "127.0.0.1", port_);
    thread_ = std::thread{[this] { serve(); }};
  }
  ~FaultyServer() {
    ends_ = true;
    thread_.join();
  }
  FaultyServer(const FaultyServer&) = delete;
  FaultyServer& operator=(const FaultyServer&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void serve() {
    for (int clients = 0; !ends_; ++clients) {
      if (clients > 0 && fault_ == Fault::OneClient) return endpoint_.reset();
      if (clients > 0) endpoint_ = std::make_unique<Endpoint>(Transport::Tcp, "127.0.0.1", port_);
      try {
        serve_one();
      } catch (const Error&) {  // the client has gone
      }
      endpoint_.reset();
    }
  }
  void serve_one() {
    GenericClient client{"spring", 1};
    while (!ends_) {
      pollfd readable{endpoint_->descriptor(), POLLIN, 0};
      poll(&readable, 1, 10);
      for (auto message = endpoint_->receive(client.expected()); !message.empty();
           message = endpoint_->receive(client.expected())) {
        const auto kind = client.receive(message);
        if (kind == GenericClient::Message::End) return;
        if (fault_ == Fault::NoAnswer) continue;
        if (kind == GenericClient::Message::MatrixRequest) send(client.matrix_reply(matrices()));
        if (kind == GenericClient::Message::MeasurementRequest)
          send(client.measured_reply({client.trial().displacement, force(client)}));
      }
    }
  }
  void send(std::span<const std::byte> reply) { endpoint_->send(reply, std::chrono::seconds{5}); }
  [[nodiscard]] ElementMatrices matrices() const {
    const auto matrix = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
    return {matrix(fault_ == Fault::NoStiffness ? 0 : 2.8), matrix(0),
            matrix(fault_ == Fault::NanMass ? std::numeric_limits<double>::quiet_NaN() : 1)};
  }
  [[nodiscard]] Eigen::VectorXd force(const GenericClient& client) {
    double force = 2.8 * client.trial().displacement[0] + 1;
    if (fault_ == Fault::NanForce) force = std::numeric_limits<double>::infinity();
    if (fault_ == Fault::Drifts) force += ++requests_;
    if (fault_ == Fault::Constant) force = 1;
    return Eigen::VectorXd::Constant(1, force);
  }

  Fault fault_;
  std::uint16_t port_;
  std::unique_ptr<Endpoint> endpoint_;
  int requests_ = 0;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

std::vector<Finding> findings_of(Fault fault, double amplitude = 0.1) {
  const FaultyServer server{fault};
  ServerCheck check;
  check.port = server.port();
  check.amplitude = amplitude;
  check.deadline = 1;
  return check_server(check);
}

/// Rules that failed, separated by spaces.
std::string broken(Fault fault) {
  std::string rules;
  for (const auto& finding : findings_of(fault))
    if (finding.outcome == Finding::Outcome::Fail) rules += finding.rule + " ";
  return rules;
}

TEST(ServerCheck, PassesACorrectServer) {
  for (const auto& finding : findings_of(Fault::None))
    EXPECT_EQ(finding.outcome, Finding::Outcome::Pass) << finding.rule << ": " << finding.text;
}

TEST(ServerCheck, FindsEachFaultByItsRule) {
  EXPECT_EQ(broken(Fault::NanForce), "force ");
  EXPECT_EQ(broken(Fault::NanMass), "matrices ");
  EXPECT_EQ(broken(Fault::NoStiffness), "matrices ");
  EXPECT_EQ(broken(Fault::NoAnswer), "matrices ");
  EXPECT_EQ(broken(Fault::Drifts), "repeat ");
  EXPECT_EQ(broken(Fault::Constant), "move ");
  EXPECT_EQ(broken(Fault::OneClient), "restart ");
}

TEST(ServerCheck, LeavesTheSpecimenAtRestUnlessToldOtherwise) {
  for (const auto& finding : findings_of(Fault::Constant, 0)) {
    const bool moves = finding.rule == "move";
    EXPECT_EQ(finding.outcome, moves ? Finding::Outcome::NotTried : Finding::Outcome::Pass)
        << finding.rule << ": " << finding.text;
  }
}

TEST(ServerCheck, SaysThatThereIsNoServer) {
  ServerCheck check;
  check.port = test::free_port();
  check.deadline = 0.05;
  EXPECT_NE(check_server(check)[0].text.find("no server at 127.0.0.1"), std::string::npos);
}

}  // namespace
}  // namespace rths::adapters
