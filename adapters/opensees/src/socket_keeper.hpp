// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace rths::adapters
