// SPDX-License-Identifier: Apache-2.0
#include "generic_client.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "message_codes.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;

constexpr std::size_t kSizes = 11;
constexpr std::int32_t kMostDoubles = 1 << 20;  // per message: 1024 degrees of freedom

enum MessagePart : std::size_t { kDisplacements, kVelocities, kAccelerations, kForces, kTimes };
constexpr const char* kUsual =
    "n displacements, 0 or n velocities and accelerations, 0 forces, 0 or 1 time, and in the reply "
    "n forces";

bool is_measured(double code) {
  return code == message_code::kAllMeasured ||
         (code >= message_code::kDisplacement && code <= message_code::kTime &&
          code == std::floor(code));
}

// The matrix that a code requests; null for codes of no matrix.
Eigen::MatrixXd ElementMatrices::*matrix_of(double code) {
  if (code == message_code::kInitialStiffness || code == message_code::kTangentStiffness)
    return &ElementMatrices::stiffness;
  if (code == message_code::kDamping) return &ElementMatrices::damping;
  return code == message_code::kMass ? &ElementMatrices::mass : nullptr;
}

}  // namespace

GenericClient::GenericClient(std::string name, Index dofs)
    : name_{std::move(name)}, message_bytes_{kSizes * sizeof(std::int32_t)} {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dofs);
  trial_ = {zero, zero, zero, 0};
}

void GenericClient::fail(const std::string& problem) const {
  throw Error{fmt::format("{}: {}", name_, problem)};
}

void GenericClient::read_sizes(std::span<const std::byte> message) {
  std::array<std::int32_t, kSizes> sizes{};
  std::memcpy(sizes.data(), message.data(), message.size());
  std::copy_n(sizes.begin(), in_request_.size(), in_request_.begin());
  std::copy_n(sizes.begin() + in_request_.size(), in_reply_.size(), in_reply_.begin());
  const auto n = static_cast<std::int32_t>(dofs());
  const std::int32_t doubles = sizes.back();
  const auto all_or_none = [&](std::int32_t count) {
    return count == 0 || count == in_request_[0];
  };
  const auto one_or_none = [](std::int32_t count) { return count == 0 || count == 1; };
  if (!all_or_none(in_request_[kVelocities]) || !all_or_none(in_request_[kAccelerations]) ||
      in_request_[kForces] != 0 || !one_or_none(in_request_[kTimes]) ||
      !std::all_of(in_reply_.begin(), in_reply_.begin() + kForces, all_or_none) ||
      in_reply_[kForces] != in_request_[0] || !one_or_none(in_reply_[kTimes]))
    fail(fmt::format("its first message is [{}], expected {}", fmt::join(sizes, ", "), kUsual));
  if (sizes[0] != n)
    fail(fmt::format("OpenSees lists {} degrees of freedom, the experiment {}", sizes[0], n));
  const std::int32_t least =
      std::max(1 + std::accumulate(in_request_.begin(), in_request_.end(), 0),
               std::accumulate(in_reply_.begin(), in_reply_.end(), 0));
  if (doubles < least || doubles > kMostDoubles)
    fail(fmt::format("messages of {} numbers, expected {} to {}", doubles, least, kMostDoubles));
  request_.assign(static_cast<std::size_t>(doubles), 0);
  reply_ = request_;
  message_bytes_ = request_.size() * sizeof(double);
}

void GenericClient::read_trial() {
  const Index sent = std::accumulate(in_request_.begin(), in_request_.end(), 0);
  if (!Eigen::Map<const Eigen::VectorXd>{request_.data() + 1, sent}.allFinite())
    fail("a trial state holds NaN or infinity");
  const double* next = request_.data() + 1;
  const auto read = [&](MessagePart part, Eigen::VectorXd& into) {
    if (in_request_[part] == 0) return;
    into = Eigen::Map<const Eigen::VectorXd>{next, dofs()};
    next += in_request_[part];
  };
  const Eigen::VectorXd before = trial_.displacement;
  read(kDisplacements, trial_.displacement);
  read(kVelocities, trial_.velocity);
  read(kAccelerations, trial_.acceleration);
  if (in_request_[kTimes] == 1) trial_.time = *next;
  is_new_ = trial_.displacement != before;
}

GenericClient::Message GenericClient::receive(std::span<const std::byte> message) {
  if (message.size() != message_bytes_)
    fail(fmt::format("a message of {} bytes, expected {}", message.size(), message_bytes_));
  if (request_.empty()) {
    read_sizes(message);
    return Message::Sizes;
  }
  std::memcpy(request_.data(), message.data(), message.size());
  const double code = request_[0];
  if (code == message_code::kTrial) return read_trial(), Message::Trial;
  if (is_measured(code)) return Message::MeasurementRequest;
  if (code == message_code::kCommit || code == message_code::kOpen ||
      code == message_code::kSetUp || code == message_code::kExecute)
    return Message::Commit;
  if (code == message_code::kEnd) return Message::End;
  requested_ = matrix_of(code);
  if (requested_ == nullptr)
    fail(fmt::format("OpenSees sent code {}, expected 1 to 15 or 99", code));
  if (static_cast<std::size_t>(dofs() * dofs()) > reply_.size())
    fail(fmt::format("OpenSees requests a {0} x {0} matrix in messages of {1} numbers", dofs(),
                     reply_.size()));
  return Message::MatrixRequest;
}

std::span<const std::byte> GenericClient::matrix_reply(const ElementMatrices& matrices) {
  // Column by column, the order of Eigen.
  const Eigen::MatrixXd& matrix = matrices.*requested_;
  std::fill(std::copy_n(matrix.data(), matrix.size(), reply_.begin()), reply_.end(), 0);
  return std::as_bytes(std::span{reply_});
}

std::span<const std::byte> GenericClient::measured_reply(const Measurement& measured) {
  std::fill(reply_.begin(), reply_.end(), 0);
  auto next = reply_.begin();
  // Unmeasured quantities take their trial values.
  const Eigen::VectorXd* const values[] = {&measured.displacement, &trial_.velocity,
                                           &trial_.acceleration, &measured.force};
  for (std::size_t part = kDisplacements; part <= kForces; ++part)
    next = std::copy_n(values[part]->data(), in_reply_[part], next);
  if (in_reply_[kTimes] == 1) *next = trial_.time;
  return std::as_bytes(std::span{reply_});
}

}  // namespace rths::adapters
