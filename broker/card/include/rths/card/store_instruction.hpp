// SPDX-License-Identifier: Apache-2.0
//
// Instructions of x86-64 that store to memory, for traps.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace rths::scramnet {

inline constexpr std::size_t kLongestInstruction = 15;  // [B]

/// General registers in the order of their numbers in instructions: rax, rcx, rdx, rbx, rsp, rbp,
/// rsi, rdi, r8 to r15; and the flags.
struct CpuState {
  std::array<std::uint64_t, 16> general{};
  std::uint64_t flags = 0;
  std::uint64_t next = 0;  ///< address of the instruction
};

inline constexpr std::uint32_t kRax = 0, kRcx = 1, kRsi = 6, kRdi = 7;  ///< numbers

/// The low bytes of a register.
[[nodiscard]] constexpr std::uint64_t mask_of(std::uint32_t width) noexcept {
  return width >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * width) - 1;
}

enum class StoreKind : std::uint8_t {
  Move,    ///< from a register or an immediate value
  Vector,  ///< from an XMM or YMM register
  Fill,    ///< STOS
  Copy,    ///< MOVS
  // The others read the memory first.
  Add,
  Or,
  AddWithCarry,
  SubtractWithBorrow,
  And,
  Subtract,
  Xor,
  Increment,
  Decrement,
  Not,
  Negate,
  Exchange,
  ExchangeAndAdd,
  CompareAndExchange,
};

struct StoreInstruction {
  StoreKind kind = StoreKind::Move;
  std::uint32_t length = 0;        ///< of the instruction [B]
  std::uint32_t width = 0;         ///< of the store, or of one element of Fill and Copy [B]
  std::uint64_t address = 0;       ///< first byte of the store
  std::uint64_t operand = 0;       ///< value of register or immediate; of Copy: address to read
  std::uint32_t source = 0;        ///< number of the general or vector register
  std::uint32_t vector_begin = 0;  ///< first byte of the vector register
  bool high_byte = false;          ///< the register is AH, CH, DH or BH
  bool repeated = false;           ///< Fill and Copy: RCX times

  [[nodiscard]] bool reads_memory() const { return kind >= StoreKind::Add; }
};

/// Decodes one instruction that stores to memory. Reads nothing but its arguments.
/// @param code  at most kLongestInstruction bytes from the address of the instruction
/// @returns empty for any other instruction, one with a segment of its own, and one that is not
///          complete   @any_thread
[[nodiscard]] std::optional<StoreInstruction> decode_store(std::span<const std::uint8_t> code,
                                                           const CpuState& cpu) noexcept;

/// Result of an instruction that reads the memory first.
struct ReadModifyWrite {
  std::uint64_t stored = 0;
  std::uint64_t flags = 0;
  bool stores = true;  ///< false: a comparison failed
};
/// @param before  value in memory
[[nodiscard]] ReadModifyWrite modify(const StoreInstruction& store, std::uint64_t before,
                                     const CpuState& cpu) noexcept;
/// Puts the registers into their state behind the instruction, unless it is Fill or Copy.
/// @param before, result  of one that reads the memory first
void finish(const StoreInstruction& store, std::uint64_t before, const ReadModifyWrite& result,
            CpuState& cpu) noexcept;
/// Puts the registers into their state behind elements of Fill or Copy.
/// @pre not more than are left
void advance(const StoreInstruction& store, std::uint64_t elements, CpuState& cpu) noexcept;
/// Elements that are left of Fill or Copy; upwards in memory if `ascends`.
[[nodiscard]] std::uint64_t elements_left(const StoreInstruction& store,
                                          const CpuState& cpu) noexcept;
[[nodiscard]] bool ascends(const CpuState& cpu) noexcept;

}  // namespace rths::scramnet
