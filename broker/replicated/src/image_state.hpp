// SPDX-License-Identifier: Apache-2.0
//
// The images of a ring and their cards. image_words.cpp has the way of the words, from the writes
// of a node to the other images.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/detail/shared_object.hpp>
#include <rths/broker/follow.hpp>
#include <rths/broker/watch.hpp>
#include <rths/card/card_table.hpp>
#include <rths/replicated/images.hpp>
#include <rths/replicated/scenario.hpp>

#include "engine.hpp"

namespace rths::replicated {

/// One word in the object of a ring, by which a process asks the cards of the ring for a fault.
class FaultBox {
 public:
  /// @throws Error if there is no such ring   @setup
  explicit FaultBox(const std::string& ring);
  /// Marks the ring as one of images. From now on processes may ask.
  void open();
  [[nodiscard]] bool is_open() const;
  /// The fault that a process asks for.
  [[nodiscard]] std::optional<Action> asked() const;
  /// Tells that process that the fault has happened.
  void confirm();
  /// Asks for a fault. @returns false if it has not happened after a second
  [[nodiscard]] bool ask(const Action& action);

 private:
  [[nodiscard]] broker::Header& header() const {
    return *reinterpret_cast<broker::Header*>(page_.address());
  }
  broker::SharedObject object_;
  broker::Mapping page_;
};

struct Images::State {
  /// A word that nodes write: its owner, and its tear group.
  struct WordUse {
    std::uint32_t owner = kNone;  ///< position
    std::uint32_t group = kNone;
  };

  struct GroupUse {
    TearGroupId id;
    std::uint32_t base = 0, longwords = 0;
  };

  struct Store {
    std::uint32_t offset = 0;  ///< on the ring [B]
    std::uint32_t value = 0;
    std::uint32_t bytes = 4;  ///< 1, 2 or 4
    bool in_memory = true;    ///< of a trap: the image has the value
    [[nodiscard]] std::uint32_t longword() const { return offset / 4; }
  };

  /// Stores that the traps of a host have taken.
  struct Trapped {
    std::vector<Store> found = {};                  // NOLINT: in this look
    std::vector<Store> earlier = {};                // NOLINT: in the last one
    std::optional<std::uint32_t> unpublished = {};  // NOLINT: entry that its host has not published
    Time since{0};                                  ///< when it was found first
  };

  /// The memory of one node.
  struct Image {
    std::string node;
    broker::Ring ring;
    broker::Node carrier;                  ///< of the messages of others; no node of the map
    std::optional<broker::Follower> host;  ///< writes of the node
    // g++ needs these initializers.
    std::vector<std::optional<broker::Node>> others = {};  // NOLINT: on this image, by position
    std::vector<char> received = {};  // NOLINT: by position, since the last beat
    std::deque<Store> waiting = {};   // NOLINT: for space in the transmit FIFO
    Trapped trapped = {};             // NOLINT
    std::unique_ptr<broker::Watch> watch =
        nullptr;           ///< finds stores through pointers; of named images
    bool plain = false;    ///< its node stores through a pointer
    int absent_looks = 0;  ///< in a row
    bool present = false;  ///< its card was inserted, its node has not left
  };

  State(const memmap::Map& its_map, const CardOptions& its_options);
  ~State() {
    for (const auto& ring : to_remove) broker::remove_ring(ring);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Adds the images in the order of the map; `make` makes the ring of a node, in any order.
  void add_all(const std::function<broker::Ring(const std::string& node)>& make);
  void add(const std::string& node, broker::Ring ring);
  [[nodiscard]] std::uint32_t position(const std::string& node) const;
  void find_words();
  void follow_presence();
  void follow_presence(std::uint32_t at);
  [[nodiscard]] bool is_drained(std::uint32_t at);
  void take_stores(std::uint32_t at);
  void take_trapped(std::uint32_t at);
  [[nodiscard]] bool gives_up(Trapped& trapped, std::uint32_t entry);
  void look(std::uint32_t at);
  [[nodiscard]] broker::Judgement judge(std::uint32_t at, std::uint32_t longword);
  void send_trapped(std::uint32_t at);
  void ignore_journal(Image& image);
  [[nodiscard]] bool writes_last(std::uint32_t at);
  void store(std::uint32_t at, Store store);
  [[nodiscard]] Access write(std::uint32_t at, Store store);
  [[nodiscard]] std::uint64_t window(std::uint32_t at);  ///< [B]
  void share_cards();
  void flush(std::uint32_t at);
  void arrive(const Hop& hop);
  void arrive(std::uint32_t at, std::uint32_t origin, std::uint32_t longword, std::uint32_t value);
  void store_unjournalled(Image& image, std::uint32_t longword, std::uint32_t value);
  [[nodiscard]] std::uint32_t owner_of(std::uint32_t longword) const {
    return longword < words.size() ? words[longword].owner : kNone;
  }
  [[nodiscard]] broker::Node* stand_in(std::uint32_t at, std::uint32_t origin);
  void fail(Action action);
  void run_faults(Time now);
  void beat(std::uint32_t at);

  memmap::Map map;
  CardOptions options;
  std::vector<std::unique_ptr<scramnet::CardTable>> tables;  ///< of named images
  Ring cards;
  std::optional<FaultBox> box;         ///< of named images
  std::string name;                    ///< of the ring; empty in private memory
  std::vector<std::string> to_remove;  ///< names of rings
  std::vector<Image> images;           ///< by position
  std::vector<WordUse> words;
  std::vector<GroupUse> groups;
  std::vector<std::uint32_t> group_words;  ///< scratch
  std::vector<std::string> events;
  std::size_t next_fault = 0;
  Time begin{0}, next_presence{0};
  std::uint64_t stalls = 0;
};

}  // namespace rths::replicated
