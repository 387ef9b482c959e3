// SPDX-License-Identifier: Apache-2.0
#include "element_server.hpp"

#include <cstdio>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>

namespace rths::adapters {
namespace {

constexpr int kMostReported = 10;  // refused peers
constexpr int kMostAtOnce = 1000;  // messages: OpenSees sends far fewer between requests

}  // namespace

ElementServer::ElementServer(const OpenSeesElement& element)
    : name_{fmt::format("element '{}'", element.name)},
      is_udp_{element.is_udp},
      endpoint_{element.is_udp ? Transport::Udp : Transport::Tcp, element.address, element.port},
      client_{name_, element.dofs()} {
  if (!element.address.starts_with("127."))
    write_message(fmt::format("{}: warning: port {} of {} can be reached from other hosts\n", name_,
                              element.port, element.address));
}

void ElementServer::admit(const Admission& admission) {
  const Transport transport = is_udp_ ? Transport::Udp : Transport::Tcp;
  endpoint_.set_gate([admission, transport, name = name_, refused = 0](
                         const sockaddr_in& peer, const sockaddr_in& own) mutable {
    const auto reason = refusal(admission, transport, peer, own);
    if (!reason) return true;
    if (++refused <= kMostReported)
      write_message(
          fmt::format("{}: refused {}{}\n", name, *reason,
                      refused == kMostReported ? "; further refusals are not reported" : ""));
    return false;
  });
}

bool ElementServer::receive() {
  int received = 0;
  just_connected_ = false;
  try {
    for (;
         received < kMostAtOnce && !disconnected_ && !measurement_requested_ && !matrix_requested_;
         ++received) {
      const auto message = endpoint_.receive(client_.expected());
      if (message.empty()) break;
      handle(message);
    }
  } catch (const Error& error) {
    const std::string message = error.what();
    throw Error{message.starts_with(name_) ? message : fmt::format("{}: {}", name_, message)};
  }
  return received > 0;
}

void ElementServer::handle(std::span<const std::byte> message) {
  switch (client_.receive(message)) {
    case GenericClient::Message::Trial:
      ++trials_;
      // A repeated trial does not cancel a pending move.
      is_new_ = is_new_ || client_.is_new();
      break;
    case GenericClient::Message::MeasurementRequest:
      measurement_requested_ = true;
      break;
    case GenericClient::Message::MatrixRequest:
      matrix_requested_ = true;
      break;
    case GenericClient::Message::End:
      disconnected_ = true;
      break;
    case GenericClient::Message::Sizes:
      connected_ = just_connected_ = true;
      break;
    case GenericClient::Message::Commit:
      break;
  }
}

void ElementServer::answer(const Measurement& measured) {
  measurement_requested_ = false;
  endpoint_.send(client_.measured_reply(measured), kSendDeadline);
}

void ElementServer::answer(const ElementMatrices& matrices) {
  matrix_requested_ = false;
  endpoint_.send(client_.matrix_reply(matrices), kSendDeadline);
}

}  // namespace rths::adapters
