// SPDX-License-Identifier: Apache-2.0
//
// The hot path. One writer per longword. A word is a release store; a group is a record that is
// read whole, and its words. Then either goes into its writer's journal.
#include <atomic>
#include <utility>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>

#include "mend.hpp"
#include "process.hpp"
#include "record.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

constexpr int kAttempts = 64;
constexpr std::uint32_t kNothingRead = ~0U;  // odd, of no keeper: no record of several lines has it

std::uint64_t now() noexcept { return static_cast<std::uint64_t>(WallClock{}.now().count()); }

template <class T>
std::atomic_ref<T> shared(T& word) noexcept {
  return std::atomic_ref<T>{word};
}

// A slot becomes ours by one compare-exchange.
bool take(Slot& slot, Claim holder) {
  if (!shared(slot.claim).compare_exchange_strong(holder, own_claim())) return false;
  shared(slot.node).store(kNotYet);
  shared(slot.beats).store(0);
  return true;
}

// First the place of our own predecessor that died, then a free one. That a node of another name
// died stays to be seen, unless there is no other place.
std::uint32_t claim_slot(Segment& segment, std::uint32_t node) {
  const auto claim_where = [&](auto fits) -> std::optional<std::uint32_t> {
    for (std::uint32_t i = 0; i < kMaxSlots; ++i) {
      Slot& slot = segment.slots()[i];
      const Claim holder = shared(slot.claim).load();
      if (fits(slot, holder) && take(slot, holder)) return i;
    }
    return std::nullopt;
  };
  const auto is_dead = [](Claim holder) { return holder != 0 && !is_alive(holder); };
  if (const auto own = claim_where([&](Slot& slot, Claim holder) {
        return is_dead(holder) && shared(slot.node).load() == node;
      }))
    return *own;
  if (const auto free = claim_where([](Slot&, Claim holder) { return holder == 0; })) return *free;
  if (const auto dead = claim_where([&](Slot&, Claim holder) { return is_dead(holder); }))
    return *dead;
  throw Error{fmt::format("the ring is full: {} processes are on it", kMaxSlots)};
}

// Of two processes that become the same node at once, both see the other here, and both give way.
std::optional<int> rival_of(Segment& segment, const Slot& own, NodeId id) {
  for (Slot& slot : segment.slots()) {
    const Claim holder = shared(slot.claim).load();
    const bool same = shared(slot.node).load() == id.value();
    if (&slot != &own && holder != 0 && same && is_alive(holder)) return pid_of(holder);
  }
  return std::nullopt;
}

}  // namespace

struct Node::GroupAccess {
  Group* group;
  std::uint32_t* record;
  std::uint32_t* words;
  std::uint32_t longwords;
  bool own;
  std::uint32_t count = 0;  ///< of the last write, if it is our own
  /// What was read last of a record of several lines. While its count stands, the others are left
  /// alone: a writer has to fetch back every line that somebody looked at.
  std::uint32_t read_count = kNothingRead;
  std::vector<std::uint32_t> read = {};
};

Node::Node(Segment& segment, const memmap::Map& map, std::optional<NodeId> id, bool plain)
    : segment_{&segment},
      words_{segment.words()},
      slot_{claim_slot(segment, id ? id->value() : kObserver)} {
  shared(segment.slots()[slot_].plain)
      .store(!id && plain ? 1 : 0);  // a node's only when it is ready
  shared(segment.slots()[slot_].node).store(id ? id->value() : kObserver);
  if (id) {
    if (const auto rival = rival_of(segment, segment.slots()[slot_], *id)) {
      leave();
      throw Error{fmt::format("node '{}' is already on the ring, as process {}", map.node_name(*id),
                              *rival)};
    }
  }
  try {
    segment.populate();
    for (std::uint64_t i = 0; i < segment.header().group_count; ++i) {
      Group& group = segment.groups()[i];
      const bool own = id && group.journal == node_place(map, *id);
      groups_.push_back(
          {&group, segment.record(group), segment.words() + group.base, group.longwords, own});
      if (record_kind(group.longwords) == RecordKind::Bulk)
        groups_.back().read.resize(group.longwords);
    }
    if (id) take_over(map, *id, plain);
  } catch (...) {
    leave();
    throw;
  }
}

// What is a node's own, and what a predecessor may have left unfinished. A plain node leaves the
// journal alone unless there is something of that kind: somebody may be keeping it for it.
void Node::take_over(const memmap::Map& map, NodeId id, bool plain) {
  const JournalPlace place = segment_->journal(node_place(map, id));
  register_as_writer();
  std::vector<Group*> unjournalled;
  for (auto& access : groups_) {
    if (!access.own) continue;
    if (mend_group(*segment_, *access.group, place)) unjournalled.push_back(access.group);
    access.count = count_of(access.record);
  }
  if (!unjournalled.empty()) {
    JournalWriter journal{place};
    for (Group* group : unjournalled) journal_mended_group(*segment_, *group, journal);
    wake_sleepers(segment_->wake());
  }
  if (plain) return become_plain();
  for (const auto& partition : map.partitions())
    if (!partition.tear_group && map.node(partition.node) == id)
      own_.push_back({partition.base.value(), partition.base.value() + partition.longwords});
  writer_.reset(new Writer{words_, {0, 0}, &segment_->wake(), JournalWriter{place}});
  writer_->journal.time(now());
}

void Node::become_plain() noexcept {
  for (auto& access : groups_) {
    if (access.own) keep_no_longer(access.record);
    access.own = false;
  }
  shared(segment_->slots()[slot_].plain).store(1);
}

Node::Node(Node&& other) noexcept
    : segment_{std::exchange(other.segment_, nullptr)},
      words_{other.words_},
      slot_{other.slot_},
      own_{std::move(other.own_)},
      groups_{std::move(other.groups_)},
      writer_{std::move(other.writer_)} {}

Node& Node::operator=(Node&& other) noexcept {
  if (this == &other) return *this;
  leave();
  segment_ = std::exchange(other.segment_, nullptr);
  words_ = other.words_;
  slot_ = other.slot_;
  own_ = std::move(other.own_);
  groups_ = std::move(other.groups_);
  writer_ = std::move(other.writer_);
  return *this;
}

Node::~Node() { leave(); }

void Node::leave() noexcept {
  if (segment_ == nullptr) return;
  if (writer_) writer_->journal.time(now());
  Slot& slot = segment_->slots()[slot_];
  shared(slot.node).store(kNotYet);
  shared(slot.claim).store(0);
  segment_ = nullptr;
}

std::uint32_t Node::read(LongwordOffset offset) const noexcept {
  return shared(words_[offset.value()]).load(std::memory_order_acquire);
}

// Another range than the time before, or none of this node's.
Status Node::write_elsewhere(LongwordOffset offset, std::uint32_t word) noexcept {
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
    if ((count & kPlain) != 0) break;
  }
  // Its writer stands still in the middle, or is very busy; or it is none of ours.
  for (int attempt = 0; attempt < kAttempts; ++attempt)
    if (read_memory(access.record, access.words, words) || read_record(access.record, words))
      return Status::Ok;
  return Status::Stale;
}

Status Node::write_group(TearGroupId id, std::span<const std::uint32_t> words) noexcept {
  if (id.value() >= groups_.size()) return Status::Fault;
  GroupAccess& access = groups_[id.value()];
  if (!access.own || words.size() != access.longwords) return Status::Fault;
  access.count = write_record(access.record, words, access.count);
  store_words(access.words, words);
  Writer& writer = *writer_;
  writer.journal.group(access.group->base, words, access.count);
  shared(access.group->journalled).store(access.count, std::memory_order_release);
  wake_sleepers(*writer.wake);
  return Status::Ok;
}

void Node::beat() noexcept {
  auto beats = shared(segment_->slots()[slot_].beats);
  beats.store(beats.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  if (writer_) writer_->journal.time(now());
}

std::uint64_t Node::beats_of(NodeId node) const noexcept {
  Slot* slot = segment_->slot_of(node);
  return slot == nullptr ? 0 : shared(slot->beats).load(std::memory_order_acquire);
}

Presence Node::presence_of(NodeId node) const {
  Slot* slot = segment_->slot_of(node);
  if (slot == nullptr) return {};
  const Claim claim = shared(slot->claim).load();
  if (claim == 0) return {};
  return {is_alive(claim) ? Presence::State::Alive : Presence::State::Vanished, pid_of(claim)};
}

}  // namespace rths::broker
