// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/broker/detail/journal_writer.hpp>
#include <rths/broker/detail/wake.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/ids.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>
#include <rths/memmap/map.hpp>

namespace rths::broker {

class Membership;
class Segment;
class Follower;
class Waiter;
struct LastWrite;
struct LongwordRange;
struct RingReport;

/// Reaction to the loss of memory: another program truncated the ring's object, or a page of a
/// sparse memory could not be allocated. Without any, the kernel ends the process by SIGBUS.
enum class OnLostMemory {
  Exit,      ///< prints one line and ends the process with exit code 2
  Continue,  ///< replaces the page by private zeros; `Node::is_ring_lost` returns true
};
/// Installs the reaction as this process's handler of SIGBUS. Other bus errors still end it.
/// @setup
void on_lost_memory(OnLostMemory reaction);

/// Default sizes of a journal, log2 of its entries: 1 MiB (half a second of a node that writes 100
/// words per millisecond) and 64 KiB.
inline constexpr std::uint32_t kJournalBits = 16;
inline constexpr std::uint32_t kInProcessJournalBits = 12;

/// A waiter spins for this long before it sleeps.
inline constexpr Duration kLongestSpin = std::chrono::microseconds{50};

/// State of a node on a ring.
struct Presence {
  enum class State {
    Absent,  ///< not joined yet, or left in order
    Alive,
    Vanished,  ///< its process ended without leaving
  };
  State state = State::Absent;
  int pid = 0;  ///< in its own PID namespace
};

/// Membership of a node on a ring: reads every word, writes the words of its own partitions.
///
/// One thread reads and writes; other threads may call `presence_of` and `beats_of`. Nodes, in one
/// process or many, are independent: each longword has one writer, so there are no locks, and none
/// that an ended process could hold. The destructor leaves the ring, but not in a forked child of
/// the process that joined; must not outlive its `Ring`.
class Node {
 public:
  Node(Node&&) noexcept;
  Node& operator=(Node&&) noexcept;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  /// Current value of a longword.
  /// @pre the offset is inside the ring's memory   @realtime
  [[nodiscard]] std::uint32_t read(LongwordOffset offset) const RTHS_REALTIME;
  /// Writes a longword; every node sees it.
  /// @returns Fault, and writes nothing, if the longword is in no partition of this node or in a
  ///          tear group   @realtime
  [[nodiscard]] Status write(LongwordOffset offset, std::uint32_t word) RTHS_REALTIME;

  /// Reads a tear group whole: all words are from the same write, the last complete one. This also
  /// holds while its writer is stopped, or has ended, in the middle of a write.
  /// @param words  as long as the group
  /// @returns Stale, with `words` unspecified, if the writer interfered with each of a bounded
  ///          number of attempts; Fault, with `words` unchanged, if the length differs   @realtime
  [[nodiscard]] Status read_group(TearGroupId group,
                                  std::span<std::uint32_t> words) const RTHS_REALTIME;
  /// Writes a tear group whole.
  /// @returns Fault, and writes nothing, if the group belongs to another node or has another length
  /// @realtime
  [[nodiscard]] Status write_group(TearGroupId group,
                                   std::span<const std::uint32_t> words) RTHS_REALTIME;

  /// The words of the ring, without a copy, as other nodes change them: each word is whole, a tear
  /// group may not be. Valid as long as the `Ring`.   @setup
  [[nodiscard]] std::span<const std::uint32_t> memory() const;
  /// The same, to store through, of a node that joined by `join_plain`; empty for others.   @setup
  [[nodiscard]] std::span<std::uint32_t> plain_memory();

  /// From now on, this node's writes do not wake the waiter.   @setup
  void spare(const Waiter& waiter);
  /// Increments this node's heartbeat, which `beats_of` returns to other nodes. Puts the time into
  /// the journal, which dates the writes between two beats.   @realtime
  void beat() RTHS_REALTIME;
  /// The same on the clock of a run.
  /// @param late  the writes since the last beat were due so much earlier, at most 4 s; followers
  ///              that ask for a time get them by that of their due   @realtime
  void beat(TimePoint now, Duration late) RTHS_REALTIME;
  /// Heartbeats of a node of the map since it joined; 0 if it is not on the ring. @realtime
  [[nodiscard]] std::uint64_t beats_of(NodeId node) const RTHS_REALTIME;
  /// True once memory of the ring was lost: then reads return zeros, and no other process sees
  /// writes. See `OnLostMemory`.   @realtime
  [[nodiscard]] bool is_ring_lost() const RTHS_REALTIME;
  /// State of a node of the map, from the kernel's locks. Any thread.   @setup
  [[nodiscard]] Presence presence_of(NodeId node) const;

 private:
  friend class Ring;
  Node(Segment& segment, const memmap::Map& map, std::optional<NodeId> id, bool plain = false);
  void leave() noexcept;

  struct OwnRange {
    std::uint32_t begin, end;  ///< longwords [begin, end)
    [[nodiscard]] bool has(std::uint32_t offset) const { return begin <= offset && offset < end; }
  };
  /// Data that writing a word needs, in adjacent memory.
  struct Writer {
    std::uint32_t* words;  ///< of the ring
    OwnRange range;        ///< of the last write
    Wake* wake;
    JournalWriter journal;
    std::uint32_t spared = 0;  ///< slots that its writes do not wake
  };
  [[nodiscard]] Status write_other_range(LongwordOffset offset, std::uint32_t word) noexcept;
  /// A tear group with its addresses and the last read.
  struct GroupAccess;

  void take_slot(const memmap::Map& map, std::optional<NodeId> id, bool plain);
  void take_over(const memmap::Map& map, NodeId id, bool plain);
  void become_plain(NodeId id) noexcept;
  Segment* segment_;
  std::uint32_t* words_;                    ///< of the ring
  std::unique_ptr<Membership> membership_;  ///< null on a ring of one process
  std::uint32_t slot_ = 0;
  std::uint64_t claim_ = 0;    ///< of the process that joined: a forked child does not leave for
                               ///< it; 0: it only looks
  std::vector<OwnRange> own_;  ///< without tear groups
  mutable std::vector<GroupAccess> groups_;  ///< caches the last read
  std::unique_ptr<Writer> writer_;           ///< of a node that may write
};

inline Status Node::write(LongwordOffset offset, std::uint32_t word) noexcept {
  Writer* const writer = writer_.get();
  if (writer == nullptr || !writer->range.has(offset.value()))
    return write_other_range(offset, word);
  std::atomic_ref{writer->words[offset.value()]}.store(word, std::memory_order_release);
  writer->journal.word(offset.value(), word);
  wake_sleepers(*writer->wake, writer->spared);
  return Status::Ok;
}

/// A software SCRAMNet+ ring: one memory shared by all nodes of a host.
///
/// No daemon: the first process creates the ring, any process joins and leaves, and the ring exists
/// until it is removed. The others can use it further if a process dies. The ring contains its map,
/// so a process that attaches needs no map file.
class Ring {
 public:
  /// Creates a ring to which other processes of this host can attach. Replaces a ring of that name
  /// on which no process is alive. Until this object is destroyed, the creator is listed on the
  /// ring, but not as a node.
  /// Owner and group may write to it, as far as the umask permits.
  /// @throws Error if a ring of that name is in use, keeps cards or is of another user, or if
  ///         memory is short   @setup
  /// @param journal_bits  a journal has 2^journal_bits entries of 16 bytes
  [[nodiscard]] static Ring create(const std::string& name, const memmap::Map& map,
                                   std::uint32_t journal_bits = kJournalBits);
  /// The same, but replaces no ring.
  /// @throws Error if the name is taken, or memory is short   @setup
  [[nodiscard]] static Ring create_new(const std::string& name, const memmap::Map& map,
                                       std::uint32_t journal_bits = kJournalBits);
  /// Attaches to an existing ring.
  /// @throws Error if there is no such ring, its layout version differs or it is damaged   @setup
  [[nodiscard]] static Ring attach(const std::string& name);
  /// Looks at an existing ring from outside: its memory is mapped read-only, and this process takes
  /// no slot and no lock. So it cannot change or delay anything, and the ring can end and be
  /// replaced meanwhile. `observe`, `follow`, `last_write` and `report` work; a node that observes
  /// must not beat.
  /// @throws Error as `attach`   @setup
  [[nodiscard]] static Ring look_at(const std::string& name);
  /// A ring in private memory for one process, with the same words and rules.   @setup
  [[nodiscard]] static Ring in_process(const memmap::Map& map,
                                       std::uint32_t journal_bits = kInProcessJournalBits);

  Ring(Ring&&) noexcept;
  Ring& operator=(Ring&&) noexcept;
  ~Ring();

  [[nodiscard]] const memmap::Map& map() const;
  /// Joins as a node of the map.
  /// @param map_hash  of the map that the caller was built for; 0 accepts any map
  /// @throws Error if the hashes differ (the message shows both), if the map has no such node, if
  ///         that node is already on the ring, or if this is a look at it   @setup
  [[nodiscard]] Node join(const std::string& node, std::uint64_t map_hash);
  /// Joins as a node of the map that stores its words through a plain pointer, without this API:
  /// `Node::write` refuses them, no journal records them, and its tear groups are read word by word
  /// from memory.
  /// @param node  empty: not a node of the map
  /// @throws Error as `join`   @setup
  [[nodiscard]] Node join_plain(const std::string& node);
  /// Joins as a node that only reads.   @setup
  [[nodiscard]] Node observe();
  /// Follows the writes of a node from now on; the node may join later. See follow.hpp.   @setup
  [[nodiscard]] Follower follow(const std::string& node);
  /// The nodes of the map that may write some of these words; all nodes if `words` is empty.
  /// @setup
  [[nodiscard]] std::vector<std::string> writers_of(const std::vector<LongwordRange>& words) const;
  /// Waits for writes to these words, or to any word if `words` is empty. See follow.hpp.
  /// @param longest_spin  before it sleeps; on a single processor it does not spin
  /// @throws Error if this is a look at the ring   @setup
  [[nodiscard]] Waiter wait_for(const std::vector<LongwordRange>& words,
                                Duration longest_spin = kLongestSpin);
  /// Writer and time of the last write to a word.   @setup
  [[nodiscard]] LastWrite last_write(LongwordOffset offset);
  /// State of this ring.   @setup
  [[nodiscard]] RingReport report();
  /// True if the ring of this name is this one. False once it was removed or replaced.   @setup
  [[nodiscard]] bool is_current() const;
  /// The tear group of a partition. @throws Error if the partition is not a tear group   @setup
  [[nodiscard]] TearGroupId tear_group(const std::string& partition) const;

 private:
  friend class Watch;
  explicit Ring(std::unique_ptr<Segment> segment);
  [[nodiscard]] Segment& segment() { return *segment_; }
  /// @throws Error if this is a look at the ring
  void check_writable() const;
  std::unique_ptr<Segment> segment_;
  const memmap::Map* map_;  ///< the segment's
};

/// A process that is on a ring, or that ended without leaving it.
struct Occupant {
  std::string node;     ///< name in the map; "observer" only reads, "client" is not in the map,
                        ///< "creator" created the ring
  int pid = 0;          ///< in its own PID namespace
  std::string process;  ///< its id in words, with its PID namespace if that is another one
  bool has_pid_here = true;  ///< of this PID namespace; if not, `pid` may be another process here
  bool alive = false;
  bool plain = false;  ///< stores through a plain pointer: a program written for the cards
  std::uint64_t beats = 0;
};

/// State of one ring of this host.
struct RingReport {
  std::string name;
  bool usable = false;   ///< complete, and of this program's layout version
  bool foreign = false;  ///< of another layout version, or no permission to open it: may be in use
  std::string
      other_user;       ///< owner, if it is neither this user nor root: not opened, may be in use
  std::string trouble;  ///< reason why the ring is not usable
  std::uint64_t bytes = 0;
  std::string map_name;
  std::uint32_t map_version = 0;
  std::string map_hash;
  std::vector<Occupant> occupants;
  std::uint32_t cards = 0;  ///< cards with memory and registers
  std::vector<std::string>
      torn_groups;  ///< partitions whose writer stopped in the middle of a write

  [[nodiscard]] bool in_use() const {
    for (const auto& occupant : occupants)
      if (occupant.alive) return true;
    return false;
  }
  /// True if only programs written for the cards, and observers, are or were on the ring. It keeps
  /// their cards until it is removed. False for the ring of a run, also of one that crashed.
  [[nodiscard]] bool is_of_cards() const {
    for (const auto& occupant : occupants)
      if (!occupant.plain && occupant.node != "observer") return false;
    return cards != 0;
  }
};

/// State of one ring of this host; empty if there is no object of that name.   @setup
[[nodiscard]] std::optional<RingReport> inspect_ring(const std::string& name);
/// All rings of this host, by name.   @setup
[[nodiscard]] std::vector<RingReport> list_rings();
/// Removes a ring's name; processes that are still on it keep their memory.
/// @returns false if there was no such ring   @setup
bool remove_ring(const std::string& name);
/// The same if no process is on the ring; none can join it meanwhile.
/// @returns false if it is in use or is gone. @throws Error if it may not be opened   @setup
bool remove_unused_ring(const std::string& name);

}  // namespace rths::broker
