// SPDX-License-Identifier: Apache-2.0
//
// Stores that the traps of a host have taken. A scan leaves their words to them, so that each store
// is sent once.
#include <algorithm>

#include <rths/card/bits.hpp>
#include <rths/card/trap_queue.hpp>

#include "image_state.hpp"

namespace rths::replicated {
namespace {

// Of a host between announcing a store and publishing it: then it is dead or stopped.
constexpr Time kLongestTrapTime = std::chrono::milliseconds{100};

}  // namespace

bool Images::State::gives_up(Trapped& trapped, std::uint32_t entry) {
  if (trapped.unpublished != entry) trapped.since = cards.now();
  trapped.unpublished = entry;
  return cards.now() - trapped.since > kLongestTrapTime;
}

// A host that is held off keeps its entries; when there is no space for more, it waits.
void Images::State::take_trapped(std::uint32_t at) {
  scramnet::Card* const shared = cards.engine_->nodes()[at].shared;
  if (shared == nullptr) return;
  Image& image = images[at];
  image.trapped.earlier.swap(image.trapped.found);
  image.trapped.found.clear();
  if (!image.waiting.empty()) return;
  scramnet::TrapQueue& queue = shared->carried.traps;
  const std::uint32_t first = queue.taken.load();
  std::uint32_t n = first;
  for (; n != queue.reserved.load() && n - first < scramnet::kTrapEntries; ++n) {
    const scramnet::TrapEntry& entry = scramnet::entry_of(queue, n);
    if (entry.stamp.load() != scramnet::published(n)) {
      if (gives_up(image.trapped, n)) continue;
      break;
    }
    const std::uint32_t form = entry.form.load();
    const Store store{entry.address.load(), entry.value.load(), form & 0xFF,
                      (form & scramnet::kTrapInMemory) != 0};
    const bool valid = store.bytes == 1 || store.bytes == 2 || store.bytes == 4;
    if (valid && store.offset % store.bytes == 0 &&
        store.longword() < map.description().size_longwords)
      image.trapped.found.push_back(store);
  }
  queue.taken.store(n);
}

void Images::State::look(std::uint32_t at) {
  static_cast<void>(
      images[at].watch->look([&](LongwordOffset offset) { return judge(at, offset.value()); }));
}

// A word that differs from the journals. One that a trap has stored has the trap's value: two
// threads may have stored to the memory in another order than their entries have.
broker::Judgement Images::State::judge(std::uint32_t at, std::uint32_t longword) {
  using broker::Judgement;
  scramnet::Card* const shared = cards.engine_->nodes()[at].shared;
  const auto has = [&](const std::vector<Store>& stores) {
    return std::any_of(stores.begin(), stores.end(), [&](const Store& store) {
      return store.in_memory && store.longword() == longword;
    });
  };
  if (scramnet::may_change(shared->carried.traps, longword) || has(images[at].trapped.found))
    return Judgement::Leave;
  return has(images[at].trapped.earlier) ? Judgement::Restore : Judgement::Take;
}

void Images::State::send_trapped(std::uint32_t at) {
  Image& image = images[at];
  if (image.trapped.found.empty()) return;
  for (const Store& trapped : image.trapped.found) {
    if (trapped.in_memory && image.plain && owner_of(trapped.longword()) == at)
      image.watch->take(image.node, LongwordOffset{trapped.longword()},
                        {trapped.value, trapped.offset % 4, trapped.bytes});
    store(at, trapped);
  }
  ignore_journal(image);
}

// What the watch has journalled on the node's behalf for others, and the cards have already.
void Images::State::ignore_journal(Image& image) {
  broker::Write write;
  while (image.host->next(write) == broker::Followed::Write) {
  }
}

// In write-me-last, own messages come back into a memory that the host's stores do not change.
bool Images::State::writes_last(std::uint32_t at) {
  const scramnet::Card* const shared = cards.engine_->nodes()[at].shared;
  return shared != nullptr && shared->carried.has_traps.load() != 0 && images[at].plain &&
         (cards.card(at).peek_csr(2) & scramnet::csr2::kNoHostWrite) != 0;
}

}  // namespace rths::replicated
