// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
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

/// What a look does with a plain client's store that it has found.
enum class Judgement {
  Take,     ///< journals it
  Leave,    ///< nothing: the program that judges takes it by `Watch::take`
  Restore,  ///< gives the word its value in the journals
};

/// A store of 1, 2 or 4 bytes to a longword.
struct PartOfWord {
  std::uint32_t value = 0;
  std::uint32_t at = 0;  ///< first byte
  std::uint32_t bytes = 4;
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
  /// @throws Error if a living process watches this ring
  explicit Watch(Ring& ring);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Compares all words once. Reports a store that is not allowed after 0.1 s, since a journal may
  /// be briefly behind; a store that the owner overwrites earlier is not reported.
  /// @param judge  of stores that plain clients make to their own words; empty: takes all
  [[nodiscard]] std::vector<PlainStore> look(
      const std::function<Judgement(LongwordOffset)>& judge = {});
  /// Journals a store of the plain client that is this node, which something else has found.
  void take(const std::string& node, LongwordOffset offset, PartOfWord part);
  /// Stores a word of the plain client that is this node, and journals it.
  void store(const std::string& node, LongwordOffset offset, std::uint32_t value);
  /// True if a plain client was this node at the last look, or has left stores to who judges.
  [[nodiscard]] bool is_plain(const std::string& node) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::broker
