// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "endpoint.hpp"

namespace rths::adapters {

/// The near end of one `element actuator` or `element adapter` of OpenSees: a server that a foreign
/// solver drives. It takes a target, computes a step with it, and answers where it stands and the
/// force that takes; no sooner than it wants the next target.
///
/// The first message is as of a `genericClient`, [n, 0, 0, 0, 0, n, 0, 0, n, 0, D]; requests are
/// [code, n displacements], replies [n displacements, n forces].
class SlaveElement {
 public:
  explicit SlaveElement(const OpenSeesElement& element);

  /// Connects if its port is open. @returns whether it is connected now   @throws Error
  [[nodiscard]] bool connect();
  /// Sends a target, in SI along the machine's axes, and asks what comes of it.
  void ask(const Eigen::VectorXd& displacement);
  /// @returns whether the answer is here   @throws Error with the element's name
  [[nodiscard]] bool hear();
  /// Along the machine's axes [m, rad], [N, N·m].
  [[nodiscard]] const Eigen::VectorXd& displacement() const { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_; }
  /// Says that no more targets will come: OpenSees ends.
  void dismiss();

  [[nodiscard]] bool is_asked() const { return is_asked_; }  ///< and has not answered
  [[nodiscard]] int descriptor() const { return endpoint_ ? endpoint_->descriptor() : -1; }

 private:
  template <class Action>
  auto talk(const Action& action);
  void say(double code);

  OpenSeesElement element_;
  std::optional<Endpoint> endpoint_;
  std::vector<double> message_;
  Eigen::VectorXd to_script_;        ///< of displacements, with the axes' directions
  Eigen::VectorXd force_to_script_;  ///< likewise
  Eigen::VectorXd displacement_, force_;
  bool is_asked_ = false;
};

}  // namespace rths::adapters
