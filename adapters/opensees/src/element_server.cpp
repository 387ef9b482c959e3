// SPDX-License-Identifier: Apache-2.0
#include "element_server.hpp"

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr int kMostAtOnce = 1000;  // messages: OpenSees sends far fewer before it wants an answer

// OpenSees always reads what it has asked for.
constexpr auto kSendPatience = std::chrono::seconds{1};

}  // namespace

ElementServer::ElementServer(const OpenSeesElement& element)
    : name_{fmt::format("element '{}'", element.name)},
      endpoint_{element.is_udp ? Transport::Udp : Transport::Tcp, element.address, element.port},
      client_{name_, element.dofs()} {}

bool ElementServer::hear() {
  int heard = 0;
  has_just_come_ = false;
  try {
    for (; heard < kMostAtOnce && !has_left_ && !wants_measured_ && !wants_matrix_; ++heard) {
      const auto message = endpoint_.receive(client_.expected());
      if (message.empty()) break;
      take_in(message);
    }
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error{what.starts_with(name_) ? what : fmt::format("{}: {}", name_, what)};
  }
  return heard > 0;
}

void ElementServer::take_in(std::span<const std::byte> message) {
  switch (client_.hear(message)) {
    case GenericClient::Heard::Trial:
      ++trials_;
      // A move that was asked for and not yet made is not undone by its repetition.
      is_new_ = is_new_ || client_.is_new();
      break;
    case GenericClient::Heard::Measured:
      wants_measured_ = true;
      break;
    case GenericClient::Heard::Matrix:
      wants_matrix_ = true;
      break;
    case GenericClient::Heard::End:
      has_left_ = true;
      break;
    case GenericClient::Heard::Sizes:
      has_come_ = has_just_come_ = true;
      break;
    case GenericClient::Heard::Commit:
      break;
  }
}

void ElementServer::answer(const Measured& measured) {
  wants_measured_ = false;
  endpoint_.send(client_.measured_reply(measured), kSendPatience);
}

void ElementServer::answer(const ElementMatrices& matrices) {
  wants_matrix_ = false;
  endpoint_.send(client_.matrix_reply(matrices), kSendPatience);
}

}  // namespace rths::adapters
