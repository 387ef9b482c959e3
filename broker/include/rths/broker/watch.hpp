// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/ids.hpp>

namespace rths::broker {

/// A store that is in no journal.
struct PlainStore {
  LongwordOffset offset;
  std::uint32_t value = 0;
  std::string owner;                ///< of the word in the map; empty: no owner
  bool allowed = false;             ///< made by the owner, through its plain pointer
  std::vector<std::string> others;  ///< if not allowed: the plain clients that may have made it
  TimePoint seen{0};                ///< CLOCK_MONOTONIC
};

/// Finds stores through plain pointers, which no journal records: compares every mapped word with
/// its value in the journals.
///
/// A store of a plain client into its own words is journalled on the client's behalf, so that
/// others can follow it, wait for it and date it. Of the stores that one look finds, those to event
/// signals of the map come last, zeros before other values. Any other store is an error of some
/// program. One watch per ring.   @setup, one thread
class Watch {
 public:
  explicit Watch(Ring& ring);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Compares all words once. Reports a store that is not allowed after 0.1 s, since a journal may
  /// be briefly behind; a store that the owner overwrites earlier is not reported.
  [[nodiscard]] std::vector<PlainStore> look();
  /// True if a plain client was this node at the last look.
  [[nodiscard]] bool is_plain(const std::string& node) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::broker
