// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/watch.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <optional>

#include <fmt/format.h>

#include <rths/broker/detail/process.hpp>
#include <rths/broker/follow.hpp>
#include <rths/core/error.hpp>

#include "segment.hpp"

namespace rths::broker {
namespace {

constexpr int kMostWrites = 1 << 20;     // of a node, read in one look
constexpr std::size_t kChunkWords = 16;  // compared at once: a cache line
// The scheduler may stop a writer between a word and its journal entry; such a store is no error.
// For owners without heartbeats.
constexpr Duration kConfirmation = std::chrono::milliseconds{100};

}  // namespace

struct Watch::State {
  /// The right to journal on behalf of plain clients: a journal has one writer.
  class OnlyWatch {
   public:
    /// @throws Error if a living process watches the ring
    explicit OnlyWatch(Segment& segment) : watcher_{segment.header().watcher}, self_{own_claim()} {
      Claim holder = watcher_.load();
      if (segment.is_member(holder) || !watcher_.compare_exchange_strong(holder, self_))
        throw Error{
            fmt::format("{} watches the ring, expected one watch of a ring; end that process",
                        in_words(holder))};
    }
    ~OnlyWatch() {
      if (self_ == own_claim()) watcher_.compare_exchange_strong(self_, 0);
    }
    OnlyWatch(const OnlyWatch&) = delete;
    OnlyWatch& operator=(const OnlyWatch&) = delete;

   private:
    std::atomic_ref<Claim> watcher_;
    Claim self_;
  };

  /// A node of the map.
  struct Member {
    std::string name;
    NodeId id;
    Follower follower;        ///< from the start, to see also the first writes after joining
    Claim plain = 0;          ///< process that is this node as a plain client; 0: none
    bool was_plain = false;   ///< a plain client was this node at some time since the last look
    std::uint64_t beats = 0;  ///< before the journals were read
    std::optional<JournalWriter> on_behalf = std::nullopt;  ///< writes a plain client's journal
  };

  Ring& ring;
  Segment& segment;
  bool journals;
  std::optional<OnlyWatch> only;
  Node observer;
  std::vector<Member> members;
  std::vector<std::uint32_t> expected;  ///< value of each word by the journals
  /// A word whose changes tell others that data are ready: an event signal of the map.
  struct Flag {
    std::uint32_t offset, value;
  };
  std::vector<Flag> flags;
  std::vector<bool> is_flag;  ///< by word
  struct Suspect {
    std::uint32_t value;
    TimePoint since;
    std::uint64_t beats;  ///< of the word's owner, after the value was seen
  };
  std::map<std::uint32_t, Suspect> suspects;           ///< by word
  std::array<std::uint64_t, kMaxSlots> plain_joins{};  ///< of each slot, at the last look
  const std::function<Judgement(LongwordOffset)>* judge = nullptr;  ///< of this look

  void note_plain_joins();
  void update_members(std::vector<PlainStore>& found);
  [[nodiscard]] bool settle(Member& member, std::vector<PlainStore>& found);
  [[nodiscard]] bool settle_word(Member& member, LongwordOffset offset,
                                 std::vector<PlainStore>& found);
  void read_journals();
  void expect(const Write& write);
  void accept_words_of(const std::string& owner);
  void journal(Member& owner, PlainStore store, std::vector<PlainStore>& found);
  void observe_plain(Member& member);
  void suspect(const PlainStore& store, const Member* owner);
  enum class Verdict { Open, Foreign, Unknown };
  [[nodiscard]] Verdict verdict_on(const Suspect& suspect, const Member* owner, TimePoint now);
  void judge_suspects(std::vector<PlainStore>& found);
  [[nodiscard]] Member* member_of(const std::string& node);
  void compare(std::vector<PlainStore>& found);
  void compare_data(std::vector<PlainStore>& found);
  [[nodiscard]] Judgement judged(LongwordOffset offset, std::uint32_t value);
  [[nodiscard]] Member* plain_member(const std::string& node);
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
  return segment.is_member(claim) ? claim : 0;
}

// A plain client may join, store and leave between two looks.
void Watch::State::note_plain_joins() {
  for (std::uint32_t i = 0; i < kMaxSlots; ++i) {
    const std::uint64_t joins = std::atomic_ref{segment.slots()[i].plain_joins}.load();
    if (joins == plain_joins[i]) continue;
    plain_joins[i] = joins;
    for (auto& member : members)
      if (member.id.value() == (joins & 0xFFFF'FFFF)) member.was_plain = true;
  }
}

// A node that joins or leaves is noticed at the next look.
void Watch::State::update_members(std::vector<PlainStore>& found) {
  note_plain_joins();
  for (auto& member : members) {
    if (!journals) {
      observe_plain(member);
      continue;
    }
    const Claim plain = plain_holder(member.id);
    if (plain == 0 && member.was_plain && !settle(member, found)) continue;
    member.was_plain = plain != 0;
    if (plain == member.plain) continue;
    member.plain = plain;
    member.on_behalf.reset();
    if (plain != 0) member.on_behalf.emplace(segment.journal(node_index(ring.map(), member.id)));
  }
}

// All values of a plain client's words are its own.
void Watch::State::observe_plain(Member& member) {
  const Slot* slot = segment.slot_of(member.id);
  const bool is_plain = slot != nullptr && std::atomic_ref{slot->plain}.load() != 0;
  if (is_plain || member.was_plain) accept_words_of(member.name);
  member.was_plain = is_plain;
}

// The last stores of a plain client that has left are its own. If a node that journals has joined
// since, the journal is that node's.
// @returns false while stores are left to who judges; then the client stays for the next look
bool Watch::State::settle(Member& member, std::vector<PlainStore>& found) {
  Slot* slot = segment.slot_of(member.id);
  if (slot != nullptr && std::atomic_ref{slot->plain}.load() == 0) {
    accept_words_of(member.name);
    return true;
  }
  if (!member.on_behalf)
    member.on_behalf.emplace(segment.journal(node_index(ring.map(), member.id)));
  bool complete = true;
  for (const auto& partition : ring.map().partitions()) {
    if (partition.node != member.name) continue;
    for (std::uint32_t i = 0; i < partition.longwords; ++i)
      complete = settle_word(member, LongwordOffset{partition.base.value() + i}, found) && complete;
  }
  if (complete) member.on_behalf.reset();
  return complete;
}

// @returns false if the word is left to who judges
bool Watch::State::settle_word(Member& member, LongwordOffset offset,
                               std::vector<PlainStore>& found) {
  const std::uint32_t value = word(offset.value());
  if (value == expected[offset.value()]) return true;
  const Judgement judgement = judged(offset, value);
  if (judgement == Judgement::Take)
    journal(member, {offset, value, member.name, true, {}, WallClock{}.now()}, found);
  return judgement != Judgement::Leave;
}

void Watch::State::read_journals() {
  Write write;
  for (auto& member : members) {
    for (int i = 0; i < kMostWrites; ++i) {
      const Followed followed = member.follower.next(write);
      if (followed == Followed::Write) {
        expect(write);
        continue;
      }
      if (followed == Followed::Lost && !member.on_behalf) accept_words_of(member.name);
      break;
    }
  }
}

// The journal of a damaged ring may have words of no partition.
void Watch::State::expect(const Write& write) {
  const std::uint32_t begin = write.offset.value();
  const std::span<const std::uint32_t> values =
      write.group.empty() ? std::span{&write.value, 1} : write.group;
  if (begin + values.size() > expected.size()) return;
  std::copy(values.begin(), values.end(), expected.begin() + begin);
  for (auto at = suspects.lower_bound(begin); at != suspects.end();) {
    const std::uint32_t i = at->first - begin;
    if (i >= values.size()) break;
    at = at->second.value == values[i] ? suspects.erase(at) : std::next(at);
  }
}

void Watch::State::accept_words_of(const std::string& owner) {
  for (const auto& partition : ring.map().partitions())
    if (partition.node == owner) {
      const std::uint32_t begin = partition.base.value(), end = begin + partition.longwords;
      for (std::uint32_t i = begin; i < end; ++i) expected[i] = word(i);
      suspects.erase(suspects.lower_bound(begin), suspects.lower_bound(end));
    }
}

void Watch::State::journal(Member& owner, PlainStore store, std::vector<PlainStore>& found) {
  owner.on_behalf->word_of(owner.id.value(), store.offset.value(), store.value);
  wake_sleepers(segment.wake());
  expected[store.offset.value()] = store.value;
  found.push_back(std::move(store));
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

// The first value stays until it is explained or judged, also if another follows.
void Watch::State::suspect(const PlainStore& store, const Member* owner) {
  const auto [at, is_new] = suspects.try_emplace(store.offset.value());
  if (is_new)
    at->second = {store.value, store.seen, owner == nullptr ? 0 : observer.beats_of(owner->id)};
}

// The owner may be stopped between a word and its journal entry. If it beats, it has journalled the
// word before its next beat, and this look has read that journal after the beat.
Watch::State::Verdict Watch::State::verdict_on(const Suspect& suspect, const Member* owner,
                                               TimePoint now) {
  const bool is_old = now - suspect.since >= kConfirmation;
  if (owner == nullptr || suspect.beats == 0) return is_old ? Verdict::Foreign : Verdict::Open;
  if (owner->beats > suspect.beats) return Verdict::Foreign;
  if (owner->beats < suspect.beats && owner->beats > 0) return Verdict::Unknown;  // a successor
  if (!is_old) return Verdict::Open;
  const auto state = observer.presence_of(owner->id).state;
  if (state == Presence::State::Alive) return Verdict::Open;
  // One that vanished may have ended before the entry.
  return state == Presence::State::Absent ? Verdict::Foreign : Verdict::Unknown;
}

void Watch::State::judge_suspects(std::vector<PlainStore>& found) {
  const TimePoint now = WallClock{}.now();
  for (auto at = suspects.begin(); at != suspects.end();) {
    const auto& [offset, suspect] = *at;
    const auto* partition = ring.map().partition_at(LongwordOffset{offset});
    const std::string owner = partition == nullptr ? "" : partition->node;
    const Verdict verdict = verdict_on(suspect, member_of(owner), now);
    if (verdict == Verdict::Open) {
      ++at;
      continue;
    }
    if (verdict == Verdict::Foreign)
      found.push_back(
          {LongwordOffset{offset}, suspect.value, owner, false, plain_clients(), suspect.since});
    if (word(offset) == suspect.value) expected[offset] = suspect.value;
    at = suspects.erase(at);
  }
}

Watch::State::Member* Watch::State::member_of(const std::string& node) {
  const auto member = std::find_if(members.begin(), members.end(),
                                   [&](const Member& one) { return one.name == node; });
  return member == members.end() ? nullptr : &*member;
}

// A plain client's store to its own word.
Judgement Watch::State::judged(LongwordOffset offset, std::uint32_t value) {
  const Judgement judgement = judge != nullptr && *judge ? (*judge)(offset) : Judgement::Take;
  if (judgement == Judgement::Restore)
    std::atomic_ref{segment.words()[offset.value()]}.compare_exchange_strong(
        value, expected[offset.value()]);
  return judgement;
}

Watch::State::Member* Watch::State::plain_member(const std::string& node) {
  Member* const member = member_of(node);
  return member != nullptr && member->on_behalf ? member : nullptr;
}

void Watch::State::check_word(std::uint32_t offset, std::uint32_t value,
                              std::vector<PlainStore>& found) {
  const auto* partition = ring.map().partition_at(LongwordOffset{offset});
  PlainStore store{
      LongwordOffset{offset}, value, partition == nullptr ? "" : partition->node, false, {},
      WallClock{}.now()};
  Member* const owner = member_of(store.owner);
  if (owner != nullptr && !journals && owner->was_plain) {
    expected[offset] = value;
    return;
  }
  if (owner == nullptr || !owner->on_behalf) return suspect(store, owner);
  if (judged(store.offset, value) != Judgement::Take) return;
  store.allowed = true;
  journal(*owner, std::move(store), found);
}

// A program stores its data before the flag that announces them, and clears flags before it sets
// others. Flags are read first and journalled last, so the data of a flag precede it in the
// journal.
void Watch::State::compare(std::vector<PlainStore>& found) {
  for (auto& flag : flags) flag.value = word(flag.offset);
  compare_data(found);
  for (const bool is_set : {false, true})
    for (const auto& flag : flags)
      if (flag.value != expected[flag.offset] && (flag.value != 0) == is_set)
        check_word(flag.offset, flag.value, found);
}

void Watch::State::compare_data(std::vector<PlainStore>& found) {
  for (std::uint32_t begin = 0; begin < expected.size(); begin += kChunkWords) {
    const auto length = std::min<std::size_t>(kChunkWords, expected.size() - begin);
    // Looks at the words one by one only in a chunk that differs.
    std::uint32_t difference = 0;
    for (std::uint32_t i = begin; i < begin + length; ++i) difference |= word(i) ^ expected[i];
    if (difference == 0) continue;
    for (std::uint32_t i = begin; i < begin + length; ++i) {
      const std::uint32_t now = word(i);
      if (now != expected[i] && !is_flag[i]) check_word(i, now, found);
    }
  }
}

Watch::Watch(Ring& ring, Journalling journalling)
    : state_{new State{ring,
                       ring.segment(),
                       journalling == Journalling::OnBehalf,
                       std::nullopt,
                       ring.observe(),
                       {},
                       {},
                       {},
                       {},
                       {}}} {
  if (state_->journals) state_->only.emplace(ring.segment());
  std::uint32_t end = 0;
  for (const auto& partition : ring.map().partitions())
    end = std::max(end, partition.base.value() + partition.longwords);
  for (const auto& node : ring.map().description().nodes)
    state_->members.push_back({node.name, node.id, ring.follow(node.name)});
  if (state_->journals) register_as_writer();
  for (std::uint32_t i = 0; i < end; ++i) state_->expected.push_back(state_->word(i));
  state_->is_flag.resize(end);
  for (const auto& entry : ring.map().signals()) {
    if (!entry.signal->event) continue;
    state_->flags.push_back({entry.signal->offset.value(), 0});
    state_->is_flag[entry.signal->offset.value()] = true;
  }
  std::vector<PlainStore> found;
  state_->update_members(found);
}

Watch::~Watch() = default;

bool Watch::has_suspicion() const { return !state_->suspects.empty(); }

bool Watch::is_plain(const std::string& node) const {
  return std::any_of(state_->members.begin(), state_->members.end(),
                     [&](const auto& member) { return member.name == node && member.on_behalf; });
}

std::vector<PlainStore> Watch::look(const std::function<Judgement(LongwordOffset)>& judge) {
  std::vector<PlainStore> found;
  state_->judge = &judge;
  state_->read_journals();
  state_->update_members(found);
  const auto now = static_cast<std::uint64_t>(WallClock{}.now().count());
  for (auto& member : state_->members) {
    if (member.on_behalf) member.on_behalf->time(now, Duration{0});
    member.beats = state_->observer.beats_of(member.id);
  }
  state_->read_journals();
  state_->judge_suspects(found);
  state_->compare(found);
  if (state_->journals) std::atomic_ref{state_->segment.header().looks}.fetch_add(1);
  return found;
}

void Watch::take(const std::string& node, LongwordOffset offset, PartOfWord part) {
  State::Member* const member = state_->plain_member(node);
  if (member == nullptr || offset.value() >= state_->expected.size()) return;
  const std::uint32_t mask = part.bytes == 4 ? ~0U : ((1U << 8 * part.bytes) - 1) << 8 * part.at;
  std::uint32_t& expected = state_->expected[offset.value()];
  expected = (expected & ~mask) | (part.value << 8 * part.at & mask);
  member->on_behalf->word_of(member->id.value(), offset.value(), expected);
  wake_sleepers(state_->segment.wake());
}

void Watch::store(const std::string& node, LongwordOffset offset, std::uint32_t value) {
  if (state_->plain_member(node) == nullptr || offset.value() >= state_->expected.size()) return;
  std::atomic_ref{state_->segment.words()[offset.value()]}.store(value, std::memory_order_release);
  take(node, offset, {value});
}

}  // namespace rths::broker
