// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/ids.hpp>

namespace rths::broker {

/// A store that no journal tells of.
struct PlainStore {
  LongwordOffset offset;
  std::uint32_t value = 0;
  std::string owner;                ///< of the word, by the map; empty: nobody's
  bool allowed = false;             ///< the owner's own, through its plain pointer
  std::vector<std::string> others;  ///< if it is not allowed: who could have, by its place
  TimePoint seen{0};                ///< CLOCK_MONOTONIC
};

/// Watches the words of a ring for stores through plain pointers, which leave no trace of their
/// own: by comparing, from time to time, every mapped word with what the journals say it should be.
///
/// What a node that joined as a plain client stores into its own words is journalled on its behalf,
/// so that others can follow it, wait for it and see when it was. Everything else is somebody's
/// mistake. One watch per ring.   @setup, one thread
class Watch {
 public:
  explicit Watch(Ring& ring);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// One look at everything. A store that is not allowed is told when it has stood for a tenth of
  /// a second, since a journal may be a moment behind; one that its owner overwrites sooner is not
  /// seen.
  [[nodiscard]] std::vector<PlainStore> look();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::broker
