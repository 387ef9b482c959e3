// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/opensees.hpp>

#include "endpoint.hpp"
#include "generic_client.hpp"
#include "opensees_process.hpp"
#include "specimen.hpp"

namespace rths::adapters {

/// The peers that may drive an element.
struct Admission {
  std::string address;  ///< of the peer; "any": every peer; empty: a process of this host
  int process = 0;      ///< it or one of its descendants; 0: any process of the same user
};

/// Decides whether a peer may connect. A process of this host is found by its socket in /proc.
/// Takes milliseconds: only before the test.
/// @param peer  address of the peer   @param own  our end of the connection
/// @returns the reason of a refusal, with the peer's process and user; nothing if it is admitted
[[nodiscard]] std::optional<std::string> refusal(const Admission& admission, Transport transport,
                                                 const sockaddr_in& peer, const sockaddr_in& own);

/// The server of one element: its socket, received messages and open requests.
class ElementServer {
 public:
  /// Opens the port. @throws Error on failure
  explicit ElementServer(const OpenSeesElement& element);
  /// Refuses other peers: closes their connection, with one line on standard error.
  void admit(const Admission& admission);

  /// Receives all pending messages up to the first request.
  /// @returns whether any message was received   @throws Error with the element's name
  bool receive();
  /// Answers with the measurement, in the units of the script.
  void answer(const Measurement& measured);
  /// Answers with the requested matrix.
  void answer(const ElementMatrices& matrices);
  /// Marks the received trials as passed to the specimen.
  void take_trial() {
    trials_ = 0;
    is_new_ = false;
  }

  [[nodiscard]] int descriptor() const { return endpoint_.descriptor(); }
  /// Whether the element has sent its sizes; whether it did so in the last `receive`.
  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] bool just_connected() const { return just_connected_; }
  [[nodiscard]] const Trial& trial() const { return client_.trial(); }
  [[nodiscard]] int trials() const { return trials_; }   ///< since the last take_trial
  [[nodiscard]] bool is_new() const { return is_new_; }  ///< it moves the specimen
  [[nodiscard]] bool measurement_requested() const { return measurement_requested_; }
  [[nodiscard]] bool matrix_requested() const { return matrix_requested_; }
  /// Whether the element has sent its end.
  [[nodiscard]] bool disconnected() const { return disconnected_; }

 private:
  void handle(std::span<const std::byte> message);

  std::string name_;
  bool is_udp_;
  Endpoint endpoint_;
  GenericClient client_;
  int trials_ = 0;
  bool connected_ = false, just_connected_ = false, disconnected_ = false, is_new_ = false;
  bool measurement_requested_ = false, matrix_requested_ = false;
};

/// The OpenSees process with the servers of all its elements, and the deadlines for its messages.
class OpenSeesConnection {
 public:
  /// Opens the ports, then starts OpenSees if the settings have a command.
  /// @param settings  kept by reference   @throws Error on failure
  explicit OpenSeesConnection(const OpenSeesSettings& settings);

  /// Receives all pending messages, and answers requests for matrices of identified specimens.
  void receive(const std::vector<Specimen>& specimens);
  [[nodiscard]] std::vector<ElementServer>& servers() { return servers_; }

  /// What the script's floors have sent; null: it has none.
  [[nodiscard]] const FloorFeed* floors() { return opensees_.floors(); }

  /// Whether every element has sent its sizes; whether every element has sent its end.
  [[nodiscard]] bool connected() const;
  [[nodiscard]] bool disconnected() const;
  /// Whether a received trial has not been taken yet.
  [[nodiscard]] bool has_pending_trial() const;
  /// Whether the trials of one model update are complete. Each update sends a trial to every
  /// element, but the messages may arrive at different times.
  [[nodiscard]] bool all_trials_received() const;
  [[nodiscard]] bool has_open_request() const;
  /// Restarts OpenSees' answer deadline, after an answer or when the specimen is at its target.
  void restart_deadline();

  /// Returns the time to wait for the next message, limited to 0.1 s.
  /// @throws Error if OpenSees has ended or missed its deadline
  [[nodiscard]] Duration time_left();
  void wait_for_input(Duration longest) const;
  /// @throws Error if OpenSees has ended before its elements disconnected
  void require_running() { opensees_.require_running(); }
  /// Whether OpenSees has exited after disconnecting, or its deadline for that has passed.
  [[nodiscard]] bool has_finished();
  /// @returns the failure of OpenSees, if any
  std::optional<std::string> finish() { return opensees_.finish(); }
  [[nodiscard]] std::string with_exit_reason(const std::string& message) {
    return opensees_.with_exit_reason(message);
  }

 private:
  template <class Condition>
  [[nodiscard]] bool any(const Condition& condition) const {
    return std::any_of(servers_.begin(), servers_.end(), condition);
  }

  const OpenSeesSettings& settings_;
  std::vector<ElementServer> servers_;
  OpenSeesProcess opensees_;
};

}  // namespace rths::adapters
