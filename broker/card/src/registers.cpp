// SPDX-License-Identifier: Apache-2.0
#include <rths/card/registers.hpp>

#include <ctime>
#include <utility>

#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/monotonic_time.hpp>

namespace rths::scramnet {
namespace {

constexpr std::uint32_t kTimeout = 0x10;  // [240 ns]
constexpr std::int64_t kFastTickPs = 26'660, kSlowTickPs = 1'706'000;

// Card sizes by size code [B]; code 0: none.
constexpr std::uint64_t kSizes[]{0,        8U << 20,   4U << 20,   2U << 20,
                                 1U << 20, 512U << 10, 128U << 10, 4U << 10};

// Period of the counter [ps]; 0 in the modes that count events.
std::int64_t tick_ps(std::uint32_t csr8_value, std::uint32_t csr9_value) {
  if ((csr8_value & csr8::kFreeRun) == 0) return 0;
  if ((csr9_value & csr9::kCountErrors) != 0) return kFastTickPs;
  return (csr9_value & csr9::kCountTriggers) != 0 ? kSlowTickPs : 0;
}

}  // namespace

std::uint64_t bytes_of_size_code(std::uint32_t code) noexcept { return kSizes[code & 7]; }

std::uint32_t size_code_of(std::uint64_t bytes) noexcept {
  std::uint32_t code = 1;
  while (code < 7 && kSizes[code] > bytes) ++code;
  return code;
}

std::uint64_t network_offset(std::uint32_t csr12_value) noexcept {
  if ((csr12_value & csr12::kPaging) == 0) return 0;
  return std::uint64_t{csr12_value & csr12::kPageMask} << csr12::kPageShift;
}

std::uint32_t Registers::peek(int index) const {
  return index >= 0 && index < 16 ? plus_->csr[static_cast<std::size_t>(index)].load() : 0;
}

bool Registers::all_set(int index, std::uint32_t bits) const {
  return (peek(index) & bits) == bits;
}

std::int64_t Registers::now() const { return virtual_ns_ != nullptr ? *virtual_ns_ : now_ns(); }

std::uint32_t Registers::read(int index, const Surroundings& around) {
  switch (index) {
    case 1:
      return read_status(around);
    case 3:
      return read_id(around.nodes);
    case 4:
      return scramnet::pop(plus_->fifo).value_or(0) & 0xFFFC;
    case 5: {
      const auto oldest = scramnet::peek(plus_->fifo);
      if (!oldest) return 0;
      return csr5::kNotEmpty | ((*oldest & kRepeatedEntry) != 0 ? csr5::kRepeated : 0) |
             (*oldest >> 16 & 0x7F);
    }
    case 9:  // the self-test reads all ones
      return peek(9) | csr9::kSelfTest;
    case 13:
      return read_counter();
    default:
      return peek(index);
  }
}

// Reading clears the latched bits. The live bits remain: interrupts armed, bypass switch, and
// causes that persist.
std::uint32_t Registers::read_status(const Surroundings& around) {
  static_cast<void>(read_counter());
  return plus_->latched.exchange(0) | around.live_status |
         (plus_->armed.load() != 0 ? csr1::kArmed : 0) |
         (around.bypass_switch ? 0 : csr1::kNoBypassSwitch);
}

std::uint32_t Registers::read_id(std::uint32_t nodes) const {
  if (all_set(8, csr8::kIdMux)) return plus_->receive_id.load() << 8 | plus_->transmit_age.load();
  return peek(3) | (nodes & 0xFF);
}

std::uint32_t Registers::read_counter() {
  const std::int64_t tick = tick_ps(peek(8), peek(9));
  std::uint64_t count = plus_->counter.load();
  if (tick != 0)
    count += static_cast<std::uint64_t>((now() - plus_->counter_since_ns.load()) * 1000 / tick);
  if (count > 0xFFFF) {
    latch(csr1::kCounterOverflow);
    write_counter(static_cast<std::uint32_t>(count & 0xFFFF));
  }
  return static_cast<std::uint32_t>(count & 0xFFFF);
}

void Registers::write(int index, std::uint32_t value) {
  value &= 0xFFFF;
  switch (index) {
    case 0:
      return write_control(value);
    case 1:  // any value
      return plus_->armed.store(1);
    case 3:
      return write_id(value);
    case 5:
      return plus_->timeout.store(value);
    case 8:
      return write_extended(value);
    case 9:
      return plus_->csr[9].store(value & ~csr9::kSelfTest);
    case 13:
      return write_counter(value);
    case 2:
    case 10:
    case 11:
    case 12:
      return plus_->csr[static_cast<std::size_t>(index)].store(value);
    default:
      return;  // read-only, reserved or not a register
  }
}

void Registers::write_control(std::uint32_t value) {
  const std::uint32_t before = plus_->csr[0].exchange(value);
  if (((before | value) & csr0::kResetInterruptFifo) != 0) scramnet::clear(plus_->fifo);
}

void Registers::write_id(std::uint32_t value) {
  plus_->receive_id.store(value >> 8);
  if (all_set(8, csr8::kIdMux))
    plus_->transmit_age.store(value & 0xFF);
  else
    plus_->csr[3].store(value & 0xFF00);
}

void Registers::write_extended(std::uint32_t value) {
  const std::uint32_t fixed = (peek(8) & csr8::kSizeMask) | csr8::kAlwaysSet;
  if ((value & csr8::kResetAll) != 0) {
    const std::uint32_t id = peek(3) >> 8;
    power_up(id);
    plus_->csr[8].store((peek(8) & ~csr8::kSizeMask) | fixed);
    return;
  }
  write_counter(read_counter());
  plus_->csr[8].store((value & ~csr8::kSizeMask) | fixed);
}

void Registers::write_counter(std::uint32_t value) {
  plus_->counter_since_ns.store(now());
  plus_->counter.store(value);
}

void Registers::count(Counted events, std::uint32_t number) {
  const std::uint32_t mode = peek(9) & (csr9::kCountErrors | csr9::kCountTriggers);
  const std::uint32_t wanted = events == Counted::Errors ? 0
                               : events == Counted::Triggers
                                   ? csr9::kCountTriggers
                                   : csr9::kCountErrors | csr9::kCountTriggers;
  if (mode != wanted || (peek(8) & csr8::kFreeRun) != 0) return;
  plus_->counter.fetch_add(number);
  static_cast<void>(read_counter());
}

bool Registers::measures_transit() const {
  return (peek(9) & (csr9::kCountErrors | csr9::kCountTriggers)) == csr9::kCountErrors &&
         (peek(8) & csr8::kFreeRun) == 0;
}

void Registers::clear_slow_counter() {
  if (tick_ps(peek(8), peek(9)) == kSlowTickPs) write_counter(0);
}

bool Registers::sends_interrupt(std::uint32_t acr) const {
  return all_set(0, csr0::kTransmit | csr0::kSendInterrupts) &&
         (all_set(0, csr0::kAllSendInterrupts) || (acr & acr::kTransmitInterrupt) != 0);
}

bool Registers::accepts_interrupt(std::uint32_t acr, bool own, bool bit) const {
  if (own && !all_set(2, csr2::kReceiveOwn | csr2::kInterruptOwn)) return false;
  if (!bit && !all_set(8, csr8::kAllInterrupt)) return false;
  if (!all_set(0, csr0::kAllReceiveInterrupts) && (acr & acr::kReceiveInterrupt) == 0) return false;
  return all_set(0, csr0::kMemoryInterrupts);
}

// A memory interrupt is in the FIFO; an error interrupt is in CSR1, with the FIFO empty.
bool Registers::has_pending_interrupt() const {
  return scramnet::peek(plus_->fifo).has_value() ||
         (all_set(0, csr0::kErrorInterrupts) && (plus_->latched.load() & peek(9)) != 0);
}

bool Registers::take_host_interrupt() {
  if (!all_set(0, csr0::kHostInterrupts | csr0::kReceive) || !has_pending_interrupt()) return false;
  if (plus_->armed.exchange(0) == 0) return false;
  plus_->host_interrupts.fetch_add(1);
  return true;
}

void Registers::power_up(std::uint32_t id) {
  constexpr std::pair<std::size_t, std::uint32_t> kValues[] = {
      {2, 0xC040}, {8, 0x8800}, {9, 0x0021}, {10, 0x0001}, {11, 0x0080}, {15, 0x0020}};
  for (auto& csr : plus_->csr) csr.store(0);
  for (const auto& [csr, value] : kValues) plus_->csr[csr].store(value);
  plus_->csr[3].store(id << 8);
  plus_->receive_id.store(id);
  plus_->transmit_age.store(0);
  plus_->timeout.store(kTimeout);
  plus_->latched.store(0);
  plus_->armed.store(0);
  scramnet::clear(plus_->fifo);
  write_counter(0);
}

void Registers::set_size_code(std::uint32_t code) {
  plus_->csr[8].store((peek(8) & ~csr8::kSizeMask) | code << csr8::kSizeShift);
}

}  // namespace rths::scramnet
