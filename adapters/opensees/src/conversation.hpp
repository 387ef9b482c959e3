// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <rths/adapters/opensees.hpp>

#include "element_server.hpp"
#include "opensees_process.hpp"
#include "specimen.hpp"

namespace rths::adapters {

/// OpenSees with all its elements: what they have said, and how long it may be silent.
class Conversation {
 public:
  /// Opens the ports, then starts OpenSees if it is ours.
  /// @param settings  kept by reference   @throws Error if it cannot
  explicit Conversation(const OpenSeesSettings& settings);

  /// Hears everything that has arrived. Answers what is known of the specimens.
  void hear(const std::vector<Specimen>& specimens);
  [[nodiscard]] std::vector<ElementServer>& servers() { return servers_; }

  /// Whether every element has said its sizes; whether every one has taken leave.
  [[nodiscard]] bool has_come() const;
  [[nodiscard]] bool has_left() const;
  /// Whether a trial has come that was not taken yet.
  [[nodiscard]] bool has_trials() const;
  /// Whether all elements' trials are of the same update of the model. Each update tells every
  /// element; but what it tells one may be here before what it told another.
  [[nodiscard]] bool is_round_complete() const;
  [[nodiscard]] bool is_question_open() const;
  /// The specimen has arrived, or something was answered: from now on it is OpenSees' turn.
  void pass_turn();

  /// How long to wait for news, at most a little.
  /// @throws Error if OpenSees has ended or been silent for too long
  [[nodiscard]] Duration patience();
  void wait_for_news(Duration longest) const;
  /// @throws Error if OpenSees has ended before its elements have taken leave
  void require_running() { opensees_.require_running(); }
  /// Whether OpenSees, having taken leave, has done what it still had to do, or had the time to.
  [[nodiscard]] bool has_finished();
  /// @returns how it ended, if not in order
  std::optional<std::string> finish() { return opensees_.finish(); }
  [[nodiscard]] std::string explained(const std::string& message) {
    return opensees_.explained(message);
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
