// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/follow.hpp>

#include <algorithm>
#include <atomic>
#include <thread>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <rths/core/error.hpp>

#include "segment.hpp"
#include "wake.hpp"

namespace rths::broker {
namespace {

constexpr Duration kLongestSpin = std::chrono::microseconds{50};
constexpr Duration kLongestSleep = std::chrono::milliseconds{10};  // a missed wake-up costs no more
constexpr int kLooksPerClock = 64;  // reading the clock costs as much as many looks

void relax() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

struct Follower::State {
  /// What stands behind the first entry of a group.
  enum class Rest { Whole, Coming, Cut };

  JournalPlace place;
  NodeId writer;
  std::uint64_t position = 0;
  std::uint64_t lost = 0;
  std::vector<std::uint32_t> words;  ///< of the group that is being read

  [[nodiscard]] Followed next(Write& write) noexcept;
  void catch_up() noexcept;
  [[nodiscard]] bool take_group(const JournalEntry& first, Write& write) noexcept;
  [[nodiscard]] Rest rest_of(const JournalEntry& first) const noexcept;
};

void Follower::State::catch_up() noexcept {
  const std::uint64_t end = end_of(place);
  lost += end - position;
  position = end;
}

bool Follower::State::take_group(const JournalEntry& first, Write& write) noexcept {
  if (first.b > words.size()) return false;
  const std::span<std::uint32_t> all{words.data(), first.b};
  if (!read_journalled_group(place, position - 1, first.a, all)) return false;
  position += group_entries(first.b) - 1;
  write = {writer, LongwordOffset{first.a}, 0, all};
  return true;
}

// A group whose writer died in the middle of it is none: its successor's entries stand where the
// rest should.
Follower::State::Rest Follower::State::rest_of(const JournalEntry& first) const noexcept {
  if (first.b > words.size()) return Rest::Cut;
  JournalEntry entry;
  for (std::uint64_t i = 0; i + 1 < group_entries(first.b); ++i) {
    const Fetched fetched = fetch_at(place, position + i, entry);
    if (fetched == Fetched::NotYet) return Rest::Coming;
    if (fetched == Fetched::Gone || entry.kind() != EntryKind::Data) return Rest::Cut;
  }
  return Rest::Whole;
}

Followed Follower::State::next(Write& write) noexcept {
  JournalEntry entry;
  for (;;) {
    switch (fetch_at(place, position, entry)) {
      case Fetched::NotYet:
        return Followed::Nothing;
      case Fetched::Gone:
        catch_up();
        return Followed::Lost;
      case Fetched::Entry:
        break;
    }
    ++position;
    if (entry.kind() == EntryKind::Word) {
      // One by one: copied as a whole, they would have to wait for each other.
      write.writer = entry.c != 0 ? NodeId{static_cast<std::uint16_t>(entry.c - 1)} : writer;
      write.offset = LongwordOffset{entry.a};
      write.value = entry.b;
      write.group = {};
      return Followed::Write;
    }
    if (entry.kind() != EntryKind::Group) continue;
    if (take_group(entry, write)) return Followed::Write;
    const Rest rest = rest_of(entry);
    if (rest == Rest::Cut) continue;
    --position;  // whole by now, or soon: its first entry is looked at again
    if (rest == Rest::Coming) return Followed::Nothing;
  }
}

Follower::Follower(std::unique_ptr<State> state) : state_{std::move(state)} {}
Follower::Follower(Follower&&) noexcept = default;
Follower& Follower::operator=(Follower&&) noexcept = default;
Follower::~Follower() = default;

Followed Follower::next(Write& write) noexcept { return state_->next(write); }
std::uint64_t Follower::lost() const { return state_->lost; }

struct Waiter::State {
  Wake* wake = nullptr;
  std::uint32_t slot = 0;
  std::vector<Follower> followers;
  std::vector<LongwordRange> words;  ///< empty: any
  Duration spin{0};
  std::optional<Node> place;  ///< on the ring, for the slot that is its bit among the sleepers

  [[nodiscard]] bool wants(const Write& write) const noexcept;
  [[nodiscard]] Status look(Write& write) noexcept;
};

bool Waiter::State::wants(const Write& write) const noexcept {
  if (words.empty()) return true;
  const std::uint32_t begin = write.offset.value();
  const auto length = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(write.group.size()));
  return std::any_of(words.begin(), words.end(), [&](const LongwordRange& range) {
    return begin < range.begin.value() + range.longwords && range.begin.value() < begin + length;
  });
}

// Ok: a write that is wanted. Stale: none, so far.
Status Waiter::State::look(Write& write) noexcept {
  for (auto& follower : followers) {
    for (;;) {
      const Followed followed = follower.next(write);
      if (followed == Followed::Lost) return Status::LimitExceeded;
      if (followed == Followed::Nothing) break;
      if (wants(write)) return Status::Ok;
    }
  }
  return Status::Stale;
}

Waiter::Waiter(std::unique_ptr<State> state) : state_{std::move(state)} {}
Waiter::Waiter(Waiter&&) noexcept = default;
Waiter& Waiter::operator=(Waiter&&) noexcept = default;
Waiter::~Waiter() = default;

Status Waiter::wait(TimePoint deadline, Write& write) noexcept {
  const WallClock clock;
  const TimePoint drowsy_from = clock.now() + state_->spin;
  for (;;) {
    for (int i = 0; i < kLooksPerClock; ++i) {
      const Status status = state_->look(write);
      if (status != Status::Stale) return status;
      relax();
    }
    const TimePoint now = clock.now();
    if (now >= deadline) return Status::Late;
    if (now < drowsy_from) continue;
    Drowsy drowsy{*state_->wake, state_->slot};
    const Status status = state_->look(write);
    if (status != Status::Stale) return status;
    drowsy.sleep(std::min(kLongestSleep, deadline - now));
  }
}

Follower Ring::follow(const std::string& node) {
  auto state = std::make_unique<Follower::State>();
  const NodeId id = map_->node(node);
  state->place = segment_->journal(node_place(*map_, id));
  state->writer = id;
  state->position = end_of(state->place);
  std::uint32_t largest = 0;
  for (const auto& partition : map_->partitions())
    if (partition.tear_group) largest = std::max(largest, partition.longwords);
  state->words.resize(largest);
  return Follower{std::move(state)};
}

Waiter Ring::wait_for(const std::vector<LongwordRange>& words) {
  auto state = std::make_unique<Waiter::State>();
  state->place.emplace(observe());
  state->slot = state->place->slot_;
  state->wake = &segment_->wake();
  state->words = words;
  // Where there is one processor, whoever spins keeps the writer from writing.
  state->spin = std::thread::hardware_concurrency() > 1 ? kLongestSpin : Duration{0};
  for (const auto& node : map_->description().nodes) {
    const auto may_write = [&](const LongwordRange& range) {
      return std::any_of(map_->partitions().begin(), map_->partitions().end(),
                         [&](const auto& partition) {
                           return partition.node == node.name &&
                                  partition.base < advance(range.begin, range.longwords) &&
                                  range.begin < advance(partition.base, partition.longwords);
                         });
    };
    if (words.empty() || std::any_of(words.begin(), words.end(), may_write))
      state->followers.push_back(follow(node.name));
  }
  if (state->followers.empty()) throw Error{"nobody may write the words to wait for"};
  return Waiter{std::move(state)};
}

}  // namespace rths::broker
