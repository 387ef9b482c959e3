// SPDX-License-Identifier: Apache-2.0
//
// Interrupts between cards on different hosts.
//
// A card's interrupts are part of the stream of its node, as messages between the node's writes.
// Two things cross hosts. The state of a card: SCRAMNet+ cards raise interrupts by the sender's
// registers and ACR, so each host has a copy of the cards of other hosts' nodes. And the interrupts
// of GT cards: programs put them into the queues of the copies, from which the gateway sends them.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/card/card_table.hpp>
#include <rths/core/clock.hpp>

namespace rths::dds {

/// A message of a card, as words.
using CardMessage = std::vector<std::uint32_t>;

/// The cards of a ring, for both threads of its gateway.
class Cards {
 public:
  /// @throws Error
  Cards(const broker::Ring& ring, const std::string& name);
  ~Cards();
  Cards(const Cards&) = delete;
  Cards& operator=(const Cards&) = delete;

  /// True if the ring has no card; then there is nothing to do.   @any_thread
  [[nodiscard]] bool none() const { return table_.in_use() == 0; }

  /// Messages with the whole state of a node's card, if it has one.   @any_thread
  [[nodiscard]] std::vector<CardMessage> state_of(NodeId node);
  /// The same, if the state has changed since the last call.   @any_thread
  [[nodiscard]] std::vector<CardMessage> changes_of(NodeId node);

  /// An interrupt of a GT card of this host, for that of a node of another host.
  struct Interrupt {
    std::optional<NodeId> from;  ///< empty: the sending card is no node of the map
    NodeId to;
    CardMessage message;
  };
  /// Appends the interrupts that may be sent: their data are in the journals, if a watch runs.
  /// @returns number of interrupts lost since the last call: overwritten in a queue, or of a copy
  /// that was released   @any_thread
  [[nodiscard]] std::uint64_t take_interrupts(TimePoint now, std::vector<Interrupt>& taken);

  /// Applies a message that anyone may have sent to the copy of the card of a node of another host,
  /// or to the card that it interrupts. @returns false if it is malformed   @any_thread
  /// @throws Error if there is no card for the copy
  [[nodiscard]] bool apply(NodeId node, std::span<const std::uint32_t> message);
  /// The node left: its copy is free.   @any_thread
  void release(NodeId node);

 private:
  using CardView = scramnet::CardTable::CardView;
  /// Copy of a card of another host.
  struct Copy {
    std::uint32_t index;
    CardView view;
    std::uint64_t position = 0;  ///< of the next interrupt in its queue
  };
  struct Held {
    Interrupt interrupt;
    std::uint64_t look;  ///< the data are in the journals after this many looks
  };
  [[nodiscard]] std::optional<CardView> card_of(NodeId node) const;
  /// Appends messages with the words that interrupt.
  void append_words(const CardView& view, std::vector<CardMessage>& messages) const;
  [[nodiscard]] std::optional<NodeId> node_with_gt_id(std::uint32_t id) const;
  [[nodiscard]] Copy& copy_of(NodeId node);
  [[nodiscard]] bool set_registers(NodeId node, std::span<const std::uint32_t> message);
  [[nodiscard]] bool set_interrupting_words(NodeId node, std::span<const std::uint32_t> message);
  [[nodiscard]] bool deliver(std::span<const std::uint32_t> message);
  /// Takes the interrupts in a copy's queue.
  void hold(NodeId to, Copy& copy);

  scramnet::CardTable table_;
  std::mutex mutex_;  ///< of all below
  std::map<NodeId, Copy> copies_;
  std::map<NodeId, std::vector<std::uint32_t>> sent_;  ///< registers of local cards
  std::deque<Held> held_;
  std::uint64_t lost_ = 0;  ///< interrupts, since the last call of take_interrupts
  std::uint64_t looks_ = 0;
  TimePoint looked_{0};  ///< when `looks_` changed
};

}  // namespace rths::dds
