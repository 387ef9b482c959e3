// SPDX-License-Identifier: Apache-2.0
//
// The laboratory of a closed loop: from the reference of the machine to the force that the
// controller feeds back.
#pragma once

#include <memory>

#include <rths/budget/closed_loop.hpp>

#include "compensator.hpp"

namespace rths::budget {

class Laboratory {
 public:
  /// @param first_tick  of the machine: the noise and the vertical load of earlier ticks are
  /// skipped
  Laboratory(const HybridTest& test, Parts identified, std::size_t first_tick);
  ~Laboratory();

  /// The controller's next tick. @param reference  for a command, after the compensation [m]
  void send(const Eigen::Vector2d& reference, const Command& command);
  /// One tick of the machine.
  /// @param found  references sent before it; the last of them moves the platen, none: rest
  /// @param compression  of the analysis [N]
  void move(std::size_t found, double compression);
  /// Ticks of the machine, those before the first included.
  [[nodiscard]] std::size_t ticks() const;
  /// One tick of the controller. @param target  of the integrator, now [m]
  /// @param last  command of the controller's last tick
  /// @returns the force that it feeds back [N]
  const Eigen::Vector2d& feed_back(const Eigen::Vector2d& target, const Command& last);
  [[nodiscard]] const Eigen::Vector2d& displacement() const;
  /// The force of the specimen as the compensator knew it in the last tick: ahead, or as measured
  /// [N].
  [[nodiscard]] const Eigen::Vector2d& specimen_force() const;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace rths::budget
