// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <rths/adapters/opensees_script.hpp>
#include <rths/core/clock.hpp>

#include "script.hpp"
#include "socket_keeper.hpp"

namespace rths::adapters {

/// OpenSees: one that we have started and that ends with us, or a user's own, whose sockets stay
/// open if we die.
class OpenSeesProcess {
 public:
  /// Starts it, if it is ours. @throws Error if it cannot
  explicit OpenSeesProcess(const OpenSeesScript& script);

  /// A TCP connection with it.
  void keep(int socket) const;
  /// Waits for news for so long, counted from when it was last heard of.
  /// @returns how long that still is   @throws Error if it is over, or as require_running
  [[nodiscard]] Duration patience(double longest, const char* otherwise);
  void heard() { heard_ = WallClock{}.now(); }
  /// Since it was last heard of.
  [[nodiscard]] Duration silence() const { return WallClock{}.now() - heard_; }
  /// @throws Error if it has ended, a moment ago at least: its last words may still be on their way
  void require_running();
  /// Whether it has ended, or been silent for so long.
  [[nodiscard]] bool has_finished(double longest);
  /// An error together with why OpenSees has ended, if it has.
  [[nodiscard]] std::string explained(std::string message);
  /// It has been told that all is over, or has said so. Waits a little for its end.
  /// @returns how it ended if not in order
  std::optional<std::string> finish();

 private:
  std::optional<Script> script_;
  std::optional<SocketKeeper> keeper_;
  std::string log_;
  TimePoint heard_;                 ///< on the host's clock
  std::optional<TimePoint> ended_;  ///< seen to have
};

}  // namespace rths::adapters
