// SPDX-License-Identifier: Apache-2.0
#include "trapped_window.hpp"

#include <sys/mman.h>

#include <cstring>
#include <ctime>

#include <rths/card/bits.hpp>
#include <rths/card/registers.hpp>

#include "carried.hpp"
#include "ring_copy.hpp"

namespace rths::scramnet {
namespace {

constexpr int kPolls = 20'000;  // for space in the queue, 1 s
constexpr long kPollNs = 50'000;

/// A part of a store that is inside a longword: 1, 2 or 4 bytes.
struct Piece {
  std::uint64_t at;
  std::uint32_t width;
};

/// Calls `act` with the pieces of a store, in ascending order.
template <class Act>
void for_each_piece(std::uint64_t at, std::uint64_t length, Act act) {
  for (const std::uint64_t end = at + length; at < end;) {
    std::uint32_t width = 4;
    while (at % width != 0 || at + width > end) width /= 2;
    act(Piece{at, width});
    at += width;
  }
}

void set_memory(std::byte* to, Piece piece, std::uint32_t value) {
  if (piece.width == 4) return write_ring_unit(to + piece.at, value);
  if (piece.width == 2) return write_ring_unit(to + piece.at, static_cast<std::uint16_t>(value));
  write_ring_unit(to + piece.at, static_cast<std::uint8_t>(value));
}

// Replaces a value of the ring by one that depends on it, atomically if it is aligned.
template <class Unit, class Change>
std::uint64_t replace(std::byte* at, bool in_memory, Change change) {
  if (reinterpret_cast<std::uintptr_t>(at) % sizeof(Unit) != 0) {
    Unit before;
    std::memcpy(&before, at, sizeof before);
    const Unit after = static_cast<Unit>(change(before));
    if (in_memory) std::memcpy(at, &after, sizeof after);
    return before;
  }
  const std::atomic_ref unit{*reinterpret_cast<Unit*>(at)};
  Unit before = unit.load();
  Unit after = static_cast<Unit>(change(before));
  while (in_memory && !unit.compare_exchange_weak(before, after))
    after = static_cast<Unit>(change(before));
  return before;
}

template <class Change>
std::uint64_t replace_by_width(std::uint32_t width, std::byte* at, bool in_memory, Change change) {
  if (width == 1) return replace<std::uint8_t>(at, in_memory, change);
  if (width == 2) return replace<std::uint16_t>(at, in_memory, change);
  if (width == 4) return replace<std::uint32_t>(at, in_memory, change);
  return replace<std::uint64_t>(at, in_memory, change);
}

}  // namespace

TrappedWindow trapped_window;

std::optional<std::uint64_t> TrappedWindow::find(std::uintptr_t address,
                                                 std::uint64_t length) const {
  const auto begin = reinterpret_cast<std::uintptr_t>(window.load());
  if (begin == 0 || address < begin) return std::nullopt;
  const std::uint64_t at = address - begin, size = bytes.load();
  return at < size && length <= size - at ? std::optional{at} : std::nullopt;
}

const void* TrappedWindow::readable(std::uintptr_t address, std::uint64_t length) {
  const auto at = find(address, length);
  if (!at) return reinterpret_cast<const void*>(address);  // NOLINT: of the trapped program
  if (is_hidden(*at)) reveal(*at);
  return memory.load() + *at;
}

bool TrappedWindow::withholds() const {
  return Registers{*card.load()}.all_set(2, csr2::kNoHostWrite);
}

bool TrappedWindow::writes_last() const {
  return Registers{*card.load()}.all_set(2, csr2::kWriteMeLast);
}

void TrappedWindow::protect(std::uint64_t at, int protection) const {
  mprotect(window.load() + at / kTrapPage * kTrapPage, kTrapPage, protection);
}

void TrappedWindow::open_page(std::uint64_t at) {
  hidden[at / kTrapPage].store(false);
  protect(at, PROT_READ | PROT_WRITE);
}

void TrappedWindow::close_page(std::uint64_t at) {
  if (!closed[at / kTrapPage].load()) return;
  hidden[at / kTrapPage].store(false);
  protect(at, PROT_READ);
}

// In write-me-last, a program must not load what its stores have not changed yet.
void TrappedWindow::hide(std::uint64_t at, std::uint64_t length) {
  for (std::uint64_t page = at / kTrapPage; page <= (at + length - 1) / kTrapPage; ++page)
    if (closed[page].load() && !hidden[page].exchange(true)) protect(page * kTrapPage, PROT_NONE);
}

void TrappedWindow::reveal(std::uint64_t at) {
  wait_for_own_stores(card.load()->carried);
  hidden[at / kTrapPage].store(false);
  protect(at, closed[at / kTrapPage].load() ? PROT_READ : PROT_READ | PROT_WRITE);
}

// A card holds off its host while its FIFO is full. Once it took too long, no store waits until
// there is space again; stores meanwhile are left to the scans.
std::optional<std::uint32_t> TrappedWindow::reserve_in_time(std::uint32_t count) {
  TrapQueue& queue = card.load()->carried.traps;
  for (int i = 0; i < kPolls; ++i) {
    if (const auto first = reserve(queue, count)) {
      gave_up_.store(false);
      return first;
    }
    if (gave_up_.load()) return std::nullopt;
    const timespec pause{0, kPollNs};
    clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
  }
  gave_up_.store(true);
  return std::nullopt;
}

std::optional<std::uint32_t> TrappedWindow::announce_words(std::uint64_t at, std::uint32_t count) {
  const auto first = reserve_in_time(count);
  for (std::uint32_t i = 0; first && i < count; ++i)
    announce(card.load()->carried.traps, *first + i,
             static_cast<std::uint32_t>(offset.load() + at + std::uint64_t{4} * i));
  return first;
}

void TrappedWindow::store(std::uint64_t at, std::span<const std::uint8_t> value) {
  TrapQueue& queue = card.load()->carried.traps;
  std::uint32_t count = 0;
  for_each_piece(at, value.size(), [&](Piece) { ++count; });
  const auto first = reserve_in_time(count);
  const bool in_memory = !withholds() || !first;
  const auto word_of = [&](Piece piece) {
    std::uint32_t word = 0;
    std::memcpy(&word, value.data() + (piece.at - at), piece.width);
    return word;
  };
  std::uint32_t n = first.value_or(0);
  for_each_piece(at, value.size(), [&](Piece piece) {
    if (first) announce(queue, n++, static_cast<std::uint32_t>(offset.load() + piece.at));
  });
  n = first.value_or(0);
  for_each_piece(at, value.size(), [&](Piece piece) {
    if (in_memory) set_memory(memory.load(), piece, word_of(piece));
    if (first) publish(queue, n++, piece.width | (in_memory ? kTrapInMemory : 0U), word_of(piece));
  });
  if (!in_memory && writes_last()) hide(at, value.size());
}

std::uint64_t TrappedWindow::modify(std::uint64_t at, const StoreInstruction& instruction,
                                    const CpuState& cpu, ReadModifyWrite& result) {
  if (is_hidden(at)) reveal(at);
  TrapQueue& queue = card.load()->carried.traps;
  std::uint32_t count = 0;
  for_each_piece(at, instruction.width, [&](Piece) { ++count; });
  const auto first = reserve_in_time(count);
  const bool in_memory = !withholds() || !first;
  std::uint32_t n = first.value_or(0);
  for_each_piece(at, instruction.width, [&](Piece piece) {
    if (first) announce(queue, n++, static_cast<std::uint32_t>(offset.load() + piece.at));
  });
  const auto change = [&](std::uint64_t before) {
    result = scramnet::modify(instruction, before, cpu);
    return result.stores ? result.stored : before;
  };
  const std::uint64_t before =
      replace_by_width(instruction.width, memory.load() + at, in_memory, change);
  n = first.value_or(0);
  for_each_piece(at, instruction.width, [&](Piece piece) {
    std::uint32_t word = 0;
    std::memcpy(&word, reinterpret_cast<const std::byte*>(&result.stored) + (piece.at - at),
                piece.width);
    const std::uint32_t form = piece.width | (in_memory ? kTrapInMemory : 0U);
    if (first) publish(queue, n++, result.stores ? form : 0, word);
  });
  if (!in_memory && writes_last()) hide(at, instruction.width);
  return before;
}

}  // namespace rths::scramnet
