// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <rths/card/bits.hpp>
#include <rths/card/card.hpp>
#include <rths/card/registers.hpp>
#include <rths/replicated/ring.hpp>

#include "message.hpp"

namespace rths::replicated {

/// Bytes that read as zero until they are written; pages of 4 KiB exist from their first write.
class SparseBytes {
 public:
  explicit SparseBytes(std::uint64_t bytes) : pages_((bytes + kPage - 1) / kPage), bytes_{bytes} {}

  [[nodiscard]] std::uint64_t size() const { return bytes_; }
  /// @pre the value does not cross a page: it is aligned to its size
  template <class Value>
  [[nodiscard]] Value get(std::uint64_t at) const {
    Value value = 0;
    if (const auto& page = pages_[at / kPage])
      std::memcpy(&value, &(*page)[at % kPage], sizeof value);
    return value;
  }
  template <class Value>
  void set(std::uint64_t at, Value value) {
    auto& page = pages_[at / kPage];
    if (!page) {
      if (value == 0) return;
      page = std::make_unique<Page>();
    }
    std::memcpy(&(*page)[at % kPage], &value, sizeof value);
  }
  void clear() {
    for (auto& page : pages_) page.reset();
  }

 private:
  static constexpr std::uint64_t kPage = 4096;
  using Page = std::array<std::byte, kPage>;
  std::vector<std::unique_ptr<Page>> pages_;
  std::uint64_t bytes_;
};

/// A store on its way to the ring.
struct FifoEntry {
  std::uint32_t address = 0;  ///< on the ring [B]; of an interrupt: its number
  std::uint32_t value = 0;
  std::uint8_t enables = 0xF;
  Content content = Content::Data;
  bool interrupt = false;
};

/// Bytes of a longword that a store of 1, 2 or 4 bytes covers, as bits.
[[nodiscard]] constexpr std::uint8_t enabled_bytes(std::uint32_t offset, std::uint32_t bytes) {
  return static_cast<std::uint8_t>(((1U << bytes) - 1) << offset % 4);
}

/// The card's transmit FIFO. The vendor's self-test expects its full flag by 1022 entries.
class TransmitFifo {
 public:
  static constexpr std::uint32_t kEntries = 1024, kSevenEighths = 896, kFullFlag = 1022;

  [[nodiscard]] std::uint32_t size() const { return added_ - taken_; }
  [[nodiscard]] bool is_empty() const { return added_ == taken_; }
  [[nodiscard]] bool is_full() const { return size() == kEntries; }
  [[nodiscard]] const FifoEntry& first() const { return entries_[taken_ % kEntries]; }
  void add(const FifoEntry& entry) { entries_[added_++ % kEntries] = entry; }
  FifoEntry take() { return entries_[taken_++ % kEntries]; }
  void clear() { taken_ = added_; }

 private:
  std::array<FifoEntry, kEntries> entries_{};
  std::uint32_t added_ = 0, taken_ = 0;
};

/// ACR of a card, by longword: in this process, or in the object of an image.
class AcrCells {
 public:
  explicit AcrCells(std::uint64_t longwords) : own_{longwords} {}
  /// @param cells  as many longwords; null: those of this process
  void share(scramnet::Word* cells) { shared_ = cells; }
  [[nodiscard]] std::uint64_t size() const { return own_.size(); }
  [[nodiscard]] std::uint32_t get(std::uint64_t longword) const {
    if (shared_ != nullptr) return shared_[longword].load(std::memory_order_relaxed);
    return own_.get<std::uint8_t>(longword);
  }
  void set(std::uint64_t longword, std::uint32_t bits) {
    bits &= scramnet::acr::kBits;
    if (shared_ != nullptr)
      shared_[longword].store(bits);
    else
      own_.set(longword, static_cast<std::uint8_t>(bits));
  }
  void clear() {
    if (shared_ == nullptr) return own_.clear();
    for (std::uint64_t i = 0; i < size(); ++i)
      if (shared_[i].load(std::memory_order_relaxed) != 0) shared_[i].store(0);
  }

 private:
  SparseBytes own_;
  scramnet::Word* shared_ = nullptr;
};

/// CSR0 of a node on the ring: inserted, receives, transmits.
inline constexpr std::uint32_t kOnRing = 0x8003;

/// How a node's transmitter and receiver are connected.
enum class Path : std::uint8_t {
  Off,       ///< no power: the ring passes optically
  Monitor,   ///< receives only: the ring passes optically
  Looped,    ///< own messages return inside the card: the ring passes optically
  Inserted,  ///< in the ring
  Breaking   ///< wire loopback of an inserted node: the ring is open
};

/// The message whose bits pass a node's input or output now.
struct CardLine {
  std::uint32_t open = kNone;  ///< message of unknown length; none if the line's end is known
  Time start{0};               ///< of the last message
  Time free{0};                ///< output only: the next message may start; unknown while open
  bool own = false, received = false;  ///< input only: of the open message
};

/// A message of a card with error correction, until it has returned intact.
struct Outstanding {
  bool active = false, repeat = false;
  std::uint32_t attempt = 0;
  Message message;
};

inline constexpr std::uint32_t kGtQueue = 256;  ///< hardware queue of a GT card

/// Interrupts of a GT card, oldest first; a full queue drops the newest.
struct GtQueue {
  std::array<GtInterrupt, kGtQueue> entries{};
  std::uint32_t added = 0, taken = 0;
  [[nodiscard]] std::uint32_t size() const { return added - taken; }
};

struct CardNode {
  explicit CardNode(const NodeSetup& setup, CardType type);

  // Ring.
  Time fibre, extra_delay;
  bool connected = true, bypass_switch, powered = true;
  Path path = Path::Monitor;
  CardLine input, output;
  std::uint32_t waiting_first = kNone, waiting_last = kNone, waiting = 0;  ///< insertion register

  // Transmitter.
  TransmitFifo fifo;
  std::uint32_t own_open = kNone;  ///< own message that may get longer
  Time transmit_at{0};             ///< of the scheduled transmission
  bool transmit_scheduled = false;
  bool yielded = false;  ///< the next own message has already let one message pass
  Outstanding outstanding;
  Time transit_since{0};
  bool transit_armed = false, transit_runs = false;
  Time round_trip{0};  ///< of the last own message that has returned; 0: none

  // Card.
  std::uint32_t id;  ///< after power-up
  SparseBytes memory;
  AcrCells acr;
  std::unique_ptr<scramnet::PlusCard> own_plus;
  scramnet::PlusCard* plus = nullptr;  ///< own, or in `shared`
  scramnet::Card* shared = nullptr;    ///< card in the object of an image
  broker::Members members{-1};         ///< of that image
  std::unique_ptr<scramnet::GtCard> gt;
  std::uint32_t hipro_longword = kNone;  ///< whose bytes are being collected
  std::uint8_t hipro_bytes = 0;
  GtQueue queue;
  CardReport counts;
};

}  // namespace rths::replicated
