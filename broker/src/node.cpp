// SPDX-License-Identifier: Apache-2.0
//
// The hot path. One writer per longword. Writing a word is a release store; writing a group stores
// its record, then its words. Then the writer appends either to its journal.
#include <unistd.h>

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/broker/detail/process.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>

#include "journal.hpp"
#include "record.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

std::atomic_ref<std::uint32_t> journalled(const GroupView& group) {
  return std::atomic_ref{*group.journalled};
}

// True if the writer died after it journalled the group and before it marked it as journalled: then
// the group is the journal's last entry.
bool is_last_entry(const JournalView& journal, const GroupView& group, std::uint32_t count) {
  const std::uint64_t end = end_of(journal);
  const std::uint64_t length = group_entries(group.longwords);
  JournalEntry entry;
  return end >= length && fetch_at(journal, end - length, entry) == Fetched::Entry &&
         entry.kind() == EntryKind::Group && entry.a == group.base && entry.c == count;
}

/// Completes a group whose writer died in the middle of a write: copies the whole one of record and
/// memory into the other. Called by the writer's successor.
/// @returns true if the journal lacks the group's last write
// A writer writes record, memory and journal in this order.
bool repair_group(const GroupView& group, const JournalView& journal) {
  std::uint32_t* record = group.record;
  if (!is_enabled(record)) return false;
  std::vector<std::uint32_t> words(group.longwords);
  if (is_torn(record, group.longwords)) {
    // Restores the previous write, which was journalled. Marks it first: this process may die too.
    const std::uint32_t count = count_of(record);
    journalled(group).store(next_count(count), std::memory_order_release);
    load_words(words, group.words);
    write_record(record, words, count);
    return false;
  }
  if (!read_record(record, words)) return false;
  store_words(group.words, words);
  const std::uint32_t count = count_of(record);
  if (journalled(group).load() != count && is_last_entry(journal, group, count))
    journalled(group).store(count, std::memory_order_release);
  return journalled(group).load() != count;
}

/// Appends a repaired group to the journal.
void journal_repaired_group(const GroupView& group, JournalWriter& journal) {
  std::uint32_t* record = group.record;
  std::vector<std::uint32_t> words(group.longwords);
  if (!read_record(record, words)) return;
  journal.group(group.base, words, count_of(record));
  journalled(group).store(count_of(record), std::memory_order_release);
}

constexpr int kAttempts = 64;
constexpr std::uint32_t kNothingRead = ~0U;  // odd and disabled: no valid count of a bulk record

std::uint64_t now() noexcept { return static_cast<std::uint64_t>(WallClock{}.now().count()); }

template <class T>
std::atomic_ref<T> shared(T& word) noexcept {
  return std::atomic_ref<T>{word};
}

// Claims a slot by one compare-exchange.
bool take(Slot& slot, Claim holder) {
  if (!shared(slot.claim).compare_exchange_strong(holder, own_claim())) return false;
  shared(slot.node).store(kNotYet);
  shared(slot.beats).store(0);
  return true;
}

// Claims the slot of a dead predecessor of this node, else a free slot, else any dead one: the
// slots of other dead nodes stay visible as long as possible.
std::uint32_t claim_slot(Segment& segment, std::uint32_t node) {
  const auto claim_where = [&](auto fits) -> std::optional<std::uint32_t> {
    for (std::uint32_t i = 0; i < kMaxSlots; ++i) {
      Slot& slot = segment.slots()[i];
      const Claim holder = shared(slot.claim).load();
      if (fits(slot, holder) && take(slot, holder)) return i;
    }
    return std::nullopt;
  };
  const auto is_dead = [&](Claim holder) { return holder != 0 && !segment.is_member(holder); };
  if (const auto own = claim_where([&](Slot& slot, Claim holder) {
        return shared(slot.node).load() == node && is_dead(holder);
      }))
    return *own;
  if (const auto free = claim_where([](Slot&, Claim holder) { return holder == 0; })) return *free;
  if (const auto dead = claim_where([&](Slot&, Claim holder) { return is_dead(holder); }))
    return *dead;
  throw Error{fmt::format("the ring is full: {} processes are on it", kMaxSlots)};
}

// If two processes join as the same node at once, each finds the other here, and both give up.
std::optional<Claim> conflicting_process(Segment& segment, const Slot& own, NodeId id) {
  for (Slot& slot : segment.slots()) {
    const Claim holder = shared(slot.claim).load();
    const bool same = shared(slot.node).load() == id.value();
    if (&slot != &own && holder != 0 && same && segment.is_member(holder)) return holder;
  }
  return std::nullopt;
}

// The writer is stopped or dead in the middle of a write, or writes very often, or is plain.
Status read_disturbed(std::uint32_t* record, std::uint32_t* memory,
                      std::span<std::uint32_t> words) noexcept {
  for (int attempt = 0; attempt < kAttempts; ++attempt)
    if (read_memory(record, memory, words) || read_record(record, words)) return Status::Ok;
  return Status::Stale;
}

}  // namespace

struct Node::GroupAccess : GroupView {
  bool own = false;
  std::uint32_t count = 0;  ///< of the last write, if the group is this node's
  /// Last read of a bulk record. While its count is unchanged, a read touches no other line of the
  /// record, since the writer must fetch back every line that a reader touches.
  std::uint32_t read_count = kNothingRead;
  std::vector<std::uint32_t> read = {};  // NOLINT(readability-redundant-member-init)
};

Node::Node(Segment& segment, const memmap::Map& map, std::optional<NodeId> id, bool plain)
    : segment_{&segment}, words_{segment.words()}, membership_{segment.enter()} {
  if (!segment.is_read_only()) take_slot(map, id, plain);
  try {
    segment.populate();
    for (const GroupView& group : segment.groups()) {
      groups_.push_back({group, id && group.journal == node_index(map, *id)});
      if (record_kind(group.longwords) == RecordKind::Bulk)
        groups_.back().read.resize(group.longwords);
    }
    if (id) take_over(map, *id, plain);
  } catch (...) {
    leave();
    throw;
  }
}

void Node::take_slot(const memmap::Map& map, std::optional<NodeId> id, bool plain) {
  slot_ = claim_slot(*segment_, id ? id->value() : kObserver);
  Slot& slot = segment_->slots()[slot_];
  claim_ = shared(slot.claim).load();
  shared(slot.plain).store(!id && plain ? 1 : 0);  // become_plain() sets it for a node of the map
  shared(slot.node).store(id ? id->value() : kObserver);
  if (!id) return;
  if (const auto rival = conflicting_process(*segment_, slot, *id)) {
    leave();
    throw Error{fmt::format(
        "node '{}' is already on the ring, as {}; end that process, or join as another node",
        map.node_name(*id), in_words(*rival))};
  }
}

// Sets up the node's own words and completes what a dead predecessor left unfinished. A plain node
// writes to the journal only for that: a watch may be journalling on its behalf.
void Node::take_over(const memmap::Map& map, NodeId id, bool plain) {
  const JournalView journal = segment_->journal(node_index(map, id));
  register_as_writer();
  std::vector<const GroupView*> unjournalled;
  for (auto& access : groups_) {
    if (!access.own) continue;
    if (repair_group(access, journal)) unjournalled.push_back(&access);
    access.count = count_of(access.record);
  }
  if (!unjournalled.empty()) {
    JournalWriter writer{journal};
    for (const GroupView* group : unjournalled) journal_repaired_group(*group, writer);
    wake_sleepers(segment_->wake());
  }
  if (plain) return become_plain(id);
  for (const auto& partition : map.partitions())
    if (!partition.tear_group && map.node(partition.node) == id)
      own_.push_back({partition.base.value(), partition.base.value() + partition.longwords});
  writer_ =
      std::make_unique<Writer>(Writer{words_, {0, 0}, &segment_->wake(), JournalWriter{journal}});
  writer_->journal.time(now(), Duration{0});
}

void Node::become_plain(NodeId id) noexcept {
  for (auto& access : groups_) {
    if (access.own) disable_record(access.record);
    access.own = false;
  }
  Slot& slot = segment_->slots()[slot_];
  const std::uint64_t joins = (shared(slot.plain_joins).load() >> 32U) + 1;
  shared(slot.plain_joins).store(joins << 32U | id.value());
  shared(slot.plain).store(1);
}

Node::Node(Node&& other) noexcept
    : segment_{std::exchange(other.segment_, nullptr)},
      words_{other.words_},
      membership_{std::move(other.membership_)},
      slot_{other.slot_},
      claim_{other.claim_},
      own_{std::move(other.own_)},
      groups_{std::move(other.groups_)},
      writer_{std::move(other.writer_)} {}

Node& Node::operator=(Node&& other) noexcept {
  if (this == &other) return *this;
  leave();
  segment_ = std::exchange(other.segment_, nullptr);
  words_ = other.words_;
  membership_ = std::move(other.membership_);
  slot_ = other.slot_;
  claim_ = other.claim_;
  own_ = std::move(other.own_);
  groups_ = std::move(other.groups_);
  writer_ = std::move(other.writer_);
  return *this;
}

Node::~Node() { leave(); }

void Node::leave() noexcept {
  if (segment_ == nullptr) return;
  Slot& slot = std::exchange(segment_, nullptr)->slots()[slot_];
  Claim self = claim_;
  // A forked child has a copy of its parent's node. Another process takes the slot of a dead one.
  if (self != own_claim() || shared(slot.claim).load() != self) return;
  if (writer_) writer_->journal.time(now(), Duration{0});
  shared(slot.node).store(kNotYet);
  shared(slot.claim).compare_exchange_strong(self, 0);
}

std::uint32_t Node::read(LongwordOffset offset) const noexcept {
  return shared(words_[offset.value()]).load(std::memory_order_acquire);
}

// The offset is not in the range of the last write: finds its range among the node's own.
Status Node::write_other_range(LongwordOffset offset, std::uint32_t word) noexcept {
  for (const auto& range : own_) {
    if (!range.has(offset.value())) continue;
    writer_->range = range;
    return write(offset, word);
  }
  return Status::Fault;
}

Status Node::read_group(TearGroupId id, std::span<std::uint32_t> words) const noexcept {
  if (id.value() >= groups_.size()) return Status::Fault;
  GroupAccess& access = groups_[id.value()];
  if (words.size() != access.longwords) return Status::Fault;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::uint32_t count = count_of(access.record);
    if (!access.read.empty() && count == access.read_count) {
      load_words(words, access.read.data());
      return Status::Ok;
    }
    if (read_record(access.record, words, count)) {
      if (access.read.empty()) return Status::Ok;
      access.read_count = count;
      store_words(access.read.data(), words);
      return Status::Ok;
    }
    if ((count & kDisabled) != 0) break;
  }
  return read_disturbed(access.record, access.words, words);
}

Status Node::write_group(TearGroupId id, std::span<const std::uint32_t> words) noexcept {
  if (id.value() >= groups_.size()) return Status::Fault;
  GroupAccess& access = groups_[id.value()];
  if (!access.own || words.size() != access.longwords) return Status::Fault;
  access.count = write_record(access.record, words, access.count);
  store_words(access.words, words);
  Writer& writer = *writer_;
  writer.journal.group(access.base, words, access.count);
  shared(*access.journalled).store(access.count, std::memory_order_release);
  wake_sleepers(*writer.wake, writer.spared);
  return Status::Ok;
}

std::span<const std::uint32_t> Node::memory() const {
  return {words_, segment_->map().description().size_longwords};
}

std::span<std::uint32_t> Node::plain_memory() {
  if (shared(segment_->slots()[slot_].plain).load() == 0) return {};
  return {words_, segment_->map().description().size_longwords};
}

void Node::beat() noexcept { beat(WallClock{}.now(), Duration{0}); }

void Node::beat(TimePoint now, Duration late) noexcept {
  auto beats = shared(segment_->slots()[slot_].beats);
  beats.store(beats.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  if (writer_) writer_->journal.time(static_cast<std::uint64_t>(now.count()), late);
}

bool Node::is_ring_lost() const noexcept { return segment_->is_lost(); }

std::uint64_t Node::beats_of(NodeId node) const noexcept {
  Slot* slot = segment_->slot_of(node);
  return slot == nullptr ? 0 : shared(slot->beats).load(std::memory_order_acquire);
}

Presence Node::presence_of(NodeId node) const {
  Slot* slot = segment_->slot_of(node);
  if (slot == nullptr) return {};
  const Claim claim = shared(slot->claim).load();
  if (claim == 0) return {};
  return {segment_->is_member(claim) ? Presence::State::Alive : Presence::State::Vanished,
          pid_of(claim)};
}

}  // namespace rths::broker
