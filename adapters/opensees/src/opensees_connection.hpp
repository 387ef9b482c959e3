// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <rths/adapters/opensees.hpp>

#include "element_server.hpp"
#include "opensees_process.hpp"
#include "specimen.hpp"

namespace rths::adapters {

/// The OpenSees process with the servers of all its elements, and the deadlines for its messages.
class OpenSeesConnection {
 public:
  /// Opens the ports, then starts OpenSees if the settings have a command.
  /// @param settings  kept by reference   @throws Error on failure
  explicit OpenSeesConnection(const OpenSeesSettings& settings);

  /// Receives all pending messages, and answers requests for matrices of identified specimens.
  void receive(const std::vector<Specimen>& specimens);
  [[nodiscard]] std::vector<ElementServer>& servers() { return servers_; }

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
