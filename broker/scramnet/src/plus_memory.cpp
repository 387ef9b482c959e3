// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: the whole memory, the whole ACR, and copies.
#include <cstdio>
#include <cstring>

#include "plus_state.hpp"
#include "ring_copy.hpp"

#include <scrplus.h>

using namespace rths::scramnet;

namespace {

void fill_memory(Board& card, std::uint32_t value) {
  for (std::uint64_t at = 0; at < card.window_bytes(); at += 4) card.store_unit(at, value);
}

bool has_range(const Board* card, unsigned long offset, unsigned long length) {
  return card != nullptr && offset <= card->window_bytes() &&
         length <= card->window_bytes() - offset;
}

template <class Value>
Value read_unit(unsigned long offset, void* to) {
  Value value = 0;
  const Board* const card = card_with_memory();
  if (has_range(card, offset * sizeof value, sizeof value)) {
    card->wait_for_own_stores();
    value = read_ring_unit<Value>(card->memory() + offset * sizeof value);
  }
  if (to != nullptr) std::memcpy(to, &value, sizeof value);
  return value;
}

template <class Value>
int write_unit(unsigned long offset, Value value) {
  Board* const card = card_with_memory();
  if (!has_range(card, offset * sizeof value, sizeof value)) return 0;
  card->store_unit(offset * sizeof value, value);
  return 1;
}

}  // namespace

extern "C" {

// On hardware, a card that does not transmit clears only its own memory. Here all cards share the
// memory, so such a card clears it only while no other card is active.
void scr_mclr_mm(int which) {
  BoardError error{};
  Board* card = take_board(error);
  if (card == nullptr) return;
  if (which == ACR) return card->clear_acr();
  if (which != MEM) return;
  if (!card->registers().all_set(SCR_CSR0, CSR0_TXEN) && card->others_are_active()) {
    warn_once("clear",
              "the memory is not cleared: this node does not transmit and other nodes are active");
    return;
  }
  fill_memory(*card, 0);
}

void scr_smem_mm(int which, unsigned long value) {
  Board* card = card_with_memory();
  if (which != MEM && which != ACR) {
    std::fprintf(stderr, "scramnet: scr_smem_mm: %d is neither MEM nor ACR\n", which);
    return;
  }
  if (card == nullptr) return;
  if (which == MEM) return fill_memory(*card, static_cast<std::uint32_t>(value));
  card->fill_acr(static_cast<std::uint32_t>(value));
}

int scr_dma_read(void* user, unsigned long offset, unsigned long length) {
  const Board* const card = card_with_memory();
  if (!has_range(card, offset, length) || user == nullptr) return -1;
  card->wait_for_own_stores();
  read_ring(static_cast<std::byte*>(user), card->memory() + offset, length);
  return 0;
}

int scr_dma_write(void* user, unsigned long offset, unsigned long length) {
  Board* const card = card_with_memory();
  if (!has_range(card, offset, length) || user == nullptr) return -1;
  card->store(offset, static_cast<const std::byte*>(user), length);
  return 0;
}

unsigned int ReadSCRLong(unsigned long offset, void* value) {
  return read_unit<unsigned int>(offset, value);
}
unsigned short ReadSCRWord(unsigned long offset, void* value) {
  return read_unit<unsigned short>(offset, value);
}
unsigned char ReadSCRByte(unsigned long offset, void* value) {
  return read_unit<unsigned char>(offset, value);
}
int WriteSCRLong(unsigned long offset, unsigned int value) { return write_unit(offset, value); }
int WriteSCRWord(unsigned long offset, unsigned short value) { return write_unit(offset, value); }
int WriteSCRByte(unsigned long offset, unsigned char value) { return write_unit(offset, value); }
}
