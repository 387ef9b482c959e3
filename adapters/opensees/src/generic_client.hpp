// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

/// A trial state, as it was sent.
struct Trial {
  Eigen::VectorXd displacement, velocity, acceleration;  ///< n; 0 if it was not told
  double time = 0;                                       ///< of the domain [s]
};

/// What is answered to a question for what was measured, n each, in the script's units.
struct Measured {
  Eigen::VectorXd displacement, force;
};

/// The far end of one `element genericClient` of OpenSees, or of whoever else speaks like it:
/// OpenFresco's experimental elements with `-server`, its GenericTCP control, and programs that
/// expect its SimAppSite or SimAppElem server. What the messages mean and what is answered; sees
/// bytes, not sockets; in the units of the script.
///
/// The first message has 44 bytes: 11 int32, how many displacements, velocities, accelerations,
/// forces and times a request has, how many a reply, and D. OpenSees says [n, n, n, 0, 1, 0, 0, 0,
/// n, 0, D]. All others, in both directions, have 8·D: D doubles, the first of a request being what
/// is asked for. Host order.
class GenericClient {
 public:
  /// What a message was.
  enum class Heard {
    Sizes,     ///< the first message
    Trial,     ///< a state: see trial(); no reply is expected
    Measured,  ///< what was measured is wanted: measured_reply() is
    Matrix,    ///< a matrix is wanted: matrix_reply() is
    Commit,    ///< a step is done, or begins; no reply is expected
    End        ///< the element is gone; the socket may be closed, and not before
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
  [[nodiscard]] std::span<const std::byte> measured_reply(const Measured& measured);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void read_sizes(std::span<const std::byte> message);
  void read_trial();

  std::string name_;
  std::size_t message_bytes_;
  std::vector<double> request_, reply_;
  /// How many displacements, velocities, accelerations, forces and times.
  std::array<std::int32_t, 5> in_request_{}, in_reply_{};
  Trial trial_;
  bool is_new_ = false;
  Eigen::MatrixXd ElementMatrices::*wanted_ = nullptr;
};

}  // namespace rths::adapters
