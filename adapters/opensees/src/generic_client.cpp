// SPDX-License-Identifier: Apache-2.0
#include "generic_client.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

using Eigen::Index;

constexpr std::size_t kSizes = 11;
constexpr std::int32_t kMostDoubles = 1 << 20;  // of a message: 1024 degrees of freedom

// What a request asks for, in its first word.
constexpr double kTrial = 3, kCommit = 5, kForce = 10, kInitialStiffness = 12,
                 kTangentStiffness = 13, kDamping = 14, kMass = 15, kEnd = 99;

}  // namespace

GenericClient::GenericClient(std::string name, Index dofs)
    : name_{std::move(name)}, message_bytes_{kSizes * sizeof(std::int32_t)} {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dofs);
  trial_ = {zero, zero, zero, 0};
}

void GenericClient::fail(const std::string& what) const {
  throw Error{fmt::format("{}: {}", name_, what)};
}

void GenericClient::read_sizes(std::span<const std::byte> message) {
  std::array<std::int32_t, kSizes> sizes{};
  std::memcpy(sizes.data(), message.data(), message.size());
  const auto n = static_cast<std::int32_t>(dofs());
  const std::int32_t least = std::max(3 * n + 2, n * n), doubles = sizes.back();
  if (sizes != std::array<std::int32_t, kSizes>{sizes[0], sizes[0], sizes[0], 0, 1, 0, 0, 0,
                                                sizes[0], 0, doubles})
    fail(fmt::format("its first message is [{}], expected [n, n, n, 0, 1, 0, 0, 0, n, 0, size]",
                     fmt::join(sizes, ", ")));
  if (sizes[0] != n)
    fail(fmt::format("OpenSees lists {} degrees of freedom, the experiment {}", sizes[0], n));
  if (doubles < least || doubles > kMostDoubles)
    fail(fmt::format("messages of {} numbers, expected {} to {}", doubles, least, kMostDoubles));
  request_.assign(static_cast<std::size_t>(doubles), 0);
  reply_ = request_;
  message_bytes_ = request_.size() * sizeof(double);
}

void GenericClient::read_trial() {
  const Index n = dofs();
  const Eigen::Map<const Eigen::VectorXd> state{request_.data() + 1, 3 * n + 1};
  if (!state.allFinite()) fail("a trial state holds what is no number");
  is_new_ = trial_.displacement != state.head(n);
  trial_.displacement = state.head(n);
  trial_.velocity = state.segment(n, n);
  trial_.acceleration = state.segment(2 * n, n);
  trial_.time = state[3 * n];
}

GenericClient::Heard GenericClient::hear(std::span<const std::byte> message) {
  if (message.size() != message_bytes_)
    fail(fmt::format("a message of {} bytes, expected {}", message.size(), message_bytes_));
  if (request_.empty()) {
    read_sizes(message);
    return Heard::Sizes;
  }
  std::memcpy(request_.data(), message.data(), message.size());
  const double code = request_[0];
  if (code == kTrial) return read_trial(), Heard::Trial;
  if (code == kForce) return Heard::Force;
  if (code == kCommit) return Heard::Commit;
  if (code == kEnd) return Heard::End;
  wanted_ = code == kInitialStiffness || code == kTangentStiffness ? &ElementMatrices::stiffness
            : code == kDamping                                     ? &ElementMatrices::damping
            : code == kMass                                        ? &ElementMatrices::mass
                                                                   : nullptr;
  if (wanted_ == nullptr)
    fail(fmt::format("OpenSees asks for {}, expected 3, 5, 10, 12 to 15 or 99", code));
  return Heard::Matrix;
}

std::span<const std::byte> GenericClient::reply(const double* values, Index count) {
  std::copy_n(values, count, reply_.begin());
  std::fill(reply_.begin() + count, reply_.end(), 0);
  return std::as_bytes(std::span{reply_});
}

std::span<const std::byte> GenericClient::matrix_reply(const ElementMatrices& matrices) {
  // Columns one after the other, as Eigen has them.
  const Eigen::MatrixXd& wanted = matrices.*wanted_;
  return reply(wanted.data(), wanted.size());
}

std::span<const std::byte> GenericClient::force_reply(const Eigen::VectorXd& forces) {
  return reply(forces.data(), forces.size());
}

}  // namespace rths::adapters
