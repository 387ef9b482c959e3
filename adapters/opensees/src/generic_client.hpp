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

/// Property matrices of an OpenSees element, n × n [N/m], [N·s/m], [kg], or with rotations.
struct ElementMatrices {
  Eigen::MatrixXd stiffness;  ///< initial; also sent as the tangent
  Eigen::MatrixXd damping, mass;
};

/// A trial state, as received.
struct Trial {
  Eigen::VectorXd displacement, velocity, acceleration;  ///< n; 0 if not sent
  double time = 0;                                       ///< of the domain [s]
};

/// The answer to a request for a measurement, n values each, in the script's units.
struct Measurement {
  Eigen::VectorXd displacement, force;
};

/// The server's side of the protocol of one `element genericClient` of OpenSees. OpenFresco's
/// experimental elements with `-server`, its GenericTCP control, and clients of its SimAppSite or
/// SimAppElem server use the same protocol. Decodes messages and encodes replies as bytes, without
/// sockets, in the script's units.
///
/// The first message has 44 bytes, 11 int32: the numbers of displacements, velocities,
/// accelerations, forces and times in a request, the same for a reply, and D. OpenSees sends
/// [n, n, n, 0, 1, 0, 0, 0, n, 0, D]. All other messages, in both directions, have 8·D bytes, D
/// doubles. The first double of a request is its code. Native byte order.
class GenericClient {
 public:
  /// Kind of a message.
  enum class Message {
    Sizes,               ///< the first message
    Trial,               ///< a state: see trial(); expects no reply
    MeasurementRequest,  ///< expects measured_reply()
    MatrixRequest,       ///< expects matrix_reply()
    Commit,              ///< a step ends or begins; expects no reply
    End                  ///< the element is deleted; only now may the socket be closed
  };

  /// @param name  for errors: "element 'bearing'"
  /// @param dofs  number of its degrees of freedom
  GenericClient(std::string name, Eigen::Index dofs);

  /// Length of the next message [bytes].
  [[nodiscard]] std::size_t expected() const { return message_bytes_; }
  /// Decodes a message.
  /// @throws Error if it violates the protocol, has an unexpected length, or holds NaN or infinity;
  ///         the state is then unchanged
  [[nodiscard]] Message receive(std::span<const std::byte> message);

  [[nodiscard]] Eigen::Index dofs() const { return trial_.displacement.size(); }
  [[nodiscard]] const Trial& trial() const { return trial_; }
  /// Whether the trial's displacement differs from the previous one; most messages of code 3 repeat
  /// it.
  [[nodiscard]] bool is_new() const { return is_new_; }
  /// Returns the reply to the last message, valid until the next call.
  /// @param matrices  n × n
  [[nodiscard]] std::span<const std::byte> matrix_reply(const ElementMatrices& matrices);
  [[nodiscard]] std::span<const std::byte> measured_reply(const Measurement& measured);

 private:
  [[noreturn]] void fail(const std::string& problem) const;
  void read_sizes(std::span<const std::byte> message);
  void read_trial();

  std::string name_;
  std::size_t message_bytes_;
  std::vector<double> request_, reply_;
  /// Numbers of displacements, velocities, accelerations, forces and times.
  std::array<std::int32_t, 5> in_request_{}, in_reply_{};
  Trial trial_;
  bool is_new_ = false;
  Eigen::MatrixXd ElementMatrices::*requested_ = nullptr;
};

}  // namespace rths::adapters
