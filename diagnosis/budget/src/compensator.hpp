// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <rths/budget/closed_loop.hpp>

namespace rths::budget {

/// Command of the controller, in one tick. Its rates are along its path.
struct Command {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();      ///< [m/s]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< [m/s²]
  controller::Pace pace;
};

/// The compensation as it ran: the references that it sent for a command.
class Compensator {
 public:
  /// @param acts  false: the reference is the command   @setup
  Compensator(const HybridTest& test, bool acts);
  /// One tick of the controller. @param force  of the specimen, as the controller knows it [N]
  [[nodiscard]] Eigen::Vector2d operator()(std::size_t tick, const Command& command,
                                           const Eigen::Vector2d& force);

 private:
  [[nodiscard]] double reference_of(std::size_t axis, std::size_t tick, const Command& command,
                                    double force);

  const HybridTest& test_;
  bool acts_;
  std::array<std::optional<controller::InverseLead>, 2> inverse_;
};

}  // namespace rths::budget
