// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::adapters {

/// What an element of OpenSees is told of itself, n × n [N/m], [N·s/m], [kg], and rotations alike.
struct ElementMatrices {
  Eigen::MatrixXd stiffness;  ///< initial; also what is told of the tangent
  Eigen::MatrixXd damping, mass;
};

/// A trial state, as OpenSees sent it.
struct Trial {
  Eigen::VectorXd displacement, velocity, acceleration;  ///< n
  double time = 0;                                       ///< of the domain [s]
};

/// The far end of one `element genericClient`: what its messages mean and what is answered. Sees
/// bytes, not sockets; in the units of the script.
///
/// The first message has 44 bytes: 11 int32, [n, n, n, 0, 1, 0, 0, 0, n, 0, D]. All others, in both
/// directions, have 8·D: D doubles, the first of a request being what is asked for. Host order.
class GenericClient {
 public:
  /// What a message was.
  enum class Heard {
    Sizes,   ///< the first message
    Trial,   ///< a state: see trial(); no reply is expected
    Force,   ///< forces are wanted: force_reply() is
    Matrix,  ///< a matrix is wanted: matrix_reply() is
    Commit,  ///< a step is done; no reply is expected
    End      ///< the element is gone; the socket may be closed, and not before
  };

  /// @param name  for errors: "element 'bearing'"
  /// @param dofs  how many degrees of freedom it has
  GenericClient(std::string name, Eigen::Index dofs);

  /// Bytes of the next message.
  [[nodiscard]] std::size_t expected() const { return message_bytes_; }
  /// @throws Error if it is none of this protocol, has another length than expected, or holds what
  ///         is no number. Nothing has changed then
  [[nodiscard]] Heard hear(std::span<const std::byte> message);

  [[nodiscard]] Eigen::Index dofs() const { return trial_.displacement.size(); }
  [[nodiscard]] const Trial& trial() const { return trial_; }
  /// Whether the trial has another displacement than the one before: most codes 3 repeat it.
  [[nodiscard]] bool is_new() const { return is_new_; }
  /// The reply to what was heard last. Valid until the next call.
  /// @param matrices  n × n
  [[nodiscard]] std::span<const std::byte> matrix_reply(const ElementMatrices& matrices);
  [[nodiscard]] std::span<const std::byte> force_reply(const Eigen::VectorXd& forces);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void read_sizes(std::span<const std::byte> message);
  void read_trial();
  [[nodiscard]] std::span<const std::byte> reply(const double* values, Eigen::Index count);

  std::string name_;
  std::size_t message_bytes_;
  std::vector<double> request_, reply_;
  Trial trial_;
  bool is_new_ = false;
  Eigen::MatrixXd ElementMatrices::*wanted_ = nullptr;
};

}  // namespace rths::adapters
