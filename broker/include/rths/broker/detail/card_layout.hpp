// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rths::broker {

// Layout of a card in the ring's object, sparse until it is used:
//
//   0                  registers and queues          kCardRegisterBytes
//   acr_at             auxiliary control RAM (ACR)   a longword for each longword of memory
//   behind it          last known values of words    the same; only of words that interrupt
//
// broker/card defines the content. GT cards, which may be larger than kLargestPlusMemory, have
// registers only.
inline constexpr std::uint64_t kCardRegisterBytes = 128U << 10U;
inline constexpr std::uint64_t kLargestPlusMemory = 8U << 20U;

[[nodiscard]] constexpr std::uint64_t acr_bytes(std::uint64_t memory_bytes) noexcept {
  constexpr std::uint64_t kPage = 4096;
  return memory_bytes > kLargestPlusMemory ? 0 : (memory_bytes + kPage - 1) / kPage * kPage;
}
[[nodiscard]] constexpr std::uint64_t card_size(std::uint64_t memory_bytes) noexcept {
  return kCardRegisterBytes + 2 * acr_bytes(memory_bytes);
}

}  // namespace rths::broker
