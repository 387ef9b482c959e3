// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <rths/budget/closed_loop.hpp>
#include <rths/loop/transfer_system.hpp>

namespace rths::budget {

/// The compensation as it ran: the references that it sent for a command.
class SentCompensation {
 public:
  explicit SentCompensation(const HybridTest& test);  ///< @setup
  /// One tick of the controller. @param force  of the specimen, as the controller knows it [N]
  [[nodiscard]] Eigen::Vector2d operator()(std::size_t tick, const loop::Command& command,
                                           const Eigen::Vector2d& force);

 private:
  [[nodiscard]] double reference_of(std::size_t axis, std::size_t tick,
                                    const loop::Command& command, double force);

  const HybridTest& test_;
  std::array<std::optional<controller::InverseLead>, 2> inverse_;
};

}  // namespace rths::budget
