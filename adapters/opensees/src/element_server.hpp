// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/adapters/opensees.hpp>

#include "endpoint.hpp"
#include "generic_client.hpp"

namespace rths::adapters {

/// One element: its socket, what was said on it, and what is owed to it.
class ElementServer {
 public:
  /// Listens. @throws Error if it cannot
  explicit ElementServer(const OpenSeesElement& element);

  /// Hears everything that has arrived, up to a question.
  /// @returns whether something was heard   @throws Error with the element's name
  bool hear();
  /// Answers what was measured, in the units of the script.
  void answer(const Measured& measured);
  /// Answers the matrix that is wanted.
  void answer(const ElementMatrices& matrices);
  /// The trial goes to the specimen: another one is due.
  void take_trial() {
    trials_ = 0;
    is_new_ = false;
  }

  [[nodiscard]] int descriptor() const { return endpoint_.descriptor(); }
  /// Whether it has said its sizes; whether that was among what was heard last.
  [[nodiscard]] bool has_come() const { return has_come_; }
  [[nodiscard]] bool has_just_come() const { return has_just_come_; }
  [[nodiscard]] const Trial& trial() const { return client_.trial(); }
  [[nodiscard]] int trials() const { return trials_; }   ///< since the last was taken
  [[nodiscard]] bool is_new() const { return is_new_; }  ///< it moves the specimen
  [[nodiscard]] bool wants_measured() const { return wants_measured_; }
  [[nodiscard]] bool wants_matrix() const { return wants_matrix_; }
  [[nodiscard]] bool has_left() const { return has_left_; }

 private:
  void take_in(std::span<const std::byte> message);

  std::string name_;
  Endpoint endpoint_;
  GenericClient client_;
  int trials_ = 0;
  bool has_come_ = false, is_new_ = false, wants_measured_ = false, wants_matrix_ = false,
       has_left_ = false, has_just_come_ = false;
};

}  // namespace rths::adapters
