// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/follow.hpp>

#include <linux/futex.h>
#include <linux/membarrier.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <cstdint>
#include <ctime>
#include <limits>
#include <thread>

#include <rths/broker/detail/wake.hpp>
#include <rths/core/clock.hpp>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <rths/core/error.hpp>

#include "segment.hpp"

namespace rths::broker {
namespace {

long membarrier(int command) noexcept {
  return syscall(SYS_membarrier, command, 0U, 0);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

/// @param bits  a sleeper with any of the bits is woken
long futex(std::uint32_t& word, int operation, std::uint32_t value, const timespec* timeout,
           std::uint32_t bits) noexcept {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  return syscall(SYS_futex, &word, operation, value, timeout, nullptr, bits);
}

/// @returns the number of processes woken
long wake_up(Wake& wake, std::uint32_t bits) noexcept {
  std::atomic_ref{wake.calls}.fetch_add(1);
  return futex(wake.calls, FUTEX_WAKE_BITSET, INT_MAX, nullptr, bits);
}

/// Marks a slot as sleeping during its lifetime. After construction, poll once more: every write
/// that this poll does not find will wake the sleeper.
class Sleeper {
 public:
  Sleeper(Wake& wake, std::uint32_t slot) noexcept
      : wake_{wake}, bit_{1U << slot}, calls_{std::atomic_ref{wake.calls}.load()} {
    std::atomic_ref{wake_.sleepers}.fetch_or(bit_);
    // Makes every processor execute a fence: earlier writes are visible, later writers see the bit.
    // Without kernel support a wake-up may be missed.
    static_cast<void>(membarrier(MEMBARRIER_CMD_GLOBAL_EXPEDITED));
  }

  ~Sleeper() { std::atomic_ref{wake_.sleepers}.fetch_and(~bit_); }
  Sleeper(const Sleeper&) = delete;
  Sleeper& operator=(const Sleeper&) = delete;

  /// Sleeps until the next write, at most for `most`; may wake without a reason.
  void sleep(Duration most) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    const auto until = (WallClock{}.now() + most).count();
    const timespec timeout{until / kSecond, until % kSecond};
    futex(wake_.calls, FUTEX_WAIT_BITSET, calls_, &timeout, bit_);
  }

 private:
  Wake& wake_;
  std::uint32_t bit_;
  std::uint32_t calls_;
};

}  // namespace

void register_as_writer() {
  static_cast<void>(membarrier(MEMBARRIER_CMD_REGISTER_GLOBAL_EXPEDITED));
}

// If no process woke, the bits are those of processes that died while they slept. A bit may also
// belong to a process that is just about to sleep again: the second wake-up keeps it awake.
void wake_all(Wake& wake, std::uint32_t spared) noexcept {
  const std::uint32_t seen =
      std::atomic_ref{wake.sleepers}.load(std::memory_order_relaxed) & ~spared;
  if (seen == 0 || wake_up(wake, ~spared) != 0) return;
  std::atomic_ref{wake.sleepers}.fetch_and(~seen);
  wake_up(wake, ~spared);
}

namespace {

constexpr Duration kLongestSleep = std::chrono::milliseconds{10};  // bounds a missed wake-up
constexpr int kMostWritesPerPoll = 1 << 16;  // of one node, before the deadline is checked
constexpr int kPollsPerClock = 64;           // reading the clock takes as long as many polls

void relax() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

struct Follower::State {
  /// State of a group behind its first entry.
  enum class GroupState { Complete, Pending, Cut };

  JournalView journal;
  NodeId writer;
  std::uint64_t position = 0;
  std::uint64_t lost = 0;
  std::uint64_t dated_end = 0;       ///< the entries before this position have the date
  TimePoint date{0};                 ///< of the heartbeat behind them
  bool ignored = false;              ///< by its waiter
  std::uint32_t memory_end = 0;      ///< of the ring's memory: entries beyond it are skipped
  std::vector<std::uint32_t> words;  ///< of the group that is being read

  /// The next write of an entry before this position.
  [[nodiscard]] Followed next_before(std::uint64_t end, Write& write) noexcept {
    JournalEntry entry;
    // Ends also if another program writes entries without a write faster than they are read.
    for (std::uint64_t i = 0; i >> journal.bits < 2 && position < end; ++i) {
      switch (fetch_at(journal, position, entry)) {
        case Fetched::NotYet:
          return Followed::Nothing;
        case Fetched::Gone:
          give_up();
          return Followed::Lost;
        case Fetched::Entry:
          break;
      }
      ++position;
      if (entry.kind() == EntryKind::Word && entry.a < memory_end) {
        read_word(entry, write);
        return Followed::Write;
      }
      if (entry.kind() != EntryKind::Group) continue;
      if (read_group(entry, write)) return Followed::Write;
      const GroupState state = state_of(entry);
      if (state == GroupState::Cut) continue;
      --position;  // complete by now, or soon: reads its first entry again
      if (state == GroupState::Pending) return Followed::Nothing;
    }
    return Followed::Nothing;
  }

  // Searches the heartbeat behind the next write. False if there is none yet.
  [[nodiscard]] bool find_date() noexcept {
    if (position < dated_end) return true;
    JournalEntry entry;
    for (std::uint64_t at = position; (at - position) >> journal.bits == 0; ++at) {
      if (fetch_at(journal, at, entry) != Fetched::Entry) return false;
      if (entry.kind() != EntryKind::Time) continue;
      dated_end = at + 1;
      date = TimePoint{static_cast<std::int64_t>(halves(entry.a, entry.b))} - late_of(entry);
      return true;
    }
    return false;
  }

  // The writer overwrote entries that were not read.
  void give_up() noexcept {
    const std::uint64_t end = end_of(journal);
    lost += end - position;
    position = end;
  }

  void read_word(const JournalEntry& entry, Write& write) const noexcept {
    // Member by member: copying the whole struct would stall on store forwarding.
    write.writer = entry.c != 0 ? NodeId{static_cast<std::uint16_t>(entry.c - 1)} : writer;
    write.offset = LongwordOffset{entry.a};
    write.value = entry.b;
    write.group = {};
  }

  [[nodiscard]] bool read_group(const JournalEntry& first, Write& write) noexcept {
    if (!is_inside(first)) return false;
    const std::span<std::uint32_t> all{words.data(), first.b};
    if (!read_journalled_group(journal, position - 1, first.a, all)) return false;
    position += group_entries(first.b) - 1;
    write = {writer, LongwordOffset{first.a}, 0, all};
    return true;
  }

  // A group is cut off if its writer died in the middle: then the successor's entries follow.
  [[nodiscard]] GroupState state_of(const JournalEntry& first) const noexcept {
    if (!is_inside(first)) return GroupState::Cut;
    JournalEntry entry;
    for (std::uint64_t i = 0; i + 1 < group_entries(first.b); ++i) {
      const Fetched fetched = fetch_at(journal, position + i, entry);
      if (fetched == Fetched::NotYet) return GroupState::Pending;
      if (fetched == Fetched::Gone || entry.kind() != EntryKind::Data) return GroupState::Cut;
    }
    return GroupState::Complete;
  }

  [[nodiscard]] bool is_inside(const JournalEntry& group) const noexcept {
    return group.b > 0 && group.b <= words.size() && group.a < memory_end &&
           group.b <= memory_end - group.a;
  }
};

Follower::Follower(std::unique_ptr<State> state) : state_{std::move(state)} {}
Follower::Follower(Follower&&) noexcept = default;
Follower& Follower::operator=(Follower&&) noexcept = default;
Follower::~Follower() = default;

Followed Follower::next(Write& write) noexcept {
  return state_->next_before(std::numeric_limits<std::uint64_t>::max(), write);
}

Followed Follower::next_until(TimePoint time, Write& write) noexcept {
  State& state = *state_;
  JournalEntry entry;
  while (state.find_date() && state.date < time) {
    const Followed followed = state.next_before(state.dated_end, write);
    if (followed != Followed::Nothing) return followed;
    state.position = std::max(state.position, state.dated_end);
  }
  // What was overwritten has no date any more.
  if (fetch_at(state.journal, state.position, entry) != Fetched::Gone) return Followed::Nothing;
  state.give_up();
  return Followed::Lost;
}

void Follower::skip_to_end() noexcept { state_->position = end_of(state_->journal); }
std::uint64_t Follower::lost() const { return state_->lost; }

struct Waiter::State {
  Wake* wake = nullptr;
  std::uint32_t slot = 0;
  std::vector<Follower> followers;
  std::vector<LongwordRange> words;  ///< empty: any
  Duration spin{0};
  std::optional<Node> observer;  ///< on the ring, for the slot that is its bit among the sleepers

  [[nodiscard]] bool matches(const Write& write) const noexcept {
    if (words.empty()) return true;
    const std::uint32_t begin = write.offset.value();
    const auto length = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(write.group.size()));
    return std::any_of(words.begin(), words.end(), [&](const LongwordRange& range) {
      return begin < range.begin.value() + range.longwords && range.begin.value() < begin + length;
    });
  }

  // Ok: a matching write. Stale: none yet.
  [[nodiscard]] Status poll(Write& write) noexcept {
    for (auto& follower : followers) {
      if (follower.state_->ignored) continue;
      for (int i = 0; i < kMostWritesPerPoll; ++i) {
        const Followed followed = follower.next(write);
        if (followed == Followed::Lost) return Status::LimitExceeded;
        if (followed == Followed::Nothing) break;
        if (matches(write)) return Status::Ok;
      }
    }
    return Status::Stale;
  }
};

Waiter::Waiter(std::unique_ptr<State> state) : state_{std::move(state)} {}
Waiter::Waiter(Waiter&&) noexcept = default;
Waiter& Waiter::operator=(Waiter&&) noexcept = default;
Waiter::~Waiter() = default;

Status Waiter::wait(TimePoint deadline, Write& write) noexcept {
  const Status first = state_->poll(write);
  if (first != Status::Stale) return first;
  if (deadline == TimePoint{0}) return Status::Late;
  const WallClock clock;
  const TimePoint sleep_from = clock.now() + state_->spin;
  for (;;) {
    for (int i = 0; i < kPollsPerClock; ++i) {
      const Status status = state_->poll(write);
      if (status != Status::Stale) return status;
      relax();
    }
    const TimePoint now = clock.now();
    if (now >= deadline) return Status::Late;
    if (now < sleep_from) continue;
    Sleeper sleeper{*state_->wake, state_->slot};
    const Status status = state_->poll(write);
    if (status != Status::Stale) return status;
    sleeper.sleep(std::min(kLongestSleep, deadline - now));
  }
}

void Node::spare(const Waiter& waiter) {
  if (writer_) writer_->spared |= 1U << waiter.state_->slot;
}

void Waiter::ignore(NodeId writer, bool ignored) noexcept {
  for (auto& follower : state_->followers) {
    auto& state = *follower.state_;
    if (state.writer != writer || state.ignored == ignored) continue;
    state.ignored = ignored;
    if (!ignored) state.position = end_of(state.journal);
  }
}

Follower Ring::follow(const std::string& node) {
  auto state = std::make_unique<Follower::State>();
  const NodeId id = map_->node(node);
  state->journal = segment_->journal(node_index(*map_, id));
  state->writer = id;
  state->memory_end = map_->description().size_longwords;
  state->position = end_of(state->journal);
  std::uint32_t largest = 0;
  for (const auto& partition : map_->partitions())
    if (partition.tear_group) largest = std::max(largest, partition.longwords);
  state->words.resize(largest);
  return Follower{std::move(state)};
}

std::vector<std::string> Ring::writers_of(const std::vector<LongwordRange>& words) const {
  std::vector<std::string> writers;
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
      writers.push_back(node.name);
  }
  return writers;
}

Waiter Ring::wait_for(const std::vector<LongwordRange>& words, Duration longest_spin) {
  check_writable();
  auto state = std::make_unique<Waiter::State>();
  state->observer.emplace(observe());
  state->slot = state->observer->slot_;
  state->wake = &segment_->wake();
  state->words = words;
  // On a single processor, spinning would block the writer.
  state->spin = std::thread::hardware_concurrency() > 1 ? longest_spin : Duration{0};
  for (const auto& node : writers_of(words)) state->followers.push_back(follow(node));
  if (state->followers.empty()) throw Error{"no node may write the words to wait for"};
  return Waiter{std::move(state)};
}

}  // namespace rths::broker
