// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "card.hpp"

namespace rths::scramnet {

/// Bytes of the card that a size code in CSR8 stands for, and the code of the largest card that
/// fits into `bytes`.
[[nodiscard]] std::uint64_t bytes_of_size_code(std::uint32_t code) noexcept;
[[nodiscard]] std::uint32_t size_code_of(std::uint64_t bytes) noexcept;

/// The card's registers as a processor on its bus sees them: 16 bits, with the side effects of
/// reading and writing. Atomic each, not together, as on the bus. Nothing here waits.
class Registers {
 public:
  explicit Registers(Card& card) : plus_{&card.plus} {}

  /// @param nodes  on the ring, which CSR3 shows
  /// @param bypass_switch  which CSR1 shows
  [[nodiscard]] std::uint32_t read(int index, std::uint32_t nodes, bool bypass_switch);
  void write(int index, std::uint32_t value);

  /// What was last written: no side effects.
  [[nodiscard]] std::uint32_t peek(int index) const;
  [[nodiscard]] bool all_set(int index, std::uint32_t bits) const;
  /// Sets and clears bits of CSR0, 2, 8 or 9.
  void change(int index, std::uint32_t set, std::uint32_t clear);
  void latch(std::uint32_t csr1_bits) { plus_->latched.fetch_or(csr1_bits); }
  /// As when the card gets power, with the node id that it had been given.
  void power_up(std::uint32_t id);
  void set_size_code(std::uint32_t code);

 private:
  [[nodiscard]] std::uint32_t read_status(bool bypass_switch);
  [[nodiscard]] std::uint32_t read_id(std::uint32_t nodes) const;
  [[nodiscard]] std::uint32_t read_counter();
  void write_id(std::uint32_t value);
  void write_control(std::uint32_t value);
  void write_extended(std::uint32_t value);
  void write_counter(std::uint32_t value);

  PlusCard* plus_;
};

}  // namespace rths::scramnet
