// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <rths/broker/ring.hpp>
#include <rths/card/card_table.hpp>

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

  /// Leaves the ring; the card keeps its state and stays mapped. In a forked child it does nothing.
  void leave();
  /// False in a forked child: the card is its parent's.
  [[nodiscard]] bool is_of_this_process() const;

  using CardView = CardTable::CardView;
  [[nodiscard]] const CardView& own() const { return own_; }
  [[nodiscard]] Card& card() const { return *own_.card; }
  [[nodiscard]] std::uint32_t index() const { return index_; }
  /// Calls `act` with each card in use, including this one.   @any_thread
  template <class Act>
  void for_each_card(Act act) const {
    for (std::uint32_t i = 0; i < cards_->count(); ++i)
      if (const auto view = cards_->at(i)) act(*view);
  }

  [[nodiscard]] std::uint64_t memory_bytes() const { return cards_->memory_bytes(); }
  /// True if all words of the ring from `begin` on are in partitions of this program's node.
  [[nodiscard]] bool owns(std::uint64_t begin, std::uint64_t longwords) const;
  [[nodiscard]] broker::Claim self() const { return self_; }
  [[nodiscard]] broker::Members members() const { return cards_->members(); }
  /// True if a living process has the card.
  [[nodiscard]] bool is_held(const Card& card) const { return cards_->holder_of(card) != 0; }
  /// As those of CardTable, for this card.
  [[nodiscard]] std::byte* map_memory(void* at, std::uint64_t offset, std::uint64_t bytes) const {
    return cards_->map_memory(at, offset, bytes);
  }
  [[nodiscard]] std::byte* map_acr(void* at, std::uint64_t bytes) const {
    return cards_->map_acr(index_, at, bytes);
  }
  [[nodiscard]] bool reserve_known(std::uint32_t first_longword, std::uint32_t longwords) const {
    return cards_->reserve_known(index_, first_longword, longwords);
  }

 private:
  void use_image(Settings& settings);
  void take_card(const Settings& settings);

  std::optional<broker::Ring> ring_;
  std::optional<CardTable> cards_;
  std::optional<broker::Node> node_;
  broker::Claim self_ = 0;
  std::string node_name_;  ///< in the map; empty: none
  std::uint32_t index_ = 0;
  CardView own_;
};

}  // namespace rths::scramnet
