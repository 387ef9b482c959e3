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
#include <rths/core/ids.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>
#include <rths/memmap/map.hpp>

namespace rths::broker {

class Segment;
class Follower;
class Waiter;
struct LastWrite;
struct LongwordRange;

/// Sizes of journals, unless asked for otherwise: 1 MiB, which is half a second of a node that
/// writes a hundred words a millisecond, and 64 KiB.
inline constexpr std::uint32_t kJournalBits = 16;
inline constexpr std::uint32_t kInProcessJournalBits = 12;

/// Whether a node is on a ring.
struct Presence {
  enum class State {
    Absent,  ///< nobody holds its place: not joined yet, or left in order
    Alive,
    Vanished,  ///< its process has ended without leaving
  };
  State state = State::Absent;
  int pid = 0;
};

/// A node's place on a ring: reads every word, writes the words of its own partitions.
///
/// One thread reads and writes; `presence_of` and `beats_of` may be called from others. Several
/// nodes, in one process or many, need nothing from each other: a longword is written by one node
/// only, so there is no lock to hold and none to be left held by a process that dies. Leaves the
/// ring when destroyed; must not outlive its `Ring`.
class Node {
 public:
  Node(Node&&) noexcept;
  Node& operator=(Node&&) noexcept;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  /// The longword as last written by anybody.
  /// @pre the offset is inside the ring's memory   @realtime
  [[nodiscard]] std::uint32_t read(LongwordOffset offset) const RTHS_REALTIME;
  /// Makes `word` visible to every node.
  /// @returns Fault, and writes nothing, if the longword is in no partition of this node, or in one
  ///          that is written whole only   @realtime
  [[nodiscard]] Status write(LongwordOffset offset, std::uint32_t word) RTHS_REALTIME;

  /// Reads a tear group whole: the words of one and the same write. If its writer stopped in the
  /// middle of one, for ever or for a while, the last complete one.
  /// @param words  as long as the group
  /// @returns Stale, with `words` unspecified, if a writer outran each of a bounded number of
  ///          attempts; Fault, with `words` untouched, if they have another length   @realtime
  [[nodiscard]] Status read_group(TearGroupId group,
                                  std::span<std::uint32_t> words) const RTHS_REALTIME;
  /// Writes a tear group whole.
  /// @returns Fault, and writes nothing, if the group belongs to another node or has another length
  /// @realtime
  [[nodiscard]] Status write_group(TearGroupId group,
                                   std::span<const std::uint32_t> words) RTHS_REALTIME;

  /// Tells the others that this node is at work; `beats_of` shows it to them. Puts the time into
  /// the journal: what was written since the beat before was written since then.   @realtime
  void beat() RTHS_REALTIME;
  /// How often a node of the map has beaten since it joined; 0 if it is not on the ring. @realtime
  [[nodiscard]] std::uint64_t beats_of(NodeId node) const RTHS_REALTIME;
  /// Whether a node of the map is on the ring, by the kernel's word. Any thread.   @setup
  [[nodiscard]] Presence presence_of(NodeId node) const;

 private:
  friend class Ring;
  Node(Segment& segment, const memmap::Map& map, std::optional<NodeId> id, bool plain = false);
  void leave() noexcept;

  struct OwnRange {
    std::uint32_t begin, end;  ///< longwords [begin, end)
    [[nodiscard]] bool has(std::uint32_t offset) const { return begin <= offset && offset < end; }
  };
  /// What writing a word takes, in one place.
  struct Writer {
    std::uint32_t* words;  ///< of the ring
    OwnRange range;        ///< that was written last
    Wake* wake;
    JournalWriter journal;
  };
  [[nodiscard]] Status write_elsewhere(LongwordOffset offset, std::uint32_t word) noexcept;
  /// A tear group, and what is known about it from the beginning.
  struct GroupAccess;

  void take_over(const memmap::Map& map, NodeId id, bool plain);
  void become_plain() noexcept;
  Segment* segment_;
  std::uint32_t* words_;  ///< of the ring
  std::uint32_t slot_;
  std::vector<OwnRange> own_;                ///< but for tear groups
  mutable std::vector<GroupAccess> groups_;  ///< with what was read last
  std::unique_ptr<Writer> writer_;           ///< of a node that may write
};

inline Status Node::write(LongwordOffset offset, std::uint32_t word) noexcept {
  Writer* const writer = writer_.get();
  if (writer == nullptr || !writer->range.has(offset.value())) return write_elsewhere(offset, word);
  std::atomic_ref{writer->words[offset.value()]}.store(word, std::memory_order_release);
  writer->journal.word(offset.value(), word);
  wake_sleepers(*writer->wake);
  return Status::Ok;
}

/// A software SCRAMNet+ ring: one memory that every node of a host sees at once.
///
/// Daemonless: the first process creates it, any process joins and leaves, and it lasts until it
/// is removed. A process that dies leaves a ring that the others go on using. The map is stored in
/// the ring, so whoever attaches knows what its words mean.
class Ring {
 public:
  /// Makes a ring that the other processes of this host can attach to. An abandoned ring of that
  /// name, on which no process lives, is replaced. The creator is on its ring, though as no node,
  /// until this object goes.
  /// @throws Error if a ring of that name is in use, or there is no room for it   @setup
  /// @param journal_bits  a journal holds 2^journal_bits writes of a node, in 16 bytes each
  [[nodiscard]] static Ring create(const std::string& name, const memmap::Map& map,
                                   std::uint32_t journal_bits = kJournalBits);
  /// Joins processes to an existing ring. Waits up to two seconds for its creator to finish.
  /// @throws Error if there is none, or it is of another layout version   @setup
  [[nodiscard]] static Ring attach(const std::string& name);
  /// A ring in plain memory for one process: the same words, the same rules.   @setup
  [[nodiscard]] static Ring in_process(const memmap::Map& map,
                                       std::uint32_t journal_bits = kInProcessJournalBits);

  Ring(Ring&&) noexcept;
  Ring& operator=(Ring&&) noexcept;
  ~Ring();

  [[nodiscard]] const memmap::Map& map() const;
  /// Joins as a node of the map.
  /// @param map_hash  of the map the caller was built for; 0 to accept whatever the ring holds
  /// @throws Error if the hashes differ (both are shown), the map has no such node, or a living
  ///         process already is that node   @setup
  [[nodiscard]] Node join(const std::string& node, std::uint64_t map_hash);
  /// Joins as a node of the map whose words are stored through a plain pointer, by a program that
  /// knows nothing of this: `Node::write` writes none of them, no journal tells of them, and its
  /// tear groups are read as the words stand.
  /// @param node  empty: none of the map's
  /// @throws Error as `join`   @setup
  [[nodiscard]] Node join_plain(const std::string& node);
  /// Joins as a node that only reads.   @setup
  [[nodiscard]] Node observe();
  /// Follows what a node writes from now on, whether or not it is on the ring yet. See
  /// follow.hpp.   @setup
  [[nodiscard]] Follower follow(const std::string& node);
  /// Waits for writes to these words, or to any if there are none. See follow.hpp.   @setup
  [[nodiscard]] Waiter wait_for(const std::vector<LongwordRange>& words);
  /// Who wrote a word last, and when.   @setup
  [[nodiscard]] LastWrite last_write(LongwordOffset offset);
  /// The tear group of a partition. @throws Error if the partition is none   @setup
  [[nodiscard]] TearGroupId tear_group(const std::string& partition) const;

 private:
  friend class Watch;
  explicit Ring(std::unique_ptr<Segment> segment);
  [[nodiscard]] Segment& segment() { return *segment_; }
  std::unique_ptr<Segment> segment_;
  std::unique_ptr<memmap::Map> map_;
};

/// A process that is, or was, on a ring.
struct Occupant {
  std::string node;  ///< name in the map; "observer" only reads, "client" is none of the map's,
                     ///< "creator" made the ring
  int pid = 0;
  bool alive = false;
  std::uint64_t beats = 0;
};

/// What there is to say about one ring of this host.
struct RingReport {
  std::string name;
  bool usable = false;   ///< finished, and of this program's layout version
  bool foreign = false;  ///< of another layout version, or not ours to open: may be in use
  std::string trouble;   ///< why not, in words
  std::uint64_t bytes = 0;
  std::string map_name;
  std::uint32_t map_version = 0;
  std::string map_hash;
  std::vector<Occupant> occupants;
  std::vector<std::string> torn_groups;  ///< partitions whose writer stopped in the middle

  [[nodiscard]] bool in_use() const {
    for (const auto& occupant : occupants)
      if (occupant.alive) return true;
    return false;
  }
};

/// One ring of this host, if there is an object of that name.   @setup
[[nodiscard]] std::optional<RingReport> inspect_ring(const std::string& name);
/// All rings of this host, by name.   @setup
[[nodiscard]] std::vector<RingReport> list_rings();
/// Removes a ring's name; processes still on it keep their memory. False if there was none. @setup
bool remove_ring(const std::string& name);

}  // namespace rths::broker
