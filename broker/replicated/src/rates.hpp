// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/replicated/ring.hpp>

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

}  // namespace rths::replicated
