// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/watch.hpp>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>

#include <rths/broker/follow.hpp>

#include "process.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

constexpr std::size_t kChunkWords = 16;  // compared at once: a cache line
// The scheduler may stop a writer between a word and its journal entry; such a store is no error.
constexpr Duration kConfirmation = std::chrono::milliseconds{100};

}  // namespace

struct Watch::State {
  /// A node of the map.
  struct Member {
    std::string name;
    NodeId id;
    Follower follower;  ///< from the start, to see also the first writes after joining
    Claim plain = 0;    ///< process that is this node as a plain client; 0: none
    std::optional<JournalWriter> on_behalf = std::nullopt;  ///< writes a plain client's journal
  };

  Ring& ring;
  Segment& segment;
  Node observer;
  std::vector<Member> members;
  std::vector<std::uint32_t> expected;  ///< value of each word by the journals
  struct Suspect {
    std::uint32_t value;
    TimePoint since;
  };
  std::map<std::uint32_t, Suspect> suspects;  ///< by word

  void update_members();
  void read_journals();
  void expect(const Write& write);
  void accept_words_of(const std::string& owner);
  void journal(Member& owner, std::uint32_t offset, std::uint32_t value);
  void compare(std::vector<PlainStore>& found);
  void check_word(std::uint32_t offset, std::uint32_t value, std::vector<PlainStore>& found);
  /// The process that is this node as a plain client; 0: none.
  [[nodiscard]] Claim plain_holder(NodeId id);
  [[nodiscard]] std::vector<std::string> plain_clients();
  [[nodiscard]] std::uint32_t word(std::uint32_t offset) {
    return std::atomic_ref{segment.words()[offset]}.load(std::memory_order_acquire);
  }
};

Claim Watch::State::plain_holder(NodeId id) {
  Slot* slot = segment.slot_of(id);
  if (slot == nullptr || std::atomic_ref{slot->plain}.load() == 0) return 0;
  const Claim claim = std::atomic_ref{slot->claim}.load();
  return is_alive(claim) ? claim : 0;
}

// A node that joins or leaves is noticed at the next look.
void Watch::State::update_members() {
  for (auto& member : members) {
    const Claim plain = plain_holder(member.id);
    if (plain == member.plain) continue;
    member.plain = plain;
    member.on_behalf.reset();
    if (plain != 0) member.on_behalf.emplace(segment.journal(node_index(ring.map(), member.id)));
  }
}

void Watch::State::read_journals() {
  Write write;
  for (auto& member : members) {
    for (;;) {
      const Followed followed = member.follower.next(write);
      if (followed == Followed::Nothing) break;
      if (followed == Followed::Lost && member.on_behalf) continue;  // our own entries
      if (followed == Followed::Lost)
        accept_words_of(member.name);
      else
        expect(write);
    }
  }
}

void Watch::State::expect(const Write& write) {
  if (write.group.empty())
    expected[write.offset.value()] = write.value;
  else
    std::copy(write.group.begin(), write.group.end(), expected.begin() + write.offset.value());
}

void Watch::State::accept_words_of(const std::string& owner) {
  for (const auto& partition : ring.map().partitions())
    if (partition.node == owner)
      for (std::uint32_t i = 0; i < partition.longwords; ++i)
        expected[partition.base.value() + i] = word(partition.base.value() + i);
}

void Watch::State::journal(Member& owner, std::uint32_t offset, std::uint32_t value) {
  owner.on_behalf->word_of(owner.id.value(), offset, value);
  wake_sleepers(segment.wake());
}

std::vector<std::string> Watch::State::plain_clients() {
  std::vector<std::string> names;
  for (Slot& slot : segment.slots()) {
    const Claim claim = std::atomic_ref{slot.claim}.load();
    if (claim == 0 || std::atomic_ref{slot.plain}.load() == 0) continue;
    const std::uint32_t node = std::atomic_ref{slot.node}.load();
    const std::string name =
        node <= 0xFF ? ring.map().node_name(NodeId{static_cast<std::uint16_t>(node)}) : "a client";
    names.push_back(name + " (process " + std::to_string(pid_of(claim)) + ")");
  }
  return names;
}

void Watch::State::check_word(std::uint32_t offset, std::uint32_t value,
                              std::vector<PlainStore>& found) {
  const auto* partition = ring.map().partition_at(LongwordOffset{offset});
  PlainStore store{
      LongwordOffset{offset}, value, partition == nullptr ? "" : partition->node, false, {},
      WallClock{}.now()};
  const auto owner = std::find_if(members.begin(), members.end(),
                                  [&](const Member& m) { return m.name == store.owner; });
  if (owner != members.end() && owner->on_behalf) {
    journal(*owner, offset, value);
    store.allowed = true;
  } else {
    const auto [suspect, is_new] = suspects.try_emplace(offset, Suspect{value, store.seen});
    if (suspect->second.value != value) suspect->second = {value, store.seen};
    if (is_new || store.seen - suspect->second.since < kConfirmation) return;
    store.others = plain_clients();
  }
  suspects.erase(offset);
  expected[offset] = value;
  found.push_back(std::move(store));
}

void Watch::State::compare(std::vector<PlainStore>& found) {
  for (std::uint32_t begin = 0; begin < expected.size(); begin += kChunkWords) {
    const auto length = std::min<std::size_t>(kChunkWords, expected.size() - begin);
    // Looks at the words one by one only in a chunk that differs.
    std::uint32_t difference = 0;
    for (std::uint32_t i = begin; i < begin + length; ++i) difference |= word(i) ^ expected[i];
    if (difference == 0) continue;
    for (std::uint32_t i = begin; i < begin + length; ++i) {
      const std::uint32_t now = word(i);
      if (now == expected[i])
        suspects.erase(i);
      else
        check_word(i, now, found);
    }
  }
}

Watch::Watch(Ring& ring) : state_{new State{ring, ring.segment(), ring.observe(), {}, {}, {}}} {
  std::uint32_t end = 0;
  for (const auto& partition : ring.map().partitions())
    end = std::max(end, partition.base.value() + partition.longwords);
  for (const auto& node : ring.map().description().nodes)
    state_->members.push_back({node.name, node.id, ring.follow(node.name)});
  register_as_writer();
  state_->update_members();
  for (std::uint32_t i = 0; i < end; ++i) state_->expected.push_back(state_->word(i));
}

Watch::~Watch() = default;

std::vector<PlainStore> Watch::look() {
  std::vector<PlainStore> found;
  state_->update_members();
  const auto now = static_cast<std::uint64_t>(WallClock{}.now().count());
  for (auto& member : state_->members)
    if (member.on_behalf) member.on_behalf->time(now);
  state_->read_journals();
  state_->compare(found);
  return found;
}

}  // namespace rths::broker
