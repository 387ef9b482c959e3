// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <rths/card/gt_registers.hpp>
#include <rths/replicated/ring.hpp>

#include "events.hpp"
#include "message.hpp"
#include "node.hpp"

namespace rths::replicated {

/// Durations of a card's line. A message of n longwords takes `header + n * longword`; the line is
/// idle for `gap` before the next one.
struct Rates {
  Time header, longword, gap;
  Time node_delay;  ///< from the first bit in to the first bit out, if the line is free
  Time insertion;   ///< from the host's store to the first bit out, if the line is free

  [[nodiscard]] constexpr Time message(std::uint32_t longwords) const {
    return header + longwords * longword;
  }
};

inline constexpr Time kBit{100};  ///< at 150 Mbit/s
inline constexpr Time kByte{60};  ///< of GT: 10 bits on the line (8B/10B) at 2.5 Gbit/s

// SCRAMNet+: start bit, source, age, flags and address with a parity bit per byte are 46 bits; a
// longword with its parity is 36 bits (SC150e Hardware Reference §2.4). 37 bits are the manual's
// smallest node delay of 247 ns. The gap is inferred: the manual gives no gap, but 6.5 MB/s are 92
// bits per basic message of 82 bits. 10 bits are the start bit and a byte with parity.
inline constexpr Rates kPlusRates{.header = 46 * kBit,
                                  .longword = 36 * kBit,
                                  .gap = 10 * kBit,
                                  .node_delay = 37 * kBit,
                                  .insertion = Time{0}};

// GT: both delays are the manual's (GT200 Hardware Reference, App. A). Its frame has no published
// layout. 26 bytes of delimiters, header, CRC and idle are inferred: with them both published
// rates, of 4-byte and of 128-byte frames, are met within 1.1 %.
inline constexpr Rates kGtRates{.header = 22 * kByte,
                                .longword = 4 * kByte,
                                .gap = 4 * kByte,
                                .node_delay = std::chrono::nanoseconds{450},
                                .insertion = std::chrono::nanoseconds{350}};

inline constexpr Time kTimeoutUnit = 36 * kBit;  ///< of CSR5: 240 ns
inline constexpr Time kTransitTick = 4 * kBit;   ///< of CSR13 as a timer: 26.67 ns
inline constexpr std::uint32_t kShortBlock = 64, kLongBlock = 256;  ///< PLUS [longwords]
inline constexpr std::uint32_t kGtBlock = 32;                       ///< [longwords]
inline constexpr std::uint32_t kLastAge = 255;

/// The ring: nodes, messages and events. Parts: engine.cpp the messages' way, transmitter.cpp own
/// messages, receiver.cpp the effect of received ones, plus_host.cpp and gt_host.cpp the host's
/// side.
class Engine {
 public:
  explicit Engine(const RingSetup& setup);

  [[nodiscard]] Time now() const { return now_; }
  void run_until(Time time);
  bool run_until_idle(Time limit);
  [[nodiscard]] const EventQueue& events() const { return events_; }
  [[nodiscard]] std::vector<CardNode>& nodes() { return nodes_; }
  [[nodiscard]] CardType type() const { return type_; }

  Access write(std::uint32_t node, std::uint32_t offset, std::uint32_t value, std::uint32_t bytes);
  [[nodiscard]] std::uint32_t read(std::uint32_t node, std::uint32_t offset, std::uint32_t bytes);
  [[nodiscard]] std::uint32_t read_csr(std::uint32_t node, int index);
  [[nodiscard]] std::uint32_t peek_csr(std::uint32_t node, int index);
  void write_csr(std::uint32_t node, int index, std::uint32_t value);
  void set_acr(std::uint32_t node, std::uint32_t longword, std::uint32_t bits);
  [[nodiscard]] std::uint32_t gt_state(std::uint32_t node, std::uint32_t state);
  bool set_gt_state(std::uint32_t node, std::uint32_t state, std::uint32_t value);
  [[nodiscard]] std::uint32_t read_cr(std::uint32_t node, std::uint32_t offset);
  void write_cr(std::uint32_t node, std::uint32_t offset, std::uint32_t value);
  Access send_interrupt(std::uint32_t node, const FifoEntry& interrupt);

  /// Uses a card in the object of an image, whose host is another process, one of `members`.
  void share(std::uint32_t node, scramnet::Card& card, scramnet::Word* acr,
             broker::Members members);
  /// Takes what that host has done to its registers, and shows it the state of the card.
  void exchange(std::uint32_t node);
  /// Time of the registers at time 0 of the ring [ns]; by default 0.
  void set_clock(std::int64_t origin_ns) { clock_origin_ns_ = origin_ns; }
  void power_up(std::uint32_t node);
  void set_power(std::uint32_t node, bool on);
  void set_fibre(std::uint32_t node, bool connected);
  void set_bit_error_rate(double rate) { bit_error_rate_ = rate; }
  [[nodiscard]] CardReport report(std::uint32_t node);

  std::function<void(const Hop&)> observer;
  std::uint64_t hops = 0, log_hash = 0xCBF2'9CE4'8422'2325;

 private:
  // The way of messages.
  void process(const Event& event);
  void on_head(std::uint32_t message, std::uint32_t at);
  void pass_optically(std::uint32_t message, std::uint32_t at);
  void forward(std::uint32_t message, std::uint32_t at);
  [[nodiscard]] bool own_goes_first(CardNode& node, Time ready) const;
  void drain(std::uint32_t at);
  void put_on_line(std::uint32_t message, std::uint32_t at, Time start);
  void send_to_next(std::uint32_t message, std::uint32_t from, Time start);
  void close(std::uint32_t message);
  void expect_reception(std::uint32_t message, std::uint32_t at);
  void damage(Message& message);
  void end_head(std::uint32_t message);
  void release_if_done(std::uint32_t message);
  [[nodiscard]] std::uint32_t behind(std::uint32_t node) const;
  void post(Event::Kind kind, std::uint32_t node, Time time, std::uint32_t subject = 0);
  void log(Hop::Kind kind, const Message& message, std::uint32_t at, Time begin, Time end);
  void log(Hop::Kind kind, const Message& message, std::uint32_t at) {
    log(kind, message, at, now_, now_);
  }

  // Own messages.
  void schedule_transmit(std::uint32_t at, Time earliest);
  [[nodiscard]] bool may_transmit(const CardNode& node) const;
  void on_transmit(std::uint32_t at);
  void start_own(std::uint32_t at);
  std::uint32_t make_own(std::uint32_t at);
  [[nodiscard]] std::uint32_t most_longwords(const CardNode& node) const;
  void on_extend(std::uint32_t at);
  void on_timeout(std::uint32_t at, std::uint32_t attempt);
  void expect_return(std::uint32_t at, std::uint32_t message);
  void on_return(std::uint32_t at, const Message& message, bool damaged);
  [[nodiscard]] bool corrects(const CardNode& node) const;

  // Received messages.
  void on_received(const Event& event);
  void store_plus(CardNode& node, const Message& message, bool own);
  void interrupt_of(CardNode& node, const Message& message, bool own, std::uint64_t offset,
                    std::uint64_t window);
  void store_gt(CardNode& node, const Message& message, bool own);
  bool queue_gt(CardNode& node, const Message& message, bool own);
  bool store_gt_data(CardNode& node, const Message& message, bool own);
  void reject(CardNode& node);
  [[nodiscard]] std::uint32_t receive_id(const CardNode& node) const;
  [[nodiscard]] bool is_own_id(const CardNode& node, const Message& message) const;

  // Host's side.
  [[nodiscard]] scramnet::Registers registers(const CardNode& node) const;
  Access write_plus(CardNode& node, std::uint32_t offset, std::uint32_t value, std::uint32_t bytes);
  Access write_gt(CardNode& node, std::uint32_t offset, std::uint32_t value, std::uint32_t bytes);
  Access enqueue(CardNode& node, const FifoEntry& entry);
  void reset_transmitter(CardNode& node);
  void interrupt_host(CardNode& node);
  [[nodiscard]] std::int64_t clock_ns() const {
    return clock_origin_ns_ + std::chrono::duration_cast<std::chrono::nanoseconds>(now_).count();
  }
  void latch(CardNode& node, std::uint32_t csr1_bits);
  void latch_error(CardNode& node, std::uint32_t csr1_bits);
  void trigger(CardNode& node, std::uint32_t acr_bit, std::uint32_t acr);
  void update_path(std::uint32_t at);
  [[nodiscard]] std::uint32_t live_status(std::uint32_t at) const;
  [[nodiscard]] bool has_carrier(std::uint32_t at) const;
  [[nodiscard]] scramnet::GtRing gt_ring(std::uint32_t at) const;
  [[nodiscard]] Time quiet_round_trip(std::uint32_t at) const;
  [[nodiscard]] std::uint32_t position(const CardNode& node) const {
    return static_cast<std::uint32_t>(&node - nodes_.data());
  }

  CardType type_;
  Rates rates_;
  bool strict_ids_;
  double bit_error_rate_;
  std::uint64_t random_;
  std::vector<CardNode> nodes_;
  Messages messages_;
  EventQueue events_;
  Time now_{0};
  std::int64_t clock_origin_ns_ = 0;
  mutable std::int64_t now_ns_ = 0;  ///< the same for registers
  std::uint64_t numbers_ = 0;
  std::uint32_t scheduled_ = 0;  ///< transmissions
};

}  // namespace rths::replicated
