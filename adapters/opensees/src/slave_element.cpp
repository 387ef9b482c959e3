// SPDX-License-Identifier: Apache-2.0
#include "slave_element.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "message_codes.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kUsualLength = 256;  // of a message [doubles]

}  // namespace

SlaveElement::SlaveElement(const OpenSeesElement& element) : element_{element} {
  const Index n = element.dofs();
  message_.resize(static_cast<std::size_t>(std::max(kUsualLength, 2 * n)));
  to_script_ = force_to_script_ = displacement_ = force_ = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool turns = element.is_rotation[at];
    const double direction = element.axes[at].direction;
    to_script_[i] = direction / element.displacement_unit(turns);
    force_to_script_[i] = direction / element.force_unit_of(turns);
  }
}

bool SlaveElement::connect() {
  endpoint_ = Endpoint::connect(element_.is_udp ? Transport::Udp : Transport::Tcp, element_.address,
                                element_.port);
  if (!endpoint_) return false;
  const auto n = static_cast<std::int32_t>(element_.dofs());
  const std::array<std::int32_t, 11> sizes{
      n, 0, 0, 0, 0, n, 0, 0, n, 0, static_cast<std::int32_t>(message_.size())};
  endpoint_->send(std::as_bytes(std::span{sizes}), kSendDeadline);
  return true;
}

template <class Action>
auto SlaveElement::with_name(const Action& action) {
  try {
    return action();
  } catch (const Error&) {  // the endpoint's message refers to a client
    throw Error{fmt::format("element '{}': OpenSees closed the connection", element_.name)};
  }
}

void SlaveElement::send(double code) {
  message_[0] = code;
  with_name([&] { endpoint_->send(std::as_bytes(std::span{message_}), kSendDeadline); });
}

void SlaveElement::send_target(const VectorXd& displacement) {
  const VectorXd target = to_script_.cwiseProduct(displacement);
  std::copy(target.begin(), target.end(), message_.begin() + 1);
  send(message_code::kTrial);
  send(message_code::kForce);
  awaits_response_ = true;
}

bool SlaveElement::receive() {
  if (!awaits_response_) return true;
  const auto response =
      with_name([&] { return endpoint_->receive(message_.size() * sizeof(double)); });
  if (response.empty()) return false;
  std::memcpy(message_.data(), response.data(), response.size());
  awaits_response_ = false;
  const Index n = element_.dofs();
  const Eigen::Map<const VectorXd> values{message_.data(), 2 * n};
  if (!values.allFinite())
    throw Error{fmt::format("element '{}': OpenSees sent NaN or infinity", element_.name)};
  displacement_ = values.head(n).cwiseQuotient(to_script_);
  force_ = values.tail(n).cwiseQuotient(force_to_script_);
  return true;
}

void SlaveElement::send_end() {
  if (!endpoint_) return;
  message_[0] = message_code::kEnd;
  with_name([&] { endpoint_->send_last(std::as_bytes(std::span{message_}), kSendDeadline); });
  endpoint_.reset();
}

}  // namespace rths::adapters
