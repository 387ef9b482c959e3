// SPDX-License-Identifier: Apache-2.0
#include <rths/replicated/ring.hpp>

#include <utility>

#include "engine.hpp"

namespace rths::replicated {

Ring::Ring(const RingSetup& setup) : engine_{std::make_unique<Engine>(setup)} {}
Ring::~Ring() = default;
Ring::Ring(Ring&&) noexcept = default;
Ring& Ring::operator=(Ring&&) noexcept = default;

std::uint32_t Ring::nodes() const { return static_cast<std::uint32_t>(engine_->nodes().size()); }
Card Ring::card(std::uint32_t node) { return Card{*engine_, node}; }
Time Ring::now() const { return engine_->now(); }
void Ring::run_until(Time time) { engine_->run_until(time); }
bool Ring::run_until_idle(Time limit) { return engine_->run_until_idle(limit); }
std::optional<Time> Ring::next_event() const {
  if (engine_->events().is_empty()) return std::nullopt;
  return engine_->events().first().time;
}
void Ring::set_fibre(std::uint32_t node, bool connected) { engine_->set_fibre(node, connected); }
void Ring::set_bit_error_rate(double rate) { engine_->set_bit_error_rate(rate); }
void Ring::observe(std::function<void(const Hop&)> observer) {
  engine_->observer = std::move(observer);
}
std::uint64_t Ring::hops() const { return engine_->hops; }
std::uint64_t Ring::log_hash() const { return engine_->log_hash; }

Access Card::write(ByteOffset offset, std::uint32_t value, std::uint32_t bytes) {
  return engine_->write(node_, offset.value(), value, bytes);
}
std::uint32_t Card::read(ByteOffset offset, std::uint32_t bytes) const {
  return engine_->read(node_, offset.value(), bytes);
}
std::uint32_t Card::read_csr(int index) { return engine_->read_csr(node_, index); }
std::uint32_t Card::peek_csr(int index) const { return engine_->peek_csr(node_, index); }
void Card::write_csr(int index, std::uint32_t value) { engine_->write_csr(node_, index, value); }
std::uint32_t Card::acr(LongwordOffset longword) const {
  const AcrCells& cells = engine_->nodes()[node_].acr;
  return longword.value() < cells.size() ? cells.get(longword.value()) : 0xFF;
}
void Card::set_acr(LongwordOffset longword, std::uint32_t bits) {
  engine_->set_acr(node_, longword.value(), bits);
}
std::uint32_t Card::gt_state(std::uint32_t state) const { return engine_->gt_state(node_, state); }
bool Card::set_gt_state(std::uint32_t state, std::uint32_t value) {
  return engine_->set_gt_state(node_, state, value);
}
std::uint32_t Card::read_cr(std::uint32_t offset) const { return engine_->read_cr(node_, offset); }
void Card::write_cr(std::uint32_t offset, std::uint32_t value) {
  engine_->write_cr(node_, offset, value);
}
Access Card::send_interrupt(std::uint32_t type, std::uint32_t id, std::uint32_t value) {
  FifoEntry entry;
  entry.address = id;
  entry.value = value;
  entry.content = type == 0 ? Content::Unicast : Content::Broadcast;
  return engine_->send_interrupt(node_, entry);
}
std::optional<GtInterrupt> Card::take_interrupt() {
  auto& queue = engine_->nodes()[node_].queue;
  if (queue.size() == 0) return std::nullopt;
  return queue.entries[queue.taken++ % kGtQueue];
}
void Card::set_power(bool on) { engine_->set_power(node_, on); }
void Card::set_extra_delay(Time delay) { engine_->nodes()[node_].extra_delay = delay; }
void Card::set_id(std::uint32_t id) {
  if (engine_->type() == CardType::Plus)
    engine_->write_csr(node_, 3, id << 8);
  else
    static_cast<void>(engine_->set_gt_state(node_, 0, id));
}
CardReport Card::report() const { return engine_->report(node_); }

}  // namespace rths::replicated
