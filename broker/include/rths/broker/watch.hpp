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

/// Whether a watch journals the stores of plain clients into their own words. Only one watch of a
/// ring may; others observe it, beside each other.
enum class Journalling { OnBehalf, None };

/// Finds stores through plain pointers, which no journal records: compares every mapped word with
/// its value in the journals.
///
/// A store of a plain client into its own words is journalled on the client's behalf, so that
/// others can follow it, wait for it and date it. Of the stores that one look finds, those to event
/// signals of the map come last, zeros before other values. Any other store is an error of some
/// program.   @setup, one thread
class Watch {
 public:
  /// @throws Error if it is to journal and a living process does so on this ring
  explicit Watch(Ring& ring, Journalling journalling = Journalling::OnBehalf);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Compares all words once. A journal may be briefly behind a word, so a store that is not
  /// allowed is reported when the owner has beaten since and has not journalled the value; if the
  /// owner does not beat, after 0.1 s. This holds also if the owner has overwritten the value, but
  /// a value that no look has seen is not found.
  /// @param judge  of stores that plain clients make to their own words; empty: takes all
  [[nodiscard]] std::vector<PlainStore> look(
      const std::function<Judgement(LongwordOffset)>& judge = {});
  /// True while a value that no journal explains is not judged yet.
  [[nodiscard]] bool has_suspicion() const;
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
