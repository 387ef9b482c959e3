// SPDX-License-Identifier: Apache-2.0
#include "card_session.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include <rths/broker/detail/shared_object.hpp>
#include <rths/card/image_name.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "warning.hpp"

namespace rths::scramnet {
namespace {

// A map must have a node. This map has no partitions, so any client may write its words.
memmap::Map plain_map(const Settings& settings) {
  memmap::MapDescription description;
  description.name = "plain";
  description.size_longwords = static_cast<std::uint32_t>(settings.ring_bytes / 4);
  description.nodes = {{"client", NodeId{0}, ""}};
  return memmap::Map{description};
}

bool exists(const std::string& ring) {
  return access(broker::object_path(ring).c_str(), F_OK) == 0;
}

void announce_plain_ring(const Settings& settings) {
  warn_once("map",
            fmt::format("made ring '{}' without a map; to join a run of this name, start the "
                        "run first; {}MAP gives a new ring a map",
                        settings.ring, settings.variables)
                .c_str());
}

/// Attaches to the ring of these settings; creates it if there is none. Unlike `Ring::create`,
/// keeps a ring without processes: a card's memory outlives the programs that use it.
/// @throws Error if the ring can be neither attached nor created   @setup
broker::Ring attach_or_make(const Settings& settings) {
  constexpr int kMostOpens = 3;  // another process may create or remove the ring meanwhile
  for (int attempt = 1;; ++attempt) {
    try {
      if (!exists(settings.ring)) {
        const auto map =
            settings.map.empty() ? plain_map(settings) : memmap::load_map(settings.map);
        const auto made = broker::Ring::create_new(settings.ring, map);
        if (settings.map.empty() && settings.ring_is_chosen) announce_plain_ring(settings);
      }
      return broker::Ring::attach(settings.ring);
    } catch (const Error&) {
      if (attempt == kMostOpens) throw;
    }
  }
}

std::optional<std::uint16_t> number_of(const std::string& text) {
  std::uint16_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

void announce_sharing(const Settings& settings, const std::string& process) {
  if (process == broker::in_words(broker::own_claim())) return;
  warn_once("shared",
            fmt::format("node '{}' of ring '{}' is also {}", settings.node, settings.ring, process)
                .c_str());
}

// Announces the process that is this node already.
// @throws Error if that process writes the node's words by the library, and they are not shared
void check_rival(const Settings& settings) {
  const auto report = broker::inspect_ring(settings.ring);
  if (!report) return;
  for (const auto& rival : report->occupants) {
    if (!rival.alive || rival.node != settings.node) continue;
    if (!rival.plain && !settings.share)
      throw Error{fmt::format(
          "node '{}' of ring '{}' is {}, which writes its words; choose another node, or "
          "set {}SHARE=1 to store into them too",
          settings.node, settings.ring, rival.process, settings.variables)};
    announce_sharing(settings, rival.process);
  }
}

// Joins as a node of the map, so that others see whether it is alive. If several processes share a
// card, the first is the node.
broker::Node join_as_client(broker::Ring& ring, const Settings& settings) {
  if (settings.node.empty() || number_of(settings.node)) return ring.join_plain("");
  static_cast<void>(ring.map().node(settings.node));
  try {
    return ring.join_plain(settings.node);
  } catch (const Error&) {
    check_rival(settings);
    return ring.join_plain("");
  }
}

}  // namespace

CardSession::CardSession(const Settings& settings) : self_{broker::own_claim()} {
  ring_.emplace(attach_or_make(settings));
  cards_.emplace(*ring_, settings.ring);
  Settings own = settings;
  if (cards_->has_images()) use_image(own);
  node_.emplace(join_as_client(*ring_, own));
  take_card(own);
}

// On a replicated ring, the card of this process has the image of its node.
void CardSession::use_image(Settings& settings) {
  if (settings.variables == kGtVariables)
    throw Error{
        fmt::format("ring '{}' has SCRAMNet+ cards, expected a ring of GT cards", settings.ring)};
  if (settings.node.empty() || number_of(settings.node))
    throw Error{fmt::format("ring '{}' is replicated: {}NODE is '{}', expected a node of its map",
                            settings.ring, settings.variables, settings.node)};
  static_cast<void>(ring_->map().node(settings.node));
  node_name_ = settings.node;
  settings.ring = image_name(settings.ring, settings.node);
  ring_.emplace(broker::Ring::attach(settings.ring));
  cards_.emplace(*ring_, settings.ring);
  for_each_card([](const CardView& card) { card.card->carried.plain_host.store(1); });
}

bool CardSession::owns(std::uint64_t begin, std::uint64_t longwords) const {
  const std::uint64_t end = begin + longwords;
  std::uint64_t owned = 0;
  for (const auto& partition : ring_->map().partitions()) {
    if (partition.node != node_name_) continue;
    const std::uint64_t first = std::max<std::uint64_t>(begin, partition.base.value());
    const std::uint64_t last =
        std::min<std::uint64_t>(end, partition.base.value() + partition.longwords);
    if (first < last) owned += last - first;
  }
  return owned == longwords;
}

bool CardSession::is_of_this_process() const { return self_ == broker::own_claim(); }

void CardSession::leave() {
  if (!is_of_this_process()) return;
  broker::Claim self = self_;
  own_.card->holder.compare_exchange_strong(self, 0);
  node_.reset();
}

CardSession::~CardSession() { leave(); }

void CardSession::take_card(const Settings& settings) {
  std::uint32_t key = kAnonymous;
  if (const auto number = number_of(settings.node))
    key = kNamed | *number;
  else if (!settings.node.empty())
    key = kNamed | ring_->map().node(settings.node).value();
  const auto taken = cards_->take(key, self_);
  if (!taken)
    throw Error{fmt::format("ring '{}': all {} cards are in use", settings.ring, cards_->count())};
  index_ = *taken;
  own_ = *cards_->at(index_);
  if (own_.card->carried.active.load() != 0) return;
  const broker::Claim holder = cards_->holder_of(*own_.card);
  if (holder != 0 && holder != self_) announce_sharing(settings, broker::in_words(holder));
}

}  // namespace rths::scramnet
