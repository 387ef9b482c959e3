// SPDX-License-Identifier: Apache-2.0
#include "card_session.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "ring_of_clients.hpp"
#include "segment.hpp"
#include "warning.hpp"

namespace rths::scramnet {
namespace {

using broker::Header;
using broker::is_alive;
using std::chrono::steady_clock;

constexpr auto kPowerUpTimeout = std::chrono::seconds{2};  // for another process's power-up
constexpr auto kPoll = std::chrono::milliseconds{1};

std::atomic_ref<std::uint64_t> cards_in_use(Header& header) {
  return std::atomic_ref{header.cards_in_use};
}

// Takes a claim that no process holds, or only a process that has ended.
bool take_over(SharedClaim& claim, broker::Claim self) {
  broker::Claim holder = claim.load();
  if (holder == self) return true;
  if (holder != 0 && is_alive(holder)) return false;
  return claim.compare_exchange_strong(holder, self);
}

bool wait_until_ready(const Card& card) {
  for (const auto deadline = steady_clock::now() + kPowerUpTimeout;;) {
    if (card.ready.load() == kCardReady) return true;
    if (!is_alive(card.holder.load()) || steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kPoll);
  }
}

std::optional<std::uint16_t> number_of(const std::string& text) {
  std::uint16_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

void announce_sharing(const Settings& settings, int process) {
  if (process == getpid()) return;
  warn_once("shared", fmt::format("node '{}' of ring '{}' is also process {}", settings.node,
                                  settings.ring, process)
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
          "node '{}' of ring '{}' is process {}, which writes its words; choose another node, or "
          "set {}SHARE=1 to store into them too",
          settings.node, settings.ring, rival.pid, settings.variables)};
    announce_sharing(settings, rival.pid);
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
  try {
    open_object(settings.ring);
    node_.emplace(join_as_client(*ring_, settings));
    take_card(settings);
  } catch (...) {
    if (object_ >= 0) close(object_);
    throw;
  }
}

void CardSession::leave() {
  broker::Claim self = self_;
  own_.card->holder.compare_exchange_strong(self, 0);
  node_.reset();
}

CardSession::~CardSession() {
  leave();
  for (auto& base : mapped_)
    if (std::byte* address = base.load()) munmap(address, layout_.card_bytes);
  munmap(header_, sizeof(Header));
  close(object_);
}

void CardSession::open_object(const std::string& ring) {
  object_ = shm_open(("/" + broker::object_name(ring)).c_str(), O_RDWR | O_CLOEXEC, 0);
  if (object_ < 0) throw Error{fmt::format("ring '{}': {}", ring, std::strerror(errno))};
  header_ = reinterpret_cast<Header*>(map(nullptr, 0, sizeof(Header)));
  if (header_ == nullptr) throw Error{fmt::format("ring '{}': {}", ring, std::strerror(errno))};
  // Another object of this name may have replaced that of the ring.
  layout_ = *header_;
  const memmap::Map& map_of_ring = ring_->map();
  if (!broker::is_same_layout(
          layout_, broker::plan_layout(map_of_ring, map_of_ring.to_toml(),
                                       static_cast<std::uint32_t>(layout_.journal_bits))))
    throw Error{fmt::format("ring '{}' was replaced while this program attached to it", ring)};
}

void CardSession::take_card(const Settings& settings) {
  std::uint32_t key = kAnonymous;
  if (const auto number = number_of(settings.node))
    key = kNamed | *number;
  else if (!settings.node.empty())
    key = kNamed | ring_->map().node(settings.node).value();
  for (index_ = 0; index_ < card_count(); ++index_) {
    if (!try_card(index_, key)) continue;
    const broker::Claim holder = own_.card->holder.load();
    if (holder != self_ && is_alive(holder)) announce_sharing(settings, broker::pid_of(holder));
    return;
  }
  throw Error{fmt::format("ring '{}': all {} cards are in use", settings.ring, card_count())};
}

// Processes take cards in order. A process that finds a card in power-up waits until its key is
// known, so that no key gets two cards.
bool CardSession::try_card(std::uint32_t index, std::uint32_t key) {
  const auto offset = static_cast<off_t>(layout_.cards_at + index * layout_.card_bytes);
  const auto bytes =
      static_cast<off_t>(broker::kCardRegisterBytes + broker::acr_bytes(layout_.memory_bytes));
  if (const int problem = posix_fallocate(object_, offset, bytes); problem != 0)
    throw Error{fmt::format("cannot reserve space for a card: {}", std::strerror(problem))};
  own_ = map_card(index);
  if (own_.card == nullptr) throw Error{fmt::format("cannot map a card: {}", std::strerror(errno))};
  Card& card = *own_.card;
  if (card.ready.load() != kCardReady) {
    if (take_over(card.holder, self_)) {
      power_up(card, index);
      card.key.store(key);
      card.ready.store(kCardReady);
      cards_in_use(*header_).fetch_or(std::uint64_t{1} << index);
      return true;
    }
    if (!wait_until_ready(card))
      throw Error{fmt::format("card {} was not powered up by its process", index)};
  }
  if (card.key.load() != key) return false;
  return take_over(card.holder, self_) || key != kAnonymous;
}

std::uint32_t CardSession::card_count() const {
  return static_cast<std::uint32_t>(layout_.card_count);
}

std::uint64_t CardSession::memory_bytes() const { return layout_.memory_bytes; }

CardSession::CardView CardSession::view(std::byte* base) const {
  if (base == nullptr) return {};
  const std::uint64_t acr = broker::acr_bytes(layout_.memory_bytes);
  auto* words = reinterpret_cast<Word*>(base + broker::kCardRegisterBytes);
  if (acr == 0) words = nullptr;
  return {reinterpret_cast<Card*>(base), words, words == nullptr ? nullptr : words + acr / 4};
}

// If several threads map the same card at once, the first mapping is kept.
CardSession::CardView CardSession::map_card(std::uint32_t index) const {
  std::byte* base = mapped_[index].load();
  if (base != nullptr) return view(base);
  std::byte* fresh =
      map(nullptr, layout_.cards_at + index * layout_.card_bytes, layout_.card_bytes);
  if (fresh == nullptr || mapped_[index].compare_exchange_strong(base, fresh)) return view(fresh);
  munmap(fresh, layout_.card_bytes);
  return view(base);
}

std::optional<CardSession::CardView> CardSession::card_at(std::uint32_t index) const {
  if ((cards_in_use(*header_).load() >> index & 1) == 0) return std::nullopt;
  const CardView found = map_card(index);
  return found.card == nullptr ? std::nullopt : std::optional{found};
}

std::byte* CardSession::map(void* at, std::uint64_t offset, std::uint64_t bytes) const {
  const int flags = MAP_SHARED | (at == nullptr ? 0 : MAP_FIXED);
  void* address =
      mmap(at, bytes, PROT_READ | PROT_WRITE, flags, object_, static_cast<off_t>(offset));
  return address == MAP_FAILED ? nullptr : static_cast<std::byte*>(address);
}

std::byte* CardSession::map_memory(void* at, std::uint64_t offset, std::uint64_t bytes) const {
  return map(at, layout_.memory_at + offset, bytes);
}

std::byte* CardSession::map_acr(void* at, std::uint64_t bytes) const {
  const std::uint64_t card = layout_.cards_at + index_ * layout_.card_bytes;
  return map(at, card + broker::kCardRegisterBytes, bytes);
}

bool CardSession::reserve_known(std::uint32_t first_longword, std::uint32_t longwords) const {
  const std::uint64_t card = layout_.cards_at + index_ * layout_.card_bytes;
  const std::uint64_t known =
      card + broker::kCardRegisterBytes + broker::acr_bytes(layout_.memory_bytes);
  return posix_fallocate(object_, static_cast<off_t>(known + std::uint64_t{first_longword} * 4),
                         static_cast<off_t>(std::uint64_t{longwords} * 4)) == 0;
}

}  // namespace rths::scramnet
