// SPDX-License-Identifier: Apache-2.0
//
// The hot path. One writer per longword; a word is a release store, a group is a sequence lock in
// its fence-free form: data stored with release, loaded with acquire, so that a reader that saw any
// new word also sees the sequence word that was odd before it.
#include <atomic>
#include <utility>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "process.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

constexpr int kGroupReadAttempts = 64;

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
std::optional<int> rival_of(Segment& segment, std::uint32_t slot, NodeId id) {
  for (std::uint32_t i = 0; i < kMaxSlots; ++i) {
    const Claim holder = shared(segment.slots()[i].claim).load();
    const bool same = shared(segment.slots()[i].node).load() == id.value();
    if (i != slot && holder != 0 && same && is_alive(holder)) return pid_of(holder);
  }
  return std::nullopt;
}

Slot* slot_of(Segment& segment, NodeId id) noexcept {
  for (std::uint32_t i = 0; i < kMaxSlots; ++i) {
    Slot& slot = segment.slots()[i];
    if (shared(slot.claim).load(std::memory_order_acquire) != 0 &&
        shared(slot.node).load(std::memory_order_acquire) == id.value())
      return &slot;
  }
  return nullptr;
}

}  // namespace

Node::Node(Segment& segment, const memmap::Map& map, std::optional<NodeId> id)
    : segment_{&segment}, slot_{claim_slot(segment, id ? id->value() : kObserver)} {
  shared(segment.slots()[slot_].node).store(id ? id->value() : kObserver);
  if (!id) return;
  if (const auto rival = rival_of(segment, slot_, *id)) {
    leave();
    throw Error{
        fmt::format("node '{}' is already on the ring, as process {}", map.node_name(*id), *rival)};
  }
  std::uint32_t group = 0;
  for (const auto& partition : map.partitions()) {
    const bool own = map.node(partition.node) == *id;
    if (own) own_.push_back({partition.base.value(), partition.base.value() + partition.longwords});
    if (!partition.tear_group) continue;
    own_groups_.push_back(own);
    // A predecessor may have died in the middle of this group.
    auto sequence = shared(segment.groups()[group].sequence);
    if (own && sequence.load() % 2 != 0) sequence.fetch_add(1);
    ++group;
  }
}

Node::Node(Node&& other) noexcept
    : segment_{std::exchange(other.segment_, nullptr)},
      slot_{other.slot_},
      own_{std::move(other.own_)},
      own_groups_{std::move(other.own_groups_)} {}

Node& Node::operator=(Node&& other) noexcept {
  if (this == &other) return *this;
  leave();
  segment_ = std::exchange(other.segment_, nullptr);
  slot_ = other.slot_;
  own_ = std::move(other.own_);
  own_groups_ = std::move(other.own_groups_);
  return *this;
}

Node::~Node() { leave(); }

void Node::leave() noexcept {
  if (segment_ == nullptr) return;
  Slot& slot = segment_->slots()[slot_];
  shared(slot.node).store(kNotYet);
  shared(slot.claim).store(0);
  segment_ = nullptr;
}

std::uint32_t Node::read(LongwordOffset offset) const noexcept {
  return shared(segment_->words()[offset.value()]).load(std::memory_order_acquire);
}

Status Node::write(LongwordOffset offset, std::uint32_t word) noexcept {
  for (const auto& range : own_) {
    if (offset.value() < range.begin || offset.value() >= range.end) continue;
    shared(segment_->words()[offset.value()]).store(word, std::memory_order_release);
    return Status::Ok;
  }
  return Status::Fault;
}

Status Node::read_group(TearGroupId id, std::span<std::uint32_t> words) const noexcept {
  Group& group = segment_->groups()[id.value()];
  std::uint32_t* from = segment_->words() + group.base;
  for (int attempt = 0; attempt < kGroupReadAttempts; ++attempt) {
    const std::uint32_t before = shared(group.sequence).load(std::memory_order_acquire);
    if (before % 2 != 0) continue;
    for (std::size_t i = 0; i < words.size(); ++i)
      words[i] = shared(from[i]).load(std::memory_order_acquire);
    if (shared(group.sequence).load(std::memory_order_relaxed) == before) return Status::Ok;
  }
  return Status::Stale;
}

Status Node::write_group(TearGroupId id, std::span<const std::uint32_t> words) noexcept {
  if (id.value() >= own_groups_.size() || !own_groups_[id.value()]) return Status::Fault;
  Group& group = segment_->groups()[id.value()];
  std::uint32_t* to = segment_->words() + group.base;
  const std::uint32_t sequence = shared(group.sequence).load(std::memory_order_relaxed);
  shared(group.sequence).store(sequence + 1, std::memory_order_relaxed);
  for (std::size_t i = 0; i < words.size(); ++i)
    shared(to[i]).store(words[i], std::memory_order_release);
  shared(group.sequence).store(sequence + 2, std::memory_order_release);
  return Status::Ok;
}

void Node::beat() noexcept {
  auto beats = shared(segment_->slots()[slot_].beats);
  beats.store(beats.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

std::uint64_t Node::beats_of(NodeId node) const noexcept {
  Slot* slot = slot_of(*segment_, node);
  return slot == nullptr ? 0 : shared(slot->beats).load(std::memory_order_acquire);
}

Presence Node::presence_of(NodeId node) const {
  Slot* slot = slot_of(*segment_, node);
  if (slot == nullptr) return {};
  const Claim claim = shared(slot->claim).load();
  if (claim == 0) return {};
  return {is_alive(claim) ? Presence::State::Alive : Presence::State::Vanished, pid_of(claim)};
}

}  // namespace rths::broker
