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

Word* words_of(Board& card) { return reinterpret_cast<Word*>(card.memory()); }

void fill_memory(Board& card, std::uint32_t value) {
  for (std::uint64_t i = 0; i < card.window_bytes() / 4; ++i) words_of(card)[i].store(value);
}

std::byte* range(Board* card, unsigned long offset, unsigned long length) {
  if (card == nullptr || offset > card->window_bytes() || length > card->window_bytes() - offset)
    return nullptr;
  return card->memory() + offset;
}

template <class Value>
Value read_unit(unsigned long offset, void* to) {
  Value value = 0;
  if (const std::byte* from = range(card_with_memory(), offset * sizeof value, sizeof value))
    value = read_ring_unit<Value>(from);
  if (to != nullptr) std::memcpy(to, &value, sizeof value);
  return value;
}

template <class Value>
int write_unit(unsigned long offset, Value value) {
  std::byte* to = range(card_with_memory(), offset * sizeof value, sizeof value);
  if (to == nullptr) return 0;
  write_ring_unit(to, value);
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
  for (std::uint64_t i = 0; i < card->window_bytes() / 4; ++i)
    card->acr()[i].store(static_cast<std::uint32_t>(value) & ACR_MASK);
  card->plus().acr_changes.fetch_add(1);
  if (card->scanner().is_enabled()) card->scanner().reset();
}

int scr_dma_read(void* user, unsigned long offset, unsigned long length) {
  const std::byte* from = range(card_with_memory(), offset, length);
  if (from == nullptr || user == nullptr) return -1;
  read_ring(static_cast<std::byte*>(user), from, length);
  return 0;
}

int scr_dma_write(void* user, unsigned long offset, unsigned long length) {
  std::byte* to = range(card_with_memory(), offset, length);
  if (to == nullptr || user == nullptr) return -1;
  write_ring(to, static_cast<const std::byte*>(user), length);
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
