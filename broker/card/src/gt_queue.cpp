// SPDX-License-Identifier: Apache-2.0
#include <ctime>

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <rths/card/gt_queue.hpp>
#include <rths/card/gt_registers.hpp>

namespace rths::scramnet {
namespace {

constexpr int kAttempts = 400;  // the first half yields, the second sleeps
constexpr timespec kNap{0, 50'000};

long futex(Word& word, int operation, std::uint32_t value, const timespec* timeout) {
  return syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation, value, timeout,
                 nullptr, 0);
}

// A process reserves an entry by storing its claim in it; the claim of a dead process is ignored.
bool reserve(GtEntry& entry, broker::Claim self, broker::Members members) {
  broker::Claim writer = entry.writer.load();
  if (members.has(writer)) return false;
  return entry.writer.compare_exchange_strong(writer, self);
}

void advance(GtCard& card, std::uint64_t position) {
  card.tail.compare_exchange_strong(position, position + 1);
}

// The tail moves only past complete entries. A writer that finds a complete entry at the tail,
// whose own writer died or was interrupted, moves the tail for it.
bool try_push(GtCard& card, const QueuedInterrupt& interrupt, broker::Claim self,
              broker::Members members) {
  const std::uint64_t position = card.tail.load();
  GtEntry& entry = card.queue[position % kGtQueueEntries];
  if (!reserve(entry, self, members)) return false;
  const bool is_free = card.tail.load() == position && entry.stamp.load() != position + 1;
  if (is_free) {
    entry.stamp.store(0);
    entry.type.store(interrupt.type);
    entry.source.store(interrupt.source);
    entry.id.store(interrupt.id);
    entry.value.store(interrupt.value);
    entry.stamp.store(position + 1);
  }
  if (entry.stamp.load() == position + 1) advance(card, position);
  entry.writer.store(0);
  return is_free;
}

}  // namespace

bool push(GtCard& card, const QueuedInterrupt& interrupt, broker::Claim self,
          broker::Members members) {
  for (int attempt = 0; !try_push(card, interrupt, self, members); ++attempt) {
    if (attempt == kAttempts) return false;
    if (attempt < kAttempts / 2)
      sched_yield();
    else
      clock_nanosleep(CLOCK_MONOTONIC, 0, &kNap, nullptr);
  }
  card.arrivals.fetch_add(1);
  if (card.sleepers.load() != 0) futex(card.arrivals, FUTEX_WAKE, 0x7FFF'FFFF, nullptr);
  return true;
}

bool read(const GtCard& card, std::uint64_t position, QueuedInterrupt& interrupt) {
  const GtEntry& entry = card.queue[position % kGtQueueEntries];
  if (entry.stamp.load() != position + 1) return false;
  interrupt = {entry.type.load(), entry.source.load(), entry.id.load(), entry.value.load()};
  return entry.stamp.load() == position + 1;
}

void sleep_on(GtCard& card, std::uint32_t arrivals, std::int64_t nanoseconds) {
  const timespec timeout{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  card.sleepers.fetch_add(1);
  futex(card.arrivals, FUTEX_WAIT, arrivals, &timeout);
  card.sleepers.fetch_sub(1);
}

}  // namespace rths::scramnet
