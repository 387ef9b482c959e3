// SPDX-License-Identifier: Apache-2.0
#include "spring_server.hpp"

#include <poll.h>

#include <cstring>

#include <rths/core/error.hpp>

#include "support/process.hpp"

namespace rths::adapters::test_support {
namespace {

constexpr auto kPatience = std::chrono::seconds{10};
constexpr double kStiffness = 2.8;

}  // namespace

SpringServer::SpringServer(Transport transport)
    : port_{test::free_port()}, endpoint_{transport, "127.0.0.1", port_}, thread_{[this] {
        serve();
      }} {}

void SpringServer::serve() {
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd::Constant(1, 1, kStiffness),
                        zero = Eigen::MatrixXd::Zero(1, 1);
  GenericClient client{"spring", 1};
  const TimePoint deadline = WallClock{}.now() + kPatience;
  try {
    while (WallClock{}.now() < deadline) {
      pollfd readable{endpoint_.descriptor(), POLLIN, 0};
      poll(&readable, 1, 100);
      for (auto message = endpoint_.receive(client.expected()); !message.empty();
           message = endpoint_.receive(client.expected())) {
        double code = 0;
        if (message.size() > 44) std::memcpy(&code, message.data(), sizeof code);
        const auto kind = client.receive(message);
        received_.codes.push_back(static_cast<int>(
            kind == GenericClient::Message::Trial && !client.is_new() ? -code : code));
        if (kind == GenericClient::Message::MatrixRequest)
          endpoint_.send(client.matrix_reply({stiffness, zero, zero}), kPatience);
        if (kind == GenericClient::Message::MeasurementRequest)
          endpoint_.send(client.measured_reply({client.trial().displacement,
                                                kStiffness * client.trial().displacement}),
                         kPatience);
        if (kind == GenericClient::Message::End) return;
      }
    }
    received_.error = "the client did not send its end";
  } catch (const Error& error) {
    received_.error = error.what();
  }
}

Received SpringServer::received() {
  if (thread_.joinable()) thread_.join();
  return received_;
}

}  // namespace rths::adapters::test_support
