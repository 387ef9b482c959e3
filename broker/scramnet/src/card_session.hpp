// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <rths/broker/ring.hpp>

#include "card.hpp"
#include "layout.hpp"
#include "settings.hpp"

namespace rths::scramnet {

/// The card of this process and its membership of a ring.
///
/// Attaches to the ring; creates it if there is none. Several processes may do so at once. On the
/// ring the process is listed as its configured node, or as a client.
class CardSession {
 public:
  /// @throws Error if the ring cannot be attached or created, or no card is free   @setup
  explicit CardSession(const Settings& settings);
  ~CardSession();
  CardSession(const CardSession&) = delete;
  CardSession& operator=(const CardSession&) = delete;

  /// Leaves the ring; the card keeps its state and stays mapped.
  void leave();

  /// Addresses of a card, its ACR and its last known words; on a GT ring the latter two are null.
  struct CardView {
    Card* card = nullptr;
    Word* acr = nullptr;
    Word* known = nullptr;
  };
  [[nodiscard]] const CardView& own() const { return own_; }
  [[nodiscard]] Card& card() const { return *own_.card; }
  [[nodiscard]] std::uint32_t index() const { return index_; }
  /// Card `index`, if it is in use.   @any_thread
  [[nodiscard]] std::optional<CardView> card_at(std::uint32_t index) const;
  /// Calls `act` with each card in use, including this one.   @any_thread
  template <class Act>
  void for_each_card(Act act) const {
    for (std::uint32_t i = 0; i < card_count(); ++i)
      if (const auto view = card_at(i)) act(*view);
  }

  [[nodiscard]] std::uint64_t memory_bytes() const;
  [[nodiscard]] broker::Claim self() const { return self_; }
  /// Maps a range of the ring's memory or of this card's ACR, at address `at` if that is not null.
  /// @returns null if the mapping fails
  [[nodiscard]] std::byte* map_memory(void* at, std::uint64_t offset, std::uint64_t bytes) const;
  [[nodiscard]] std::byte* map_acr(void* at, std::uint64_t bytes) const;
  /// Reserves space for the last known values of longwords. @returns false if memory is short
  [[nodiscard]] bool reserve_known(std::uint32_t first_longword, std::uint32_t longwords) const;

 private:
  [[nodiscard]] std::uint32_t card_count() const;
  [[nodiscard]] CardView view(std::byte* base) const;
  [[nodiscard]] CardView map_card(std::uint32_t index) const;
  [[nodiscard]] std::byte* map(void* at, std::uint64_t offset, std::uint64_t bytes) const;
  void open_object(const std::string& ring);
  void take_card(const Settings& settings);
  [[nodiscard]] bool try_card(std::uint32_t index, std::uint32_t key);

  static constexpr std::uint32_t kMostCards = 64;
  std::optional<broker::Ring> ring_;
  std::optional<broker::Node> node_;
  int object_ = -1;
  broker::Header* header_ = nullptr;  ///< in the ring, for the cards in use
  broker::Header layout_{};           ///< checked
  broker::Claim self_ = 0;
  std::uint32_t index_ = 0;
  CardView own_;
  mutable std::array<std::atomic<std::byte*>, kMostCards> mapped_{};
};

}  // namespace rths::scramnet
