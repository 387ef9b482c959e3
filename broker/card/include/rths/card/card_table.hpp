// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/detail/process.hpp>
#include <rths/broker/ring.hpp>
#include <rths/card/card.hpp>

namespace rths::scramnet {

/// The cards in a ring's object, mapped when they are needed.
class CardTable {
 public:
  /// @param name  of the ring
  /// @throws Error if another ring has replaced it, or memory is short   @setup
  CardTable(const broker::Ring& ring, const std::string& name);
  ~CardTable();
  CardTable(const CardTable&) = delete;
  CardTable& operator=(const CardTable&) = delete;

  /// Addresses of a card, its ACR and its last known words; on a GT ring the latter two are null.
  struct CardView {
    Card* card = nullptr;
    Word* acr = nullptr;
    Word* known = nullptr;
  };
  [[nodiscard]] std::uint32_t count() const {
    return static_cast<std::uint32_t>(layout_.card_count);
  }
  /// Bit n: card n is in use.   @any_thread
  [[nodiscard]] std::uint64_t in_use() const;
  /// Card `index`, if it is in use.   @any_thread
  [[nodiscard]] std::optional<CardView> at(std::uint32_t index) const;

  /// Takes the card of a key, or the first free one: `kAnonymous`, or `kNamed | node`. A named card
  /// that a living process holds is shared with it.
  /// @returns its index; empty if all cards are in use
  /// @throws Error if memory is short, or another process does not finish a power-up   @setup
  [[nodiscard]] std::optional<std::uint32_t> take(std::uint32_t key, broker::Claim self);

  /// The processes on the ring, which hold its cards.   @any_thread
  [[nodiscard]] broker::Members members() const { return broker::Members{object_}; }
  /// Process that holds a card; 0 if none does, or if it has ended.   @any_thread
  [[nodiscard]] broker::Claim holder_of(const Card& card) const {
    const broker::Claim holder = card.holder.load();
    return members().has(holder) ? holder : 0;
  }

  /// Sets a card to its state after power-up; its queues keep their entries.
  void reset(std::uint32_t index);

  [[nodiscard]] std::uint64_t memory_bytes() const { return layout_.memory_bytes; }
  /// True if each node of this ring has an image of the memory.   @any_thread
  [[nodiscard]] bool has_images() const;
  /// Number of looks that `rths watch` has completed on this ring.   @any_thread
  [[nodiscard]] std::uint64_t looks() const;
  /// Maps a range of the ring's memory, or of a card's ACR, at address `at` if that is not null.
  /// @returns null if the mapping fails
  /// Until `unmap`, lost pages are handled as `OnLostMemory` says.
  [[nodiscard]] std::byte* map_memory(void* at, std::uint64_t offset, std::uint64_t bytes) const;
  [[nodiscard]] std::byte* map_acr(std::uint32_t index, void* at, std::uint64_t bytes) const;
  static void unmap(std::byte* address, std::uint64_t bytes) noexcept;
  /// Reserves space for the last known values of longwords. @returns false if memory is short
  [[nodiscard]] bool reserve_known(std::uint32_t index, std::uint32_t first_longword,
                                   std::uint32_t longwords) const;

 private:
  [[nodiscard]] CardView view(std::byte* base) const;
  [[nodiscard]] CardView map_card(std::uint32_t index) const;
  [[nodiscard]] std::byte* map(void* at, std::uint64_t offset, std::uint64_t bytes) const;
  [[nodiscard]] bool try_card(std::uint32_t index, std::uint32_t key, broker::Claim self);
  [[nodiscard]] bool take_over(Card& card, broker::Claim self) const;
  [[nodiscard]] bool wait_until_ready(const Card& card) const;

  static constexpr std::uint32_t kMostCards = 64;
  int object_ = -1;
  broker::Header* header_ = nullptr;  ///< in the ring, for the cards in use
  broker::Header layout_{};           ///< checked
  mutable std::array<std::atomic<std::byte*>, kMostCards> mapped_{};
};

}  // namespace rths::scramnet
