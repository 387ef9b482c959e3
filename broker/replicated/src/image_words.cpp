// SPDX-License-Identifier: Apache-2.0
#include "image_state.hpp"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

namespace rths::replicated {

void Images::State::find_words() {
  for (const auto& partition : map.partitions()) {
    const std::uint32_t base = partition.base.value();
    words.resize(std::max<std::size_t>(words.size(), base + partition.longwords));
    WordUse use{position(partition.node), kNone};
    if (partition.tear_group) {
      use.group = static_cast<std::uint32_t>(groups.size());
      groups.push_back({TearGroupId{use.group}, base, partition.longwords});
    }
    std::fill_n(words.begin() + base, partition.longwords, use);
  }
}

void Images::State::take_stores(std::uint32_t at) {
  Image& image = images[at];
  if (!image.host || !image.present) return;
  take_trapped(at);
  if (image.plain) look(at);
  flush(at);
  broker::Write write;
  for (;;) {
    const auto followed = image.host->next(write);
    if (followed == broker::Followed::Nothing) break;
    if (followed == broker::Followed::Lost) {
      events.push_back(fmt::format("{}: writes were lost before the cards took them", image.node));
      continue;
    }
    const std::uint32_t longword = write.offset.value();
    if (write.group.empty()) {
      store(at, {longword * 4, write.value});
      continue;
    }
    for (std::uint32_t i = 0; i < write.group.size(); ++i)
      store(at, {(longword + i) * 4, write.group[i]});
  }
  send_trapped(at);
}

// The image has the addresses of the ring; the card's window may be a page of it.
Access Images::State::write(std::uint32_t at, Store store) {
  const std::uint64_t begin_of_window = window(at);
  if (store.offset < begin_of_window) return Access::Local;
  return cards.card(at).write(
      ByteOffset{static_cast<std::uint32_t>(store.offset - begin_of_window)}, store.value,
      store.bytes);
}

std::uint64_t Images::State::window(std::uint32_t at) {
  return scramnet::network_offset(cards.card(at).peek_csr(12));
}

void Images::State::store(std::uint32_t at, Store store) {
  images[at].waiting.push_back(store);
  flush(at);
}

// A host that is held off on hardware repeats its access; here its later writes wait.
void Images::State::flush(std::uint32_t at) {
  auto& waiting = images[at].waiting;
  while (!waiting.empty()) {
    const Store store = waiting.front();
    const auto access = write(at, store);
    if (access == Access::HeldOff) {
      ++stalls;
      return;
    }
    waiting.pop_front();
  }
}

void Images::State::arrive(const Hop& hop) {
  const CardNode& card = cards.engine_->nodes()[hop.node];
  const std::uint64_t begin_of_window = window(hop.node);
  for (std::uint32_t i = 0; i < hop.longwords; ++i) {
    const std::uint64_t address = hop.address.value() + std::uint64_t{4} * i;
    const std::uint64_t offset = address - begin_of_window;
    if (address < begin_of_window || offset >= card.memory.size()) continue;
    arrive(hop.node, hop.origin, static_cast<std::uint32_t>(address / 4),
           card.memory.get<std::uint32_t>(offset));
  }
}

void Images::State::arrive(std::uint32_t at, std::uint32_t origin, std::uint32_t longword,
                           std::uint32_t value) {
  Image& image = images[at];
  const std::uint32_t owner = owner_of(longword);
  if (owner == at && image.plain) {
    image.watch->store(image.node, LongwordOffset{longword}, value);
    return ignore_journal(image);
  }
  if (owner != origin || at == origin) return store_unjournalled(image, longword, value);
  broker::Node* const node = stand_in(at, origin);
  if (node == nullptr) return;
  image.received[origin] = 1;
  if (words[longword].group == kNone) {
    static_cast<void>(node->write(LongwordOffset{longword}, value));
    return;
  }
  const GroupUse& group = groups[words[longword].group];
  const SparseBytes& memory = cards.engine_->nodes()[at].memory;
  const std::uint64_t begin_of_window = window(at), end_of_window = begin_of_window + memory.size();
  const auto is_visible = [&](std::uint32_t i) {
    const std::uint64_t address = (group.base + i) * std::uint64_t{4};
    return address >= begin_of_window && address < end_of_window;
  };
  const std::uint32_t position_in_group = longword - group.base;
  if (position_in_group + 1 < group.longwords && is_visible(position_in_group + 1)) return;
  group_words.clear();
  for (std::uint32_t i = 0; i < group.longwords; ++i)
    group_words.push_back(is_visible(i) ? memory.get<std::uint32_t>(
                                              (group.base + i) * std::uint64_t{4} - begin_of_window)
                                        : node->read(LongwordOffset{group.base + i}));
  static_cast<void>(node->write_group(group.id, group_words));
}

// As on a ring in shared memory, a store into another node's word is in no journal.
void Images::State::store_unjournalled(Image& image, std::uint32_t longword, std::uint32_t value) {
  std::atomic_ref{image.carrier.plain_memory()[longword]}.store(value, std::memory_order_release);
}

broker::Node* Images::State::stand_in(std::uint32_t at, std::uint32_t origin) {
  auto& node = images[at].others[origin];
  if (!node && images[origin].present) node.emplace(images[at].ring.join(images[origin].node, 0));
  return node ? &*node : nullptr;
}

}  // namespace rths::replicated
