// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: identity, age, time-out, paging, counter and protocol of a SCRAMNet+ card.
#include "plus_state.hpp"

#include <scrplus.h>

#include <rths/card/bits.hpp>

using namespace rths::scramnet;

namespace {

constexpr unsigned kProtocolBits = CSR2_BRST | CSR2_MMSG | CSR2_VLEN;
constexpr struct {
  int protocol;
  unsigned bits;
} kProtocols[] = {{GOLD, 0},           {BURST, 0xC000},      {PLATINUM, 0x4000},
                  {GOLD_PLUS, 0x1000}, {BURST_PLUS, 0xD000}, {PLATINUM_PLUS, 0x5000}};

/// Switches CSR3 to receive id and age during its lifetime.
class IdMux {
 public:
  explicit IdMux(Board& card) : card_{card} { card_.change_csr(SCR_CSR8, CSR8_IDMX, 0); }
  ~IdMux() { card_.change_csr(SCR_CSR8, 0, CSR8_IDMX); }
  IdMux(const IdMux&) = delete;
  IdMux& operator=(const IdMux&) = delete;

 private:
  Board& card_;
};

// By size code: the last page of the network's 8 MB, and the bit position of the page number.
struct Paging {
  unsigned last_page, shift;
};
constexpr Paging kPaging[] = {{0, 0},  {0, 0},   {1, 15},  {3, 14},
                              {7, 13}, {15, 12}, {63, 10}, {2047, 5}};

}  // namespace

extern "C" {

int sp_msg_life(unsigned hops) {
  Board* card = card_with_registers();
  if (card == nullptr || hops == 0 || hops > MAX_AGE) return -1;
  const IdMux mux{*card};
  const unsigned csr3 = card->read_csr(SCR_CSR3);
  card->write_csr(SCR_CSR3, (csr3 & TXRX_MASK) | (MAX_AGE - hops));
  return static_cast<int>(MAX_AGE - (csr3 & TAGE_MASK));
}

int sp_rx_id(unsigned id) {
  Board* card = card_with_registers();
  if (card == nullptr || id > MAX_ID) return -1;
  const IdMux mux{*card};
  const unsigned csr3 = card->read_csr(SCR_CSR3);
  card->write_csr(SCR_CSR3, id << 8 | (csr3 & TAGE_MASK));
  return static_cast<int>(csr3 >> 8);
}

int sp_txrx_id(unsigned char id) {
  Board* card = card_with_registers();
  if (card == nullptr) return -1;
  card->change_csr(SCR_CSR8, 0, CSR8_IDMX);
  const unsigned before = card->read_csr(SCR_CSR3);
  card->write_csr(SCR_CSR3, static_cast<unsigned>(id) << 8);
  return static_cast<int>(before >> 8);
}

int sp_net_to(unsigned short timeout) {
  Board* card = card_with_registers();
  if (card == nullptr) return -1;
  card->write_csr(SCR_CSR5, timeout);
  return 0;
}

int sp_protocol(unsigned mode) {
  Board* card = card_with_registers();
  if (card == nullptr || mode < GOLD || mode > PLATINUM_PLUS) return -1;
  const unsigned before = card->registers().peek(SCR_CSR2) & kProtocolBits;
  card->change_csr(SCR_CSR2, kProtocols[mode - GOLD].bits, kProtocolBits);
  for (const auto& row : kProtocols)
    if (row.bits == before) return row.protocol;
  return 0;
}

int sp_set_cntr(int mode) {
  Board* card = card_with_registers();
  if (card == nullptr || mode < CNTR_ERRORS || mode > CNTR_FREERUN_T2) return -1;
  constexpr unsigned kSelect[] = {0,         CSR9_TRGC, CSR9_ERRC, CSR9_TRGC | CSR9_ERRC,
                                  CSR9_ERRC, CSR9_TRGC};
  const bool free_run = mode >= CNTR_FREERUN;
  card->change_csr(SCR_CSR8, free_run ? CSR8_FREE : 0U, CSR8_FREE);
  card->change_csr(SCR_CSR9, kSelect[mode - CNTR_ERRORS], CSR9_TRGC | CSR9_ERRC);
  card->write_csr(SCR_CSR13, 0);
  return 0;
}

int sp_set_sm_addr(unsigned long address) {
  Board* card = card_with_registers();
  if (card == nullptr) return -1;
  card->write_csr(SCR_CSR10, static_cast<unsigned>(address & 0xF000) | CSR10_SMAEN);
  card->write_csr(SCR_CSR11, static_cast<unsigned>(address >> 16));
  return 0;
}

// Refuses a page outside the ring's memory.
int sp_set_vp(int request, unsigned page) {
  Board* card = card_with_registers();
  if (card == nullptr) return -1;
  const unsigned csr12 = card->registers().peek(SCR_CSR12);
  if (request == VP_READ) return (csr12 & CSR12_VPEN) != 0 ? static_cast<int>(csr12 >> 5) : 0;
  if (request != VP_SET && request != VP_RESET) return -1;
  const Paging paging =
      kPaging[(card->registers().peek(SCR_CSR8) & csr8::kSizeMask) >> csr8::kSizeShift];
  if (request == VP_SET && (page > paging.last_page || !card->has_page(page))) return -1;
  const bool reset = request == VP_RESET || page == 0;
  card->write_csr(SCR_CSR12, reset ? 0 : page << paging.shift | CSR12_VPEN);
  return reset ? 0 : static_cast<int>(card->registers().peek(SCR_CSR12) >> 5);
}

// On a plus card the id byte of CSR3 can be written.
int sp_plus_find(void) {
  Board* card = card_with_registers();
  if (card == nullptr) return 0;
  const unsigned before = card->registers().peek(SCR_CSR3);
  card->registers().write(SCR_CSR3, before ^ TXRX_MASK);
  const bool changed = card->registers().peek(SCR_CSR3) != before;
  card->registers().write(SCR_CSR3, before);
  return changed ? 1 : 0;
}

int sp_bist_rd(int* bits) {
  constexpr unsigned kBits = 82;
  Board* card = card_with_registers();
  if (card == nullptr || bits == nullptr) return -1;
  unsigned stream[3] = {0, 0, 0};
  for (unsigned bit = 0; bit < kBits; ++bit)
    if ((card->read_csr(SCR_CSR9) & CSR9_BIST) != 0) stream[bit / 32] |= 1U << bit % 32;
  for (unsigned i = 0; i < 3; ++i) bits[i] = static_cast<int>(stream[i]);
  return 0;
}
}
