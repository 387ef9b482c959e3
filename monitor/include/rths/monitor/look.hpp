// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/broker/watch.hpp>
#include <rths/core/clock.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/monitor/history.hpp>

namespace rths::monitor {

/// A node of a ring, as it is seen from outside.
struct NodeState {
  std::string name;
  broker::Presence presence;
  bool is_plain = false;      ///< stores through a plain pointer
  double rate = 0;            ///< heartbeats, over the last second [Hz]
  double writes = 0;          ///< over the last second [Hz]
  std::optional<double> age;  ///< since its last write [s]; none: it has not written
  std::uint64_t lost = 0;     ///< writes that were overwritten before they were read here
  /// Of nodes that an adapter runs: counts since the start, and times of the steps [s].
  std::optional<double> steps, late, late_max, duration, overruns, stale;
};

/// A change of a word whose changes are events, of a node, or of the safety layer.
struct RingEvent {
  std::uint64_t number = 0;
  double time = 0;   ///< since the look began [s]
  std::string text;  ///< one line
  bool is_bad = false;
  std::string word = {};  ///< that changed; empty: another event
  float from = 0;         ///< its value before
};

/// A word that another process than its owner has stored.
struct Violation {
  std::string word, value, owner, writers;
  std::uint64_t count = 0;
  double time = 0;  ///< of the first, since the look began [s]
};

/// State of a safety layer.
struct SafetyReport {
  std::string node, state;
  std::string trip;  ///< "long: velocity of the command is 2.1 m/s, …"; empty: none
};

/// A word of the ring and its newest value.
struct WordState {
  std::string name, node;  ///< the owner
  std::string unit;        ///< SI
  memmap::Codec codec;
  LongwordOffset offset;
  bool is_parameter = false;  ///< of the operator
  bool is_event = false;
  float value = 0;       ///< [SI unit]
  TimePoint written{0};  ///< last write; 0: none since the look began
};

/// Follows a ring from outside: its memory is read-only, and the process is not on the ring. So it
/// cannot change or delay anything, and the ring can end meanwhile. Values and times of words come
/// from the journals of their writers, which also have each write between two updates; words of
/// plain clients come from the memory.
///
/// One thread; `update` at least every 0.1 s.
class RingLook {
 public:
  /// @param history_bytes  memory of the history; 0: none
  /// @throws Error if there is no such ring, or it is of another layout or damaged   @setup
  RingLook(const std::string& ring, std::size_t history_bytes);

  /// Reads what was written since the last update.
  void update();
  /// False once the ring was removed or replaced, or its memory was lost.   @setup
  [[nodiscard]] bool is_current() const;

  [[nodiscard]] const std::string& ring() const { return name_; }
  [[nodiscard]] const memmap::Map& map() const { return ring_.map(); }
  [[nodiscard]] const std::vector<WordState>& words() const { return words_; }
  /// Position of a word in `words`.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// Its newest value [SI unit].
  [[nodiscard]] std::optional<double> value(const std::string& name) const;
  [[nodiscard]] const std::vector<NodeState>& nodes() const { return nodes_; }
  [[nodiscard]] std::vector<SafetyReport> safety() const;
  /// The last ones.
  [[nodiscard]] const std::deque<RingEvent>& events() const { return events_; }
  [[nodiscard]] const std::map<std::string, Violation>& violations() const { return violations_; }
  [[nodiscard]] const History* history() const { return history_ ? &*history_ : nullptr; }
  [[nodiscard]] TimePoint begun() const { return begun_; }
  [[nodiscard]] TimePoint updated() const { return updated_; }

 private:
  /// Heartbeats and writes of a node until a time.
  struct Count {
    TimePoint time;
    std::uint64_t beats, writes;
  };
  struct Member {
    NodeId id;
    broker::Follower follower;
    std::uint64_t written = 0;  ///< writes
    TimePoint last_write{0};
    std::deque<Count> counts = {};  ///< of the last second
  };
  void read_slot(TimePoint end);
  void take(const broker::Write& write, Member& member, TimePoint time);
  void take_word(LongwordOffset offset, std::uint32_t word, TimePoint time);
  void read_memory(const std::string& node);
  void update_nodes();
  void update_rates(Member& member, NodeState& node);
  void look_for_violations();
  void add_event(std::string text, bool is_bad);
  void add_change(const WordState& word, float before);
  void note_change(const WordState& word, float before);
  void note_trips();
  [[nodiscard]] std::string trip_text(const std::string& prefix) const;

  std::string name_;
  broker::Ring ring_;
  broker::Node observer_;
  broker::Watch watch_;
  TimePoint begun_, updated_, nodes_updated_{0};
  Slot slot_;
  std::vector<WordState> words_;
  std::vector<std::uint32_t> word_at_;  ///< position of the word at an offset, plus 1; 0: none
  std::map<std::string, std::size_t> by_name_;
  std::vector<Extent> extents_;  ///< of this slot
  std::vector<Member> members_;
  std::vector<NodeState> nodes_;  ///< as `members_`
  std::deque<RingEvent> events_;
  std::uint64_t event_count_ = 0;
  std::vector<const WordState*> trips_;  ///< of the write that is being read
  std::map<std::string, Violation> violations_;
  std::optional<History> history_;
};

/// Nodes, safety layers, violations and lost writes as one JSON object.
[[nodiscard]] std::string json_of(const RingLook& look);
/// The same as lines for a terminal.
[[nodiscard]] std::string text_of(const RingLook& look);

}  // namespace rths::monitor
