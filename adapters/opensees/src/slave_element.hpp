// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "endpoint.hpp"

namespace rths::adapters {

/// The client of one `element actuator` or `element adapter` of OpenSees, which is a server for
/// another solver. OpenSees takes a target, computes a step, and answers with displacement and
/// force when it is ready for the next target.
///
/// The first message is that of a `genericClient`, [n, 0, 0, 0, 0, n, 0, 0, n, 0, D]; requests are
/// [code, n displacements], replies [n displacements, n forces].
class SlaveElement {
 public:
  explicit SlaveElement(const OpenSeesElement& element);

  /// Connects if its port is open. @returns whether it is connected   @throws Error
  [[nodiscard]] bool connect();
  /// Sends a target, in SI along the machine's axes, and requests the response.
  void send_target(const Eigen::VectorXd& displacement);
  /// @returns whether the response has arrived   @throws Error with the element's name
  [[nodiscard]] bool receive();
  /// Along the machine's axes [m, rad], [N, N·m].
  [[nodiscard]] const Eigen::VectorXd& displacement() const { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_; }
  /// Ends the connection; OpenSees then exits.
  void send_end();

  [[nodiscard]] bool awaits_response() const { return awaits_response_; }
  [[nodiscard]] int descriptor() const { return endpoint_ ? endpoint_->descriptor() : -1; }

 private:
  template <class Action>
  auto with_name(const Action& action);
  void send(double code);

  OpenSeesElement element_;
  std::optional<Endpoint> endpoint_;
  std::vector<double> message_;
  Eigen::VectorXd to_script_;        ///< of displacements, signed by the axes' directions
  Eigen::VectorXd force_to_script_;  ///< of forces, signed likewise
  Eigen::VectorXd displacement_, force_;
  bool awaits_response_ = false;
};

}  // namespace rths::adapters
