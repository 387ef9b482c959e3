// SPDX-License-Identifier: Apache-2.0
#include <rths/card/shared_cards.hpp>

#include <algorithm>

#include <rths/card/bits.hpp>
#include <rths/card/card_table.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/gt_registers.hpp>

namespace rths::scramnet {
namespace {

SharedCard view_of(std::uint32_t index, const CardTable::CardView& mapped, broker::Claim holder) {
  const Card& card = *mapped.card;
  SharedCard view;
  view.index = index;
  view.gt = mapped.acr == nullptr;
  view.id = view.gt ? node_id(card.gt) : card.plus.csr[3].load() >> 8 & 0xFF;
  view.process = holder == 0 ? "" : broker::in_words(holder);
  for (std::size_t csr = 0; csr < view.csr.size(); ++csr)
    view.csr[csr] = card.plus.csr[csr].load() & 0xFFFF;
  view.csr[1] =
      (card.plus.latched.load() & 0xFFFF) | (card.plus.armed.load() != 0 ? csr1::kArmed : 0U);
  view.interrupt_fifo = std::min(size(card.plus.fifo), kFifoEntries);
  view.host_interrupts = card.plus.host_interrupts.load();
  if (card.carried.active.load() == 0) return view;
  view.csr[1] |= card.carried.live_status.load();
  view.carried = {.transmit_fifo = card.carried.transmit_fifo.load(),
                  .ring_nodes = card.carried.ring_nodes.load(),
                  .sent = card.carried.sent.load(),
                  .stored = card.carried.stored.load(),
                  .rejected = card.carried.rejected.load(),
                  .same_id = card.carried.same_id.load()};
  return view;
}

}  // namespace

std::vector<SharedCard> cards_of(const std::string& name) {
  const broker::Ring ring = broker::Ring::attach(name);
  const CardTable cards{ring, name};
  std::vector<SharedCard> views;
  for (std::uint32_t index = 0; index < cards.count(); ++index)
    if (const auto card = cards.at(index))
      views.push_back(view_of(index, *card, cards.holder_of(*card->card)));
  return views;
}

}  // namespace rths::scramnet
