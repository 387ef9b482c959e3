// SPDX-License-Identifier: Apache-2.0
#include <rths/card/card_table.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/broker/detail/card_layout.hpp>
#include <rths/broker/detail/lost_memory.hpp>
#include <rths/broker/detail/shared_object.hpp>
#include <rths/card/gt_registers.hpp>
#include <rths/card/registers.hpp>
#include <rths/core/error.hpp>

namespace rths::scramnet {
namespace {

using broker::Header;
using std::chrono::steady_clock;

constexpr auto kPowerUpTimeout = std::chrono::seconds{2};  // for another process's power-up
constexpr auto kPoll = std::chrono::milliseconds{1};

// Nobody asks: the ring itself knows whether it is lost. Windows may outlive their table.
std::atomic<bool> lost{false};

[[noreturn]] void fail(const std::string& ring) {
  throw Error{fmt::format("ring '{}': {}", ring, std::strerror(errno))};
}

}  // namespace

CardTable::CardTable(const broker::Ring& ring, const std::string& name) {
  object_ = shm_open(("/" + broker::object_name(name)).c_str(), O_RDWR | O_CLOEXEC, 0);
  if (object_ < 0) fail(name);
  header_ = reinterpret_cast<Header*>(map(nullptr, 0, sizeof(Header)));
  if (header_ == nullptr) {
    close(object_);
    fail(name);
  }
  // Another object of this name may have replaced that of the ring.
  layout_ = *header_;
  if (!broker::is_same_layout(
          layout_, broker::plan_layout(ring.map(), ring.map().to_toml(),
                                       static_cast<std::uint32_t>(layout_.journal_bits)))) {
    unmap(reinterpret_cast<std::byte*>(header_), sizeof(Header));
    close(object_);
    throw Error{fmt::format("ring '{}' was replaced while this program attached to it", name)};
  }
}

CardTable::~CardTable() {
  for (auto& base : mapped_)
    if (std::byte* address = base.load()) unmap(address, layout_.card_bytes);
  unmap(reinterpret_cast<std::byte*>(header_), sizeof(Header));
  close(object_);
}

// Takes a card that no process holds, or only a process that has ended.
bool CardTable::take_over(Card& card, broker::Claim self) const {
  broker::Claim holder = card.holder.load();
  if (holder == self) return true;
  if (members().has(holder)) return false;
  return card.holder.compare_exchange_strong(holder, self);
}

bool CardTable::wait_until_ready(const Card& card) const {
  for (const auto deadline = steady_clock::now() + kPowerUpTimeout;;) {
    if (card.ready.load() == kCardReady) return true;
    if (holder_of(card) == 0 || steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kPoll);
  }
}

std::uint64_t CardTable::in_use() const { return std::atomic_ref{header_->cards_in_use}.load(); }

bool CardTable::has_images() const { return std::atomic_ref{header_->is_replicated}.load() != 0; }

std::uint64_t CardTable::looks() const { return std::atomic_ref{header_->looks}.load(); }

std::optional<std::uint32_t> CardTable::take(std::uint32_t key, broker::Claim self) {
  for (std::uint32_t index = 0; index < count(); ++index)
    if (try_card(index, key, self)) return index;
  return std::nullopt;
}

// Processes take cards in order. A process that finds a card in power-up waits until its key is
// known, so that no key gets two cards.
bool CardTable::try_card(std::uint32_t index, std::uint32_t key, broker::Claim self) {
  const auto offset = static_cast<off_t>(layout_.cards_at + index * layout_.card_bytes);
  const auto bytes =
      static_cast<off_t>(broker::kCardRegisterBytes + broker::acr_bytes(layout_.memory_bytes));
  if (const int problem = posix_fallocate(object_, offset, bytes); problem != 0)
    throw Error{fmt::format("cannot reserve space for a card: {}", std::strerror(problem))};
  const CardView found = map_card(index);
  if (found.card == nullptr)
    throw Error{fmt::format("cannot map a card: {}", std::strerror(errno))};
  Card& card = *found.card;
  if (card.ready.load() != kCardReady) {
    if (take_over(card, self)) {
      power_up(card, index);
      card.key.store(key);
      card.ready.store(kCardReady);
      std::atomic_ref{header_->cards_in_use}.fetch_or(std::uint64_t{1} << index);
      return true;
    }
    if (!wait_until_ready(card))
      throw Error{fmt::format("card {} was not powered up by its process", index)};
  }
  if (card.key.load() != key) return false;
  const bool is_mine = card.holder.load() == self;
  if (!take_over(card, self)) return key != kAnonymous;
  if (!is_mine && card.is_copy.exchange(0) != 0) reset(index);  // of a gateway that was killed
  return true;
}

void CardTable::reset(std::uint32_t index) {
  const CardView found = map_card(index);
  power_up(*found.card, index);
  if (found.acr == nullptr) return;
  for (std::uint64_t i = 0; i < layout_.memory_bytes / 4; ++i)
    if (found.acr[i].load(std::memory_order_relaxed) != 0) found.acr[i].store(0);
}

CardTable::CardView CardTable::view(std::byte* base) const {
  if (base == nullptr) return {};
  const std::uint64_t acr = broker::acr_bytes(layout_.memory_bytes);
  auto* words = reinterpret_cast<Word*>(base + broker::kCardRegisterBytes);
  if (acr == 0) words = nullptr;
  return {reinterpret_cast<Card*>(base), words, words == nullptr ? nullptr : words + acr / 4};
}

// If several threads map the same card at once, the first mapping is kept.
CardTable::CardView CardTable::map_card(std::uint32_t index) const {
  std::byte* base = mapped_[index].load();
  if (base != nullptr) return view(base);
  std::byte* fresh =
      map(nullptr, layout_.cards_at + index * layout_.card_bytes, layout_.card_bytes);
  if (fresh == nullptr || mapped_[index].compare_exchange_strong(base, fresh)) return view(fresh);
  unmap(fresh, layout_.card_bytes);
  return view(base);
}

std::optional<CardTable::CardView> CardTable::at(std::uint32_t index) const {
  if (index >= count() || (in_use() >> index & 1) == 0) return std::nullopt;
  const CardView found = map_card(index);
  return found.card == nullptr ? std::nullopt : std::optional{found};
}

std::byte* CardTable::map(void* at, std::uint64_t offset, std::uint64_t bytes) const {
  const int flags = MAP_SHARED | (at == nullptr ? 0 : MAP_FIXED);
  void* address =
      mmap(at, bytes, PROT_READ | PROT_WRITE, flags, object_, static_cast<off_t>(offset));
  if (address == MAP_FAILED) return nullptr;
  auto* const begin = static_cast<std::byte*>(address);
  if (at == nullptr) broker::guard(begin, bytes, lost);  // otherwise the range is guarded
  return begin;
}

void CardTable::unmap(std::byte* address, std::uint64_t bytes) noexcept {
  broker::unguard(address);
  munmap(address, bytes);
}

std::byte* CardTable::map_memory(void* at, std::uint64_t offset, std::uint64_t bytes) const {
  return map(at, layout_.memory_at + offset, bytes);
}

std::byte* CardTable::map_acr(std::uint32_t index, void* at, std::uint64_t bytes) const {
  const std::uint64_t card = layout_.cards_at + index * layout_.card_bytes;
  return map(at, card + broker::kCardRegisterBytes, bytes);
}

bool CardTable::reserve_known(std::uint32_t index, std::uint32_t first_longword,
                              std::uint32_t longwords) const {
  const std::uint64_t card = layout_.cards_at + index * layout_.card_bytes;
  const std::uint64_t known =
      card + broker::kCardRegisterBytes + broker::acr_bytes(layout_.memory_bytes);
  return posix_fallocate(object_, static_cast<off_t>(known + std::uint64_t{first_longword} * 4),
                         static_cast<off_t>(std::uint64_t{longwords} * 4)) == 0;
}

void power_up(Card& card, std::uint32_t index) {
  Registers{card}.power_up(default_id(index));
  power_up_gt(card.gt);
}

}  // namespace rths::scramnet
