// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::adapters {

/// A process of its own that keeps copies of our clients' TCP sockets open if we die: OpenSees
/// takes one that its server has closed for one on which there is no news, and asks it again and
/// again, for ever. With the socket open it sleeps, until somebody ends it; then this process ends
/// as well. After a day it gives up.
class SocketKeeper {
 public:
  /// Forks. @throws Error if it cannot   @setup
  SocketKeeper();
  /// We go. What was not released is kept.
  ~SocketKeeper();
  SocketKeeper(const SocketKeeper&) = delete;
  SocketKeeper& operator=(const SocketKeeper&) = delete;

  /// @param socket  to keep, connected
  void keep(int socket) const;
  /// All clients have taken leave: there is nothing to keep.
  void release();

 private:
  void wait_a_little();
  int control_ = -1;
  int pid_ = -1;
};

}  // namespace rths::adapters
