// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/card/card.hpp>

namespace rths::scramnet {

/// Card size for a size code in CSR8 [B], and the code of the largest card that fits into `bytes`.
[[nodiscard]] std::uint64_t bytes_of_size_code(std::uint32_t code) noexcept;
[[nodiscard]] std::uint32_t size_code_of(std::uint64_t bytes) noexcept;

/// Network address of the card's first byte, as CSR12 selects it by virtual paging [B].
[[nodiscard]] std::uint64_t network_offset(std::uint32_t csr12_value) noexcept;

/// What the registers show of the card's other parts.
struct Surroundings {
  std::uint32_t nodes = 0;        ///< number of nodes on the ring, for CSR3
  bool bypass_switch = true;      ///< whether CSR1 reports a fibre bypass switch
  std::uint32_t live_status = 0;  ///< bits of CSR1 whose cause persists
};

/// Events that CSR13 counts, by the selection in CSR8 and CSR9.
enum class Counted { Errors, Triggers, Messages };

/// The card's registers as seen on its bus: 16 bits, with the side effects of reading and writing.
/// Each access is atomic, several are not, as on the bus. No function waits. The same code serves
/// the cards of a ring in shared memory and those of a ring in virtual time.
class Registers {
 public:
  explicit Registers(Card& card) : plus_{&card.plus} {}
  /// A card in virtual time. @param now_ns  time of its ring [ns]; must outlive this
  Registers(PlusCard& plus, const std::int64_t& now_ns) : plus_{&plus}, virtual_ns_{&now_ns} {}

  [[nodiscard]] std::uint32_t read(int index, const Surroundings& around);
  void write(int index, std::uint32_t value);

  /// The stored value, without side effects.
  [[nodiscard]] std::uint32_t peek(int index) const;
  [[nodiscard]] bool all_set(int index, std::uint32_t bits) const;
  void latch(std::uint32_t csr1_bits) { plus_->latched.fetch_or(csr1_bits); }
  /// Adds to CSR13 if it counts these events.
  void count(Counted events, std::uint32_t number = 1);
  /// True if CSR13 measures the time from the next own message to its return.
  [[nodiscard]] bool measures_transit() const;
  void set_counter(std::uint32_t value) { write_counter(value); }
  /// Trigger 2 clears a free-running counter of 1.706 µs.
  void clear_slow_counter();

  /// Outgoing interrupt bit of a word with this ACR: CSR0.1 and CSR0.8, and CSR0.9 or TIE.
  [[nodiscard]] bool sends_interrupt(std::uint32_t acr) const;
  /// Whether a message's word goes into the interrupt FIFO.
  /// @param acr  of the word on this card
  /// @param own  the message is this card's; then CSR2.9 and CSR2.10 decide, too
  /// @param bit  the message's interrupt bit
  [[nodiscard]] bool accepts_interrupt(std::uint32_t acr, bool own, bool bit) const;
  /// Delivers one host interrupt if the card is armed, has host interrupts enabled and one pending;
  /// then disarms it and counts it.
  [[nodiscard]] bool take_host_interrupt();
  /// Sets the values after power-up. @param id  of the node, 0 to 255
  void power_up(std::uint32_t id);
  void set_size_code(std::uint32_t code);

 private:
  [[nodiscard]] std::uint32_t read_status(const Surroundings& around);
  [[nodiscard]] std::int64_t now() const;
  [[nodiscard]] bool has_pending_interrupt() const;
  [[nodiscard]] std::uint32_t read_id(std::uint32_t nodes) const;
  [[nodiscard]] std::uint32_t read_counter();
  void write_id(std::uint32_t value);
  void write_control(std::uint32_t value);
  void write_extended(std::uint32_t value);
  void write_counter(std::uint32_t value);

  PlusCard* plus_;
  const std::int64_t* virtual_ns_ = nullptr;  ///< null: the host's clock
};

}  // namespace rths::scramnet
