// SPDX-License-Identifier: Apache-2.0
//
// The effect of an instruction on memory, registers and flags.
#include <rths/card/store_instruction.hpp>

namespace rths::scramnet {
namespace {

namespace flag {
constexpr std::uint64_t kCarry = 0x1, kParity = 0x4, kAdjust = 0x10, kZero = 0x40, kSign = 0x80,
                        kOverflow = 0x800;
constexpr std::uint64_t kResult = kParity | kZero | kSign;
constexpr std::uint64_t kAll = kResult | kCarry | kAdjust | kOverflow;
}  // namespace flag

std::uint64_t result_flags(std::uint64_t value, std::uint32_t width) {
  std::uint64_t parity = value & 0xFF;
  parity ^= parity >> 4, parity ^= parity >> 2, parity ^= parity >> 1;
  return ((parity & 1) == 0 ? flag::kParity : 0) | (value == 0 ? flag::kZero : 0) |
         (value >> (8 * width - 1) != 0 ? flag::kSign : 0);
}

// Flags of a sum: carries out of each bit, from the operands and the sum.
std::uint64_t carry_flags(std::uint64_t carries, std::uint32_t width) {
  const std::uint32_t top = 8 * width - 1;
  const std::uint64_t out = carries >> top & 1, into = carries >> (top - 1) & 1;
  return (out != 0 ? flag::kCarry : 0) | (out != into ? flag::kOverflow : 0) |
         ((carries & 8) != 0 ? flag::kAdjust : 0);
}

struct Sum {
  std::uint64_t value, flags;
};

Sum add(std::uint64_t a, std::uint64_t b, std::uint64_t carry, std::uint32_t width) {
  const std::uint64_t sum = (a + b + carry) & mask_of(width);
  return {sum, carry_flags((a & b) | ((a | b) & ~sum), width) | result_flags(sum, width)};
}

Sum subtract(std::uint64_t a, std::uint64_t b, std::uint64_t borrow, std::uint32_t width) {
  const std::uint64_t rest = (a - b - borrow) & mask_of(width);
  return {rest, carry_flags((~a & b) | ((~a | b) & rest), width) | result_flags(rest, width)};
}

// Sets the low `width` bytes of a register; 4 bytes clear the upper half.
void set_register(std::uint64_t& to, std::uint64_t value, std::uint32_t width) {
  to = width == 4 ? value & 0xFFFF'FFFF : (to & ~mask_of(width)) | (value & mask_of(width));
}

void set_operand(const StoreInstruction& store, std::uint64_t value, CpuState& cpu) {
  if (!store.high_byte) return set_register(cpu.general[store.source], value, store.width);
  std::uint64_t& to = cpu.general[store.source & 3];
  to = (to & ~std::uint64_t{0xFF00}) | (value & 0xFF) << 8;
}

}  // namespace

ReadModifyWrite modify(const StoreInstruction& store, std::uint64_t before,
                       const CpuState& cpu) noexcept {
  const std::uint32_t width = store.width;
  const std::uint64_t operand = store.operand, carry = cpu.flags & flag::kCarry;
  const auto with = [&](const Sum& sum, std::uint64_t changed = flag::kAll) {
    return ReadModifyWrite{sum.value, (cpu.flags & ~changed) | (sum.flags & changed), true};
  };
  const auto logical = [&](std::uint64_t value) {
    return with({value, result_flags(value, width)});
  };
  switch (store.kind) {
    case StoreKind::Add:
    case StoreKind::ExchangeAndAdd:
      return with(add(before, operand, 0, width));
    case StoreKind::AddWithCarry:
      return with(add(before, operand, carry, width));
    case StoreKind::Subtract:
      return with(subtract(before, operand, 0, width));
    case StoreKind::SubtractWithBorrow:
      return with(subtract(before, operand, carry, width));
    case StoreKind::Or:
      return logical(before | operand);
    case StoreKind::And:
      return logical(before & operand);
    case StoreKind::Xor:
      return logical(before ^ operand);
    case StoreKind::Increment:
      return with(add(before, 1, 0, width), flag::kAll & ~flag::kCarry);
    case StoreKind::Decrement:
      return with(subtract(before, 1, 0, width), flag::kAll & ~flag::kCarry);
    case StoreKind::Not:
      return {~before & mask_of(width), cpu.flags, true};
    case StoreKind::Negate:
      return with(subtract(0, before, 0, width));
    case StoreKind::CompareAndExchange: {
      const auto result = with(subtract(cpu.general[kRax] & mask_of(width), before, 0, width));
      return {operand, result.flags, (result.flags & flag::kZero) != 0};
    }
    default:  // Exchange
      return {operand, cpu.flags, true};
  }
}

void finish(const StoreInstruction& store, std::uint64_t before, const ReadModifyWrite& result,
            CpuState& cpu) noexcept {
  if (store.reads_memory()) cpu.flags = result.flags;
  if (store.kind == StoreKind::Exchange || store.kind == StoreKind::ExchangeAndAdd)
    set_operand(store, before, cpu);
  if (store.kind == StoreKind::CompareAndExchange && !result.stores)
    set_register(cpu.general[kRax], before, store.width);
  cpu.next += store.length;
}

void advance(const StoreInstruction& store, std::uint64_t elements, CpuState& cpu) noexcept {
  const std::uint64_t bytes = elements * store.width;
  const std::uint64_t step = ascends(cpu) ? bytes : -bytes;
  cpu.general[kRdi] += step;
  if (store.kind == StoreKind::Copy) cpu.general[kRsi] += step;
  if (store.repeated) cpu.general[kRcx] -= elements;
  if (!store.repeated || cpu.general[kRcx] == 0) cpu.next += store.length;
}

std::uint64_t elements_left(const StoreInstruction& store, const CpuState& cpu) noexcept {
  return store.repeated ? cpu.general[kRcx] : 1;
}

bool ascends(const CpuState& cpu) noexcept {
  constexpr std::uint64_t kDirection = 0x400;
  return (cpu.flags & kDirection) == 0;
}

}  // namespace rths::scramnet
