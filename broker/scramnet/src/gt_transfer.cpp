// SPDX-License-Identifier: Apache-2.0
//
// Vendor's GT calls: moving data and interrupts.

#include <cstring>

#include "gt_unit.hpp"
#include "ring_copy.hpp"

using namespace rths::scramnet;

namespace {

constexpr uint32 kPioFlags = SCGT_RW_PIO | SCGR_RW_PIO_8_BIT | SCGR_RW_PIO_16_BIT;

/// A transfer, rounded down to the width of an access.
struct Transfer {
  uint32 offset, bytes, width, flags;
  bool pio;
};

Transfer plan(uint32 offset, uint32 bytes, uint32 flags) {
  const uint32 width = (flags & SCGR_RW_PIO_8_BIT) != 0    ? 1
                       : (flags & SCGR_RW_PIO_16_BIT) != 0 ? 2
                                                           : 4;
  return {offset / width * width, bytes / width * width, width, flags, (flags & kPioFlags) != 0};
}

// Finds errors that hardware would report as a fault or a DMA time-out.
uint32 defect_of(const Transfer& transfer, const GtUnit& unit, const scgtHandle& handle) {
  if (transfer.pio && handle.memMapPtr == nullptr) return SCGT_BAD_PARAMETER;
  if ((transfer.flags & SCGT_RW_DMA_PHYS_ADDR) != 0 && !transfer.pio) return SCGT_DMA_UNSUPPORTED;
  const uint32 all = unit.memory_bytes();
  if (transfer.offset > all || transfer.bytes > all - transfer.offset) return SCGT_BAD_PARAMETER;
  return SCGT_SUCCESS;
}

template <class Unit>
void copy_units(std::byte* to, const std::byte* from, uint32 bytes, bool to_ring) {
  if (to_ring)
    write_ring_units<Unit>(to, from, bytes);
  else
    read_ring_units<Unit>(to, from, bytes);
}

// A longword of the ring, or of the user's buffer, which may have any alignment.
uint32 load_longword(const std::byte* from, bool of_ring) {
  if (of_ring) return read_ring_unit<uint32>(from);
  uint32 word = 0;
  std::memcpy(&word, from, sizeof word);
  return word;
}
void store_longword(std::byte* to, uint32 word, bool of_ring) {
  if (of_ring) return write_ring_unit(to, word);
  std::memcpy(to, &word, sizeof word);
}

// The DMA engine swaps the bytes of a longword, or the longwords of a pair.
void copy_swapped(std::byte* to, const std::byte* from, const Transfer& transfer, bool to_ring) {
  const bool bytes = (transfer.flags & SCGT_RW_DMA_BYTE_SWAP) != 0;
  const bool words = (transfer.flags & SCGT_RW_DMA_WORD_SWAP) != 0;
  for (uint32 i = 0; i < transfer.bytes; i += 4) {
    const uint32 partner = (i / 4 ^ 1U) * 4;
    const std::byte* const at = from + (words && partner < transfer.bytes ? partner : i);
    const uint32 word = load_longword(at, !to_ring);
    store_longword(to + i, bytes ? __builtin_bswap32(word) : word, to_ring);
  }
}

void move(std::byte* to, const std::byte* from, const Transfer& transfer, bool to_ring) {
  const bool swaps = (transfer.flags & (SCGT_RW_DMA_BYTE_SWAP | SCGT_RW_DMA_WORD_SWAP)) != 0;
  if (!transfer.pio && swaps) return copy_swapped(to, from, transfer, to_ring);
  if (transfer.width == 1) return copy_units<uint8>(to, from, transfer.bytes, to_ring);
  if (transfer.width == 2) return copy_units<uint16>(to, from, transfer.bytes, to_ring);
  copy_units<uint32>(to, from, transfer.bytes, to_ring);
}

bool is_valid(const scgtInterrupt& interrupt) {
  return (interrupt.type == SCGT_BROADCAST_INTR && interrupt.id < kBroadcasts) ||
         (interrupt.type == SCGT_UNICAST_INTR && interrupt.id < kNodes) ||
         interrupt.type == SCGT_NO_INTR;
}

void set_done(uint32* done, uint32 bytes) {
  if (done != nullptr) *done = bytes;
}

}  // namespace

extern "C" {

// NOLINTNEXTLINE(readability-function-size): the vendor's prototype has seven parameters
uint32 scgtWrite(scgtHandle* handle, uint32 offset, const void* data, uint32 bytes, uint32 flags,
                 uint32* done, const scgtInterrupt* interrupt) {
  set_done(done, 0);
  GtUnit* unit = unit_of(handle);
  if (unit == nullptr || (interrupt != nullptr && !is_valid(*interrupt))) return SCGT_BAD_PARAMETER;
  const bool interrupts = interrupt != nullptr && interrupt->type != SCGT_NO_INTR;
  const Transfer transfer = plan(offset, bytes, flags);
  if (data != nullptr && transfer.bytes != 0) {
    if (const uint32 defect = defect_of(transfer, *unit, *handle); defect != SCGT_SUCCESS)
      return defect;
    move(unit->memory() + transfer.offset, static_cast<const std::byte*>(data), transfer, true);
    set_done(done, transfer.bytes);
    unit->card().counts[kWrites].fetch_add(1);
  } else if (!interrupts || (transfer.pio && handle->memMapPtr == nullptr)) {
    return SCGT_BAD_PARAMETER;
  }
  return !interrupts || unit->send(*interrupt) ? SCGT_SUCCESS : SCGT_DRIVER_ERROR;
}

uint32 scgtRead(scgtHandle* handle, uint32 offset, void* data, uint32 bytes, uint32 flags,
                uint32* done) {
  set_done(done, 0);
  GtUnit* unit = unit_of(handle);
  const Transfer transfer = plan(offset, bytes, flags);
  if (unit == nullptr || data == nullptr || transfer.bytes == 0) return SCGT_BAD_PARAMETER;
  if (const uint32 defect = defect_of(transfer, *unit, *handle); defect != SCGT_SUCCESS)
    return defect;
  move(static_cast<std::byte*>(data), unit->memory() + transfer.offset, transfer, false);
  set_done(done, transfer.bytes);
  unit->card().counts[kReads].fetch_add(1);
  return SCGT_SUCCESS;
}
}
