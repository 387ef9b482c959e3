// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <rths/adapters/child_program.hpp>
#include <rths/adapters/opensees_script.hpp>
#include <rths/core/clock.hpp>

#include "floor_feed.hpp"

namespace rths::adapters {

/// A separate process that keeps copies of the clients' TCP sockets open if this process is killed.
///
/// OpenSees does not detect a closed socket and polls it indefinitely. With an open socket it
/// sleeps until the user ends it. The keeper then exits as well, at the latest after a day.
class SocketKeeper {
 public:
  /// Forks the keeper. @throws Error on failure   @setup
  SocketKeeper();
  /// Disconnects from the keeper, which keeps all sockets unless they were released.
  ~SocketKeeper();
  SocketKeeper(const SocketKeeper&) = delete;
  SocketKeeper& operator=(const SocketKeeper&) = delete;

  /// Adds a connected socket.
  void keep(int socket) const;
  /// Ends the keeper: all clients have disconnected.
  void release();

 private:
  void wait_for_exit();
  int control_ = -1;
  int pid_ = -1;
};

/// The OpenSees process: started here and ended with this process, or a user's own process, whose
/// sockets stay open if this process is killed.
class OpenSeesProcess {
 public:
  /// Starts OpenSees if the script has a command. @throws Error on failure
  explicit OpenSeesProcess(const OpenSeesScript& script);
  /// Ends OpenSees, all of its ranks.
  ~OpenSeesProcess();
  OpenSeesProcess(const OpenSeesProcess&) = delete;
  OpenSeesProcess& operator=(const OpenSeesProcess&) = delete;

  /// Id of the started process; 0: a user starts it.
  [[nodiscard]] int process() const { return script_ ? script_->process() : 0; }
  /// What its floors have sent; null: it has none.
  [[nodiscard]] FloorFeed* floors() { return floors_ ? &*floors_ : nullptr; }
  /// Keeps a TCP connection with a user's own OpenSees open.
  void keep(int socket) const;
  /// Returns the time left of a deadline of `longest` [s] since its last restart.
  /// @param problem  for the error: "has not answered for"
  /// @throws Error if it has passed, or as require_running
  [[nodiscard]] Duration time_left(double longest, const char* problem);
  /// Restarts the deadline, for example after a message.
  void restart_deadline() { restarted_ = WallClock{}.now(); }
  /// Time since the last restart.
  [[nodiscard]] Duration silence() const { return WallClock{}.now() - restarted_; }
  /// @throws Error if OpenSees has failed, or exited a second ago; until then, its last messages
  ///         may still arrive
  void require_running();
  /// Whether OpenSees has exited, or `longest` [s] have passed since the last restart.
  [[nodiscard]] bool has_finished(double longest);
  /// Appends the failure of OpenSees, if any, to an error message.
  [[nodiscard]] std::string with_exit_reason(std::string message);
  /// Waits up to a second for OpenSees to exit after its last message.
  /// @returns its failure, if any
  std::optional<std::string> finish();

 private:
  std::optional<FloorFeed> floors_;
  std::optional<ChildProgram> script_;
  std::optional<SocketKeeper> keeper_;
  std::string log_;
  bool has_ranks_;
  TimePoint restarted_;             ///< wall time
  std::optional<TimePoint> ended_;  ///< exit detected, wall time
};

}  // namespace rths::adapters
