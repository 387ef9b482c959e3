// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <ratio>
#include <vector>

#include <rths/core/ids.hpp>

namespace rths::replicated {

/// Virtual time, in ticks of 1/15 ns: a bit of SCRAMNet+ (150 Mbit/s) is 100 ticks, a bit of GT
/// (2.5 Gbit/s) is 6, a metre of fibre (5 ns) is 75. So every duration of the cards is exact.
using Time = std::chrono::duration<std::int64_t, std::ratio<1, 15'000'000'000>>;
[[nodiscard]] constexpr double to_ns(Time time) noexcept {
  return std::chrono::duration<double, std::nano>(time).count();
}
/// @param nanoseconds  rounded to a tick [ns]
[[nodiscard]] constexpr Time from_ns(double nanoseconds) noexcept {
  return Time{static_cast<Time::rep>(nanoseconds * 15 + (nanoseconds < 0 ? -0.5 : 0.5))};
}

enum class CardType { Plus, Gt };

/// One node, and the fibre from it to the next node.
struct NodeSetup {
  std::uint32_t id = 0;                    ///< node id after power-up, 0 to 255
  double fibre_m = 10;                     ///< length of fibre to the next node [m]
  std::uint64_t memory_bytes = 2U << 20U;  ///< memory of the card [B]; a card's size
  bool bypass_switch = true;               ///< optics close the ring past a node that is out of it
  Time extra_delay{0};                     ///< of a slow node, in addition to the card's own
};

struct RingSetup {
  CardType cards = CardType::Plus;
  std::vector<NodeSetup> nodes;  ///< in the direction of travel, 1 to 256
  /// Cards remove the messages of other nodes with their own id, as the hardware does. Otherwise
  /// such messages are counted and delivered.
  bool strict_ids = false;
  double bit_error_rate = 0;  ///< of each fibre [-]
  std::uint64_t seed = 1;     ///< of the bit errors
};

/// Fate of a host's store.
enum class Access {
  Queued,    ///< its message is in the transmit FIFO
  Local,     ///< in the card's own memory or ACR only
  Filtered,  ///< the data filter found the value unchanged
  Withheld,  ///< HIPRO waits for the other bytes of the longword
  HeldOff,   ///< the transmit FIFO is full: the host has to repeat the store
  Lost       ///< the transmit FIFO is full and holdoff is off: stored, but not sent
};

/// One event in the life of a message.
struct Hop {
  enum class Kind {
    Inserted,  ///< its node sends it
    Repeated,  ///< its node sends it again (PLATINUM)
    Passed,    ///< another node sends it on
    Stored,    ///< a card has received it
    Rejected,  ///< a card has received it damaged
    Removed,   ///< its node, or one of the same id, has taken it off the ring
    Expired,   ///< its age has run past 255
    Broken     ///< the ring is open here
  };
  Kind kind = Kind::Inserted;
  std::uint32_t node = 0;     ///< position of the node where it happens
  std::uint64_t message = 0;  ///< number of the message, from 1
  std::uint32_t origin = 0;   ///< position of the node that sent it
  ByteOffset address;         ///< on the ring, of its first longword
  std::uint32_t longwords = 0;
  std::uint32_t age = 0;
  Time begin{0};  ///< its first bit leaves the node; otherwise the time of the event
  Time end{0};    ///< its last bit leaves the node; otherwise the time of the event
};

/// An interrupt in the hardware queue of a GT card.
struct GtInterrupt {
  std::uint32_t type = 0, source = 0, id = 0, value = 0;
};

/// Levels and counts of a card, for tools and tests; no access changes them.
struct CardReport {
  bool powered = true;
  std::uint32_t transmit_fifo = 0;   ///< entries
  std::uint32_t interrupt_fifo = 0;  ///< entries; of a GT card: its interrupt queue
  std::uint64_t sent = 0, repeated = 0, stored = 0, rejected = 0, passed = 0;  ///< messages
  std::uint64_t same_id = 0;          ///< messages of other nodes with this card's id
  std::uint64_t host_interrupts = 0;  ///< delivered
  std::uint64_t lost_interrupts = 0;  ///< that found the FIFO or the queue full
  std::uint64_t triggers = 0;         ///< external trigger pulses
  std::uint32_t waiting = 0;          ///< messages of others in the insertion register
  std::uint32_t oldest_age = 0;       ///< greatest age of these
  std::uint32_t ring_nodes = 0;       ///< as the last own return showed; 0 before
  Time longest_delay{0};              ///< of a message that passed, first bit in to first bit out
};

class Engine;

/// The host's side of one card. Accesses take no time of their own and act at `Ring::now()`.
class Card {
 public:
  /// Stores 1, 2 or 4 bytes at an offset of the card's window, rounded down to their number. Beyond
  /// the memory a store has no effect and a read gives all ones.
  Access write(ByteOffset offset, std::uint32_t value, std::uint32_t bytes = 4);
  [[nodiscard]] std::uint32_t read(ByteOffset offset, std::uint32_t bytes = 4) const;

  /// Control/status registers, with their side effects. SCRAMNet+ only.
  [[nodiscard]] std::uint32_t read_csr(int index);
  void write_csr(int index, std::uint32_t value);
  /// The value that reading would give, without the side effects.
  [[nodiscard]] std::uint32_t peek_csr(int index) const;
  /// Auxiliary control RAM of a longword of the window. SCRAMNet+ only.
  [[nodiscard]] std::uint32_t acr(LongwordOffset longword) const;
  void set_acr(LongwordOffset longword, std::uint32_t bits);

  /// States as in the vendor's GT API; see scgtapi.h for numbers. GT only.
  [[nodiscard]] std::uint32_t gt_state(std::uint32_t state) const;
  bool set_gt_state(std::uint32_t state, std::uint32_t value);
  /// Control registers by byte offset. GT only.
  [[nodiscard]] std::uint32_t read_cr(std::uint32_t offset) const;
  void write_cr(std::uint32_t offset, std::uint32_t value);
  /// Queues an interrupt behind the stores so far. @param type  0: to node `id`; 1: broadcast `id`
  Access send_interrupt(std::uint32_t type, std::uint32_t id, std::uint32_t value);
  /// Takes the oldest interrupt of the card's queue.
  [[nodiscard]] std::optional<GtInterrupt> take_interrupt();

  /// Switches power: a card without power is out of the ring and loses its state.
  void set_power(bool on);
  void set_extra_delay(Time delay);
  /// Sets the id with which the card sends and receives.
  void set_id(std::uint32_t id);
  [[nodiscard]] CardReport report() const;

 private:
  friend class Ring;
  Card(Engine& engine, std::uint32_t node) : engine_{&engine}, node_{node} {}
  Engine* engine_;
  std::uint32_t node_;
};

/// A ring of cards in virtual time: one memory image per node, messages that travel hop by hop.
///
/// Deterministic: the same calls give the same hops. One thread. No call waits. After its first
/// messages the ring allocates no memory, except for pages of card memory that are written first.
class Ring {
 public:
  /// @throws Error if a setup is not possible   @setup
  explicit Ring(const RingSetup& setup);
  ~Ring();
  Ring(Ring&&) noexcept;
  Ring& operator=(Ring&&) noexcept;

  [[nodiscard]] std::uint32_t nodes() const;
  /// @pre node < nodes()
  [[nodiscard]] Card card(std::uint32_t node);

  [[nodiscard]] Time now() const;
  /// Advances to a time and processes everything until then, including that time.
  void run_until(Time time);
  /// Advances until no message is queued or under way. @returns false if the limit came first
  bool run_until_idle(Time limit);
  /// Time of the next event; empty if nothing is under way.
  [[nodiscard]] std::optional<Time> next_event() const;

  /// Cuts or repairs the fibre behind a node.
  void set_fibre(std::uint32_t node, bool connected);
  void set_bit_error_rate(double rate);

  /// Calls `observer` with each hop, in the order of processing.
  void observe(std::function<void(const Hop&)> observer);
  /// Number of hops (insertions and passages) so far, and a hash of all events of messages.
  [[nodiscard]] std::uint64_t hops() const;
  [[nodiscard]] std::uint64_t log_hash() const;

 private:
  friend class Images;
  std::unique_ptr<Engine> engine_;
};

}  // namespace rths::replicated
