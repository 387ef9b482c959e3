// SPDX-License-Identifier: Apache-2.0
#include "cards.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

#include <rths/card/bits.hpp>
#include <rths/card/gt_queue.hpp>
#include <rths/card/gt_registers.hpp>
#include <rths/core/error.hpp>

namespace rths::dds {
namespace {

using scramnet::QueuedInterrupt;
using scramnet::Word;

// The first word of a message.
enum MessageKind : std::uint32_t {
  kRegisters = 1,      ///< the registers, in the order of registers_of
  kInterruptingWords,  ///< range of the memory; first and length of each run with TIE in it
  kGtInterrupt,        ///< node that it is for, type, source, id, value
};

constexpr std::array<std::size_t, 4> kCopiedRegisters{0, 2, 3, 8};  // of a SCRAMNet+ card
constexpr std::size_t kMostWords = 2000;                            // of a message
constexpr Duration kWatchIsGone = std::chrono::seconds{3};

// Registers that other cards react to, and the count of changes of the ACR.
CardMessage registers_of(const scramnet::Card& card) {
  CardMessage message{kRegisters};
  for (const auto index : kCopiedRegisters) message.push_back(card.plus.csr[index].load());
  message.push_back(card.gt.cr[scramnet::gt::kLinkControl].load());
  message.push_back(card.plus.acr_changes.load());
  return message;
}

// The runs of words with TIE, in messages that together cover the memory.
void append_interrupting_words(const Word* acr, std::uint32_t longwords,
                               std::vector<CardMessage>& messages) {
  CardMessage message{kInterruptingWords, 0, longwords};
  for (std::uint32_t word = 0; word < longwords; ++word) {
    if ((acr[word].load(std::memory_order_relaxed) & scramnet::acr::kTransmitInterrupt) == 0)
      continue;
    if (message.size() > 3 && word == *(message.end() - 2) + message.back()) {
      ++message.back();
      continue;
    }
    if (message.size() >= kMostWords) {
      message[2] = word;
      messages.push_back(std::exchange(message, {kInterruptingWords, word, longwords}));
    }
    message.insert(message.end(), {word, 1});
  }
  messages.push_back(std::move(message));
}

NodeId node_of(std::uint32_t key) { return NodeId{static_cast<std::uint16_t>(key)}; }

}  // namespace

Cards::Cards(const broker::Ring& ring, const std::string& name)
    : table_{ring, name}, looks_{table_.looks()} {}

Cards::~Cards() {
  while (!copies_.empty()) release(copies_.begin()->first);
}

std::optional<Cards::CardView> Cards::card_of(NodeId node) const {
  for (std::uint32_t index = 0; index < table_.count(); ++index)
    if (const auto view = table_.at(index);
        view && view->card->key.load() == (scramnet::kNamed | node.value()))
      return view;
  return std::nullopt;
}

void Cards::append_words(const CardView& view, std::vector<CardMessage>& messages) const {
  if (view.acr != nullptr)
    append_interrupting_words(view.acr, static_cast<std::uint32_t>(table_.memory_bytes() / 4),
                              messages);
}

std::vector<CardMessage> Cards::state_of(NodeId node) {
  const auto view = card_of(node);
  if (!view) return {};
  std::vector<CardMessage> messages{registers_of(*view->card)};
  append_words(*view, messages);
  return messages;
}

std::vector<CardMessage> Cards::changes_of(NodeId node) {
  const auto view = card_of(node);
  if (!view) return {};
  std::vector<CardMessage> messages{registers_of(*view->card)};
  const std::lock_guard lock{mutex_};
  auto& sent = sent_[node];
  if (messages[0] == sent) return {};
  const bool same_words = !sent.empty() && messages[0].back() == sent.back();
  sent = messages[0];
  if (!same_words) append_words(*view, messages);
  return messages;
}

// The copies accept every interrupt: the card itself decides, on its host.
Cards::Copy& Cards::copy_of(NodeId node) {
  if (const auto found = copies_.find(node); found != copies_.end()) return found->second;
  const broker::Claim self = broker::own_claim();
  const auto index = table_.take(scramnet::kNamed | node.value(), self);
  const auto view = index ? table_.at(*index) : std::nullopt;
  if (!view) throw Error{"all cards of the ring are in use"};
  if (const auto holder = view->card->holder.load(); holder != self)  // a named card is shared
    throw Error{fmt::format("{} has the card", broker::in_words(holder))};
  view->card->is_copy.store(1);
  auto& gt = view->card->gt;
  gt.cr[scramnet::gt::kBroadcastMask].store(0xFFFF'FFFF);
  gt.cr[scramnet::gt::kUnicastMask].store(1);
  return copies_.emplace(node, Copy{*index, *view, gt.tail.load()}).first->second;
}

void Cards::release(NodeId node) {
  const std::lock_guard lock{mutex_};
  const auto copy = copies_.find(node);
  if (copy == copies_.end()) return;
  hold(node, copy->second);
  lost_ += static_cast<std::uint64_t>(
      std::erase_if(held_, [&](const Held& held) { return held.interrupt.to == node; }));
  auto& card = *copy->second.view.card;
  table_.reset(copy->second.index);
  card.is_copy.store(0);
  broker::Claim self = broker::own_claim();
  card.holder.compare_exchange_strong(self, 0);
  copies_.erase(copy);
}

bool Cards::apply(NodeId node, std::span<const std::uint32_t> message) {
  const std::lock_guard lock{mutex_};
  if (message.empty()) return false;
  switch (message[0]) {
    case kRegisters:
      return set_registers(node, message.subspan(1));
    case kInterruptingWords:
      return set_interrupting_words(node, message.subspan(1));
    case kGtInterrupt:
      return deliver(message.subspan(1));
    default:
      return false;
  }
}

bool Cards::set_registers(NodeId node, std::span<const std::uint32_t> values) {
  if (values.size() != kCopiedRegisters.size() + 2) return false;
  auto& card = *copy_of(node).view.card;
  for (std::size_t i = 0; i < kCopiedRegisters.size(); ++i)
    card.plus.csr[kCopiedRegisters[i]].store(values[i] & 0xFFFF);
  card.gt.cr[scramnet::gt::kLinkControl].store(values[kCopiedRegisters.size()] |
                                               scramnet::gt::kReceive);
  return true;
}

bool Cards::set_interrupting_words(NodeId node, std::span<const std::uint32_t> values) {
  Word* const acr = copy_of(node).view.acr;
  const auto longwords = static_cast<std::uint32_t>(table_.memory_bytes() / 4);
  if (acr == nullptr || values.size() < 2 || values.size() % 2 != 0) return false;
  if (values[0] > values[1] || values[1] > longwords) return false;
  std::uint32_t next = values[0];
  const auto clear_until = [&](std::uint32_t end) {
    for (; next < end; ++next)
      if (acr[next].load(std::memory_order_relaxed) != 0) acr[next].store(0);
  };
  for (std::size_t i = 2; i < values.size(); i += 2) {
    const std::uint32_t begin = values[i], length = values[i + 1];
    if (begin < next || begin > values[1] || length > values[1] - begin) return false;
    clear_until(begin);
    for (; next < begin + length; ++next) acr[next].store(scramnet::acr::kTransmitInterrupt);
  }
  clear_until(values[1]);
  return true;
}

bool Cards::deliver(std::span<const std::uint32_t> values) {
  if (values.size() != 5 || values[0] > 0xFFFF) return false;
  const NodeId node = node_of(values[0]);
  const auto view = card_of(node);
  if (!view || copies_.contains(node)) return true;  // for another host
  const QueuedInterrupt interrupt{values[1], values[2], values[3], values[4]};
  auto& gt = view->card->gt;
  if (accepts(gt, interrupt.type, interrupt.id) &&
      push(gt, interrupt, broker::own_claim(), table_.members()))
    gt.counts[scramnet::kReceived].fetch_add(1);
  return true;
}

std::optional<NodeId> Cards::node_with_gt_id(std::uint32_t id) const {
  for (std::uint32_t index = 0; index < table_.count(); ++index) {
    const auto view = table_.at(index);
    if (!view || scramnet::node_id(view->card->gt) != id) continue;
    const std::uint32_t key = view->card->key.load();
    const bool is_local = (key & scramnet::kNamed) != 0 && !copies_.contains(node_of(key));
    if (is_local) return node_of(key);
  }
  return std::nullopt;
}

// The data of an interrupt were stored before it. They are in the journals after the first look
// that begins now or later; one may be in progress.
void Cards::hold(NodeId to, Copy& copy) {
  const auto& gt = copy.view.card->gt;
  const std::uint64_t tail = gt.tail.load(), look = table_.looks() + 2;
  if (tail < copy.position) copy.position = tail;  // a damaged queue
  if (tail - copy.position > scramnet::kKeptInterrupts) {
    lost_ += tail - scramnet::kKeptInterrupts - copy.position;
    copy.position = tail - scramnet::kKeptInterrupts;
  }
  for (; copy.position < tail; ++copy.position) {
    QueuedInterrupt found;
    if (!read(gt, copy.position, found)) {
      ++lost_;
      continue;
    }
    held_.push_back({{node_with_gt_id(found.source),
                      to,
                      {kGtInterrupt, to.value(), found.type, found.source, found.id, found.value}},
                     look});
  }
}

std::uint64_t Cards::take_interrupts(TimePoint now, std::vector<Interrupt>& taken) {
  const std::lock_guard lock{mutex_};
  for (auto& [node, copy] : copies_) hold(node, copy);
  if (const std::uint64_t looks = table_.looks(); looks != looks_) {
    looks_ = looks;
    looked_ = now;
  }
  const bool is_watched = looked_ != TimePoint{0} && now - looked_ < kWatchIsGone;
  while (!held_.empty() && (!is_watched || looks_ >= held_.front().look)) {
    taken.push_back(std::move(held_.front().interrupt));
    held_.pop_front();
  }
  return std::exchange(lost_, 0);
}

}  // namespace rths::dds
