// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "card.hpp"

namespace rths::scramnet {

/// Card size for a size code in CSR8 [B], and the code of the largest card that fits into `bytes`.
[[nodiscard]] std::uint64_t bytes_of_size_code(std::uint32_t code) noexcept;
[[nodiscard]] std::uint32_t size_code_of(std::uint64_t bytes) noexcept;

/// The card's registers as seen on its bus: 16 bits, with the side effects of reading and writing.
/// Each access is atomic, several are not, as on the bus. No function waits.
class Registers {
 public:
  explicit Registers(Card& card) : plus_{&card.plus} {}

  /// Reads a register.
  /// @param nodes          number of nodes on the ring, for CSR3
  /// @param bypass_switch  whether CSR1 reports a fibre bypass switch
  [[nodiscard]] std::uint32_t read(int index, std::uint32_t nodes, bool bypass_switch);
  void write(int index, std::uint32_t value);

  /// The stored value, without side effects.
  [[nodiscard]] std::uint32_t peek(int index) const;
  [[nodiscard]] bool all_set(int index, std::uint32_t bits) const;
  /// Sets and clears bits of CSR0, 2, 8 or 9.
  void change(int index, std::uint32_t set, std::uint32_t clear);
  void latch(std::uint32_t csr1_bits) { plus_->latched.fetch_or(csr1_bits); }
  /// Sets the values after power-up, with this node id.
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
