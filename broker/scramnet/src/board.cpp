// SPDX-License-Identifier: Apache-2.0
#include "board.hpp"

#include <algorithm>

#include <rths/card/bits.hpp>
#include <rths/card/interrupts.hpp>
#include <rths/core/error.hpp>

#include "carried.hpp"

namespace rths::scramnet {
namespace {

std::uint64_t checked_window(const CardSession& session, const Settings& settings) {
  if (session.own().acr == nullptr)
    throw Error{"ring '" + settings.ring + "' is larger than 8 MB, the largest SCRAMNet+ card"};
  const std::uint64_t all = session.memory_bytes();
  return settings.card_bytes == 0 ? all : std::min(all, settings.card_bytes);
}

std::byte* whole_memory(const CardSession& session) {
  std::byte* memory = session.map_memory(nullptr, 0, session.memory_bytes());
  if (memory == nullptr) throw Error{"the ring's memory cannot be mapped"};
  return memory;
}

}  // namespace

Board::Board(const Settings& settings)
    : session_{settings},
      bypass_switch_{settings.bypass_switch},
      window_bytes_{checked_window(session_, settings)},
      size_code_{size_code_of(window_bytes_)},
      memory_{whole_memory(session_)},
      interrupts_seen_{session_.card().plus.host_interrupts.load()},
      scanner_{session_, reinterpret_cast<Word*>(memory_),
               static_cast<std::uint32_t>(window_bytes_ / 4)},
      traps_{session_, settings.traps} {
  registers().set_size_code(size_code_);
  update_window();
}

std::uint32_t Board::read_csr(int index) {
  if (index == 1 || index == 5) scanner_.scan();
  update_traps();
  const Carried& carried = session_.card().carried;
  if (carried.active.load() != 0)
    return registers().read(index, {.nodes = carried.ring_nodes.load(),
                                    .bypass_switch = bypass_switch_,
                                    .live_status = index == 1 ? carried.live_status.load() : 0});
  std::uint32_t nodes = 0;
  if (index == 3)
    session_.for_each_card([&](const CardSession::CardView& card) {
      nodes += Registers{*card.card}.all_set(0, csr0::kInsert) ? 1 : 0;
    });
  return registers().read(index, {.nodes = nodes, .bypass_switch = bypass_switch_});
}

// On a replicated ring, another process gives effect to stores and registers at its next scan. A
// register is written behind all earlier stores, and has its effect when the call returns.
void Board::wait_for_scan() const {
  const Carried& carried = session_.card().carried;
  if (carried.active.load() != 0) scramnet::wait_for_scan(carried);
}

void Board::wait_for_own_stores() const {
  const Carried& carried = session_.card().carried;
  if (carried.active.load() != 0 && Registers{session_.card()}.all_set(2, csr2::kWriteMeLast))
    scramnet::wait_for_own_stores(carried);
}

void Board::write_csr(int index, std::uint32_t value) {
  wait_for_scan();
  const std::uint32_t before = registers().peek(0);
  registers().write(index, value);
  if (index == 0 && ((before | registers().peek(0)) & csr0::kResetTransmitFifo) != 0)
    session_.card().carried.transmit_resets.fetch_add(1);
  if (index == 13) session_.card().carried.counter_writes.fetch_add(1);
  if (index == 0 || index == 8) control_changed(before);
  if (index == 1) scanner_.scan();
  if (index == 3) warn_of_shared_id();
  if (index == 12) update_window();
  update_traps();
  wait_for_scan();
}

void Board::change_csr(int index, std::uint32_t set, std::uint32_t clear) {
  write_csr(index, (registers().peek(index) & ~clear) | set);
}

void Board::control_changed(std::uint32_t before) {
  const std::uint32_t now = registers().peek(0);
  const std::uint32_t changed = before ^ now;
  constexpr std::uint32_t kRelevant =
      csr0::kReceive | csr0::kMemoryInterrupts | csr0::kAllReceiveInterrupts;
  const bool window_closed = (before & ~now & csr0::kAcrWindow) != 0;
  if ((changed & csr0::kAcrWindow) != 0) update_window();
  if (window_closed) {
    for (std::uint64_t i = 0; i < window_bytes_ / 4; ++i)
      if (acr()[i].load(std::memory_order_relaxed) > acr::kBits) acr()[i].fetch_and(acr::kBits);
    plus().acr_changes.fetch_add(1);
  }
  if (scanner_.is_enabled() && ((changed & kRelevant) != 0 || window_closed)) scanner_.reset();
  update_thread();
  deliver_if_due(session_.card(), session_.members());
}

void Board::warn_of_shared_id() {
  const std::uint32_t id = registers().peek(3) >> 8;
  session_.for_each_card([&](const CardSession::CardView& card) {
    if (card.card != &session_.card() && session_.is_held(*card.card) &&
        Registers{*card.card}.peek(3) >> 8 == id)
      warn_once("id",
                "another node of the ring has the same id; real cards would discard each "
                "other's messages, here they arrive");
  });
}

bool Board::has_page(std::uint32_t page) const {
  return (page + 1) * window_bytes_ <= session_.memory_bytes();
}

bool Board::others_are_active() const {
  bool found = false;
  session_.for_each_card([&](const CardSession::CardView& card) {
    const std::uint32_t csr0 = Registers{*card.card}.peek(0);
    found |= card.card != &session_.card() && session_.is_held(*card.card) &&
             (csr0 & (csr0::kReceive | csr0::kTransmit)) != 0;
  });
  return found;
}

bool Board::map_window() {
  if (window_ != nullptr) return true;
  window_ = session_.map_memory(nullptr, page_offset_, window_bytes_);
  update_window();
  return window_ != nullptr;
}

void Board::unmap_window() {
  if (window_ != nullptr) CardTable::unmap(window_, window_bytes_);
  window_ = nullptr;
  traps_.set_window({});
}

// Maps other pages at the same address; a concurrent load or store uses the old or the new page.
void Board::update_window() {
  const std::uint32_t csr12 = registers().peek(12);
  const std::uint64_t wanted = network_offset(csr12);
  const std::uint64_t offset = wanted + window_bytes_ <= session_.memory_bytes() ? wanted : 0;
  if (offset != page_offset_) {
    page_offset_ = offset;
    scanner_.set_window(reinterpret_cast<Word*>(memory()),
                        static_cast<std::uint32_t>(window_bytes_ / 4),
                        static_cast<std::uint32_t>(offset / 4));
  }
  if (window_ == nullptr) return;
  const bool shows_acr = registers().all_set(0, csr0::kAcrWindow);
  if (shows_acr)
    static_cast<void>(session_.map_acr(window_, window_bytes_));
  else
    static_cast<void>(session_.map_memory(window_, page_offset_, window_bytes_));
  traps_.set_window({window_, memory(), page_offset_, window_bytes_, shows_acr});
  traps_.follow();
}

// A page opens when the stores that its traps took have been carried, and their scan is over.
void Board::update_traps() {
  if (!traps_.is_due()) return;
  if (traps_.opens_a_page()) {
    wait_for_scan();
    wait_for_scan();
  }
  traps_.follow();
}

void Board::write_acr(std::uint32_t longword, std::uint32_t value) {
  const std::uint32_t before = acr()[longword].exchange(value & acr::kBits);
  plus().acr_changes.fetch_add(1);
  if ((before & ~value) != 0)
    update_traps();
  else
    traps_.follow_word(std::uint64_t{longword} * 4);
  if ((value & ~before & acr::kReceiveInterrupt) != 0 && scanner_.is_enabled())
    scanner_.reset(longword);
}

void Board::clear_acr() {
  for (std::uint64_t i = 0; i < window_bytes_ / 4; ++i)
    if (acr()[i].load(std::memory_order_relaxed) != 0) acr()[i].store(0);
  plus().acr_changes.fetch_add(1);
  update_traps();
}

void Board::fill_acr(std::uint32_t value) {
  for (std::uint64_t i = 0; i < window_bytes_ / 4; ++i) acr()[i].store(value & acr::kBits);
  plus().acr_changes.fetch_add(1);
  if (scanner_.is_enabled()) scanner_.reset();
  update_traps();
}

void Board::store(std::uint64_t offset, const std::byte* from, std::uint64_t bytes) {
  while (bytes != 0) {
    const std::uint64_t length = std::min(bytes, kTrapPage - offset % kTrapPage);
    if (traps_.is_closed(offset))
      traps_.store(offset, from, length);
    else
      write_ring(memory() + offset, from, length);
    offset += length, from += length, bytes -= length;
  }
}

std::uint32_t Board::take_interrupts() {
  const std::uint32_t delivered = plus().host_interrupts.load();
  return delivered - interrupts_seen_.exchange(delivered);
}

void Board::update_thread() {
  scanner_.run_thread(scanner_.is_enabled() && registers().all_set(0, csr0::kHostInterrupts) &&
                      is_registered(plus(), session_.self()));
}

// A forked child has neither the thread of its parent nor its registration.
void Board::leave() {
  if (!session_.is_of_this_process()) return;
  scanner_.run_thread(false);
  remove_registration(plus(), session_.self());
  session_.leave();
}

}  // namespace rths::scramnet
