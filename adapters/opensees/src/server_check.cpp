// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/server_check.hpp>

#include <poll.h>

#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "endpoint.hpp"
#include "message_codes.hpp"

namespace rths::adapters {
namespace {

constexpr std::size_t kMessageDoubles = 256;  // of a message: OpenSees' default
constexpr auto kConnectRetry = std::chrono::milliseconds{20};
constexpr double kSmallDifference = 1e-6;  // of a repeated force [-]

using Numbers = std::vector<double>;

/// Rules in the order of their report.
enum ServerRule : std::size_t {
  kConnectRule,
  kMatricesRule,
  kForceRule,
  kRepeatRule,
  kMoveRule,
  kRestartRule,
  kServerRules
};
constexpr const char* kServerRuleNames[kServerRules] = {"connect", "matrices", "force",
                                                        "repeat",  "move",     "restart"};

/// The client's side of a connection.
class CheckingClient {
 public:
  explicit CheckingClient(const ServerCheck& check) : check_{check}, endpoint_{connected(check)} {
    const auto n = static_cast<std::int32_t>(check.dofs);
    const std::array<std::int32_t, 11> sizes{n, n, n, 0, 1, 0, 0, 0, n, 0, kMessageDoubles};
    endpoint_.send(std::as_bytes(std::span{sizes}), from_seconds(check.deadline));
  }
  void send(double code, const Numbers& values = {}) {
    message_.fill(0);
    message_[0] = code;
    std::copy(values.begin(), values.end(), message_.begin() + 1);
    endpoint_.send(std::as_bytes(std::span{message_}), from_seconds(check_.deadline));
  }
  /// @throws Error if there is no answer in time
  [[nodiscard]] Numbers request(double code, std::size_t count, const char* quantity) {
    send(code);
    const WallClock clock;
    const TimePoint latest = clock.now() + from_seconds(check_.deadline);
    while (clock.now() < latest) {
      pollfd readable{endpoint_.descriptor(), POLLIN, 0};
      poll(&readable, 1, 10);
      const auto bytes = endpoint_.receive(kMessageDoubles * sizeof(double));
      if (bytes.empty()) continue;
      Numbers values(count);
      std::memcpy(values.data(), bytes.data(), count * sizeof(double));
      return values;
    }
    throw Error{fmt::format("no {} within {:g} s: answer each request with {} numbers of 8 bytes",
                            quantity, check_.deadline, kMessageDoubles)};
  }
  /// The force at a displacement of all degrees of freedom.
  [[nodiscard]] Numbers force_at(double displacement) {
    Numbers trial(3 * static_cast<std::size_t>(check_.dofs) + 1);
    std::fill_n(trial.begin(), check_.dofs, displacement);
    send(message_code::kTrial, trial);
    return request(message_code::kForce, static_cast<std::size_t>(check_.dofs), "force");
  }

 private:
  static Endpoint connected(const ServerCheck& check) {
    const WallClock clock;
    const TimePoint latest = clock.now() + from_seconds(check.deadline);
    do {
      auto endpoint = Endpoint::connect(check.is_udp ? Transport::Udp : Transport::Tcp,
                                        check.address, check.port);
      if (endpoint) return std::move(*endpoint);
      std::this_thread::sleep_for(kConnectRetry);
    } while (clock.now() < latest);
    throw Error{fmt::format("no server at {}:{} within {:g} s: start it first", check.address,
                            check.port, check.deadline)};
  }
  const ServerCheck& check_;
  Endpoint endpoint_;
  std::array<double, kMessageDoubles> message_{};
};

class ServerReport {
 public:
  ServerReport() {
    for (const char* name : kServerRuleNames) findings_.push_back({name, {}, ""});
    for (auto& finding : findings_) finding.outcome = Finding::Outcome::NotTried;
  }
  void pass(ServerRule rule, const std::string& text = "") {
    if (findings_[rule].outcome == Finding::Outcome::NotTried)
      findings_[rule] = {kServerRuleNames[rule], Finding::Outcome::Pass, text};
  }
  void fail(ServerRule rule, const std::string& text) {
    findings_[rule] = {kServerRuleNames[rule], Finding::Outcome::Fail, text};
  }
  [[nodiscard]] const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

// The first value that is no number; empty if all are.
std::string fault_of_numbers(const Numbers& values, const std::string& name) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      return fmt::format("number {} of the {} is {}, expected a number", i + 1, name, values[i]);
  return "";
}

void check_matrices(CheckingClient& client, const ServerCheck& check, ServerReport& report) {
  const auto n = static_cast<std::size_t>(check.dofs);
  for (const auto& [code, name] :
       {std::pair{message_code::kInitialStiffness, "initial stiffness"},
        std::pair{message_code::kDamping, "damping"}, std::pair{message_code::kMass, "mass"}}) {
    const Numbers matrix = client.request(code, n * n, name);
    if (const auto fault = fault_of_numbers(matrix, name); !fault.empty())
      return report.fail(kMatricesRule, fault);
    for (std::size_t i = 0; i < n && code == message_code::kInitialStiffness; ++i)
      if (!(matrix[i * n + i] > 0))
        return report.fail(kMatricesRule,
                           fmt::format("the initial stiffness of degree of freedom {} is {:g}, "
                                       "expected more than 0",
                                       i + 1, matrix[i * n + i]));
  }
  report.pass(kMatricesRule);
}

void check_repeat(const Numbers& first, const Numbers& second, ServerReport& report) {
  for (std::size_t i = 0; i < first.size(); ++i)
    if (std::abs(first[i] - second[i]) > kSmallDifference * std::abs(first[i]))
      return report.fail(kRepeatRule, fmt::format("the same trial gave {:g}, then {:g}: OpenSees "
                                                  "repeats trials, so measure each one once",
                                                  first[i], second[i]));
  report.pass(kRepeatRule);
}

// A force that does not change with the displacement comes from another trial.
void check_motion(CheckingClient& client, const ServerCheck& check, ServerReport& report) {
  if (check.amplitude == 0) return;
  const Numbers rest = client.force_at(0), moved = client.force_at(check.amplitude);
  if (const auto fault = fault_of_numbers(moved, "force"); !fault.empty())
    return report.fail(kForceRule, fault);
  static_cast<void>(client.force_at(0));
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (rest[i] == moved[i])
      return report.fail(kMoveRule, fmt::format("force {} is {:g} at rest and at {:g}: answer with "
                                                "the force of the last trial",
                                                i + 1, rest[i], check.amplitude));
  report.pass(kMoveRule);
}

void check_session(CheckingClient& client, const ServerCheck& check, ServerRule& rule,
                   ServerReport& report) {
  rule = kMatricesRule;
  check_matrices(client, check, report);
  rule = kForceRule;
  const Numbers first = client.force_at(0);
  if (const auto fault = fault_of_numbers(first, "force"); !fault.empty())
    report.fail(kForceRule, fault);
  else
    check_repeat(first, client.force_at(0), report);
  check_motion(client, check, report);
  client.send(message_code::kCommit);
  report.pass(kForceRule);
  client.send(message_code::kEnd);
}

}  // namespace

std::vector<Finding> check_server(const ServerCheck& check) {
  ServerReport report;
  ServerRule rule = kConnectRule;
  try {
    {
      CheckingClient client{check};
      report.pass(kConnectRule);
      check_session(client, check, rule, report);
    }
    rule = kRestartRule;
    CheckingClient again{check};
    static_cast<void>(again.force_at(0));
    again.send(message_code::kEnd);
    report.pass(kRestartRule);
  } catch (const Error& error) {
    report.fail(rule, rule == kRestartRule ? fmt::format("after its end, {}", error.what())
                                           : std::string{error.what()});
  }
  return report.findings();
}

}  // namespace rths::adapters
