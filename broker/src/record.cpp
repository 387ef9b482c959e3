// SPDX-License-Identifier: Apache-2.0
#include "record.hpp"

#if defined(RTHS_VECTOR_COPIES) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#include <immintrin.h>
#define RTHS_HAS_VECTORS 1
#endif

namespace rths::broker {
namespace {

using Copy = void (*)(std::uint32_t*, const std::uint32_t*, std::size_t) noexcept;

void store_one_by_one(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    std::atomic_ref{to[i]}.store(from[i], std::memory_order_release);
}

void load_one_by_one(std::uint32_t* to, std::uint32_t* from, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    to[i] = std::atomic_ref{from[i]}.load(std::memory_order_acquire);
}

#ifdef RTHS_HAS_VECTORS

// x86-64 keeps stores in order and loads in order, vectors too; the fences hold the compiler to it.
// That a vector may be seen in parts does not matter: the count around it tells.
__attribute__((target("avx512f"))) void copy_512(std::uint32_t* to, const std::uint32_t* from,
                                                 std::size_t count) noexcept {
  constexpr std::size_t kWide = 16;
  std::size_t i = 0;
  for (; i + kWide <= count; i += kWide)
    _mm512_storeu_si512(to + i, _mm512_loadu_si512(from + i));
  if (i == count) return;
  const auto rest = static_cast<__mmask16>((1U << (count - i)) - 1);
  _mm512_mask_storeu_epi32(to + i, rest, _mm512_maskz_loadu_epi32(rest, from + i));
}

__attribute__((target("avx2"))) void copy_256(std::uint32_t* to, const std::uint32_t* from,
                                              std::size_t count) noexcept {
  constexpr std::size_t kWide = 8;
  std::size_t i = 0;
  for (; i + kWide <= count; i += kWide)
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + i),
                        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + i)));
  for (; i < count; ++i) std::atomic_ref{to[i]}.store(from[i], std::memory_order_relaxed);
}

Copy best_copy() noexcept {
  if (__builtin_cpu_supports("avx512f") > 0) return copy_512;
  return __builtin_cpu_supports("avx2") > 0 ? copy_256 : nullptr;
}
#else

constexpr Copy best_copy() noexcept { return nullptr; }

#endif

const Copy copy_many = best_copy();

}  // namespace

void store_words(std::uint32_t* to, std::span<const std::uint32_t> words) noexcept {
  if (copy_many == nullptr) return store_one_by_one(to, words.data(), words.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
  copy_many(to, words.data(), words.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

void load_words(std::span<std::uint32_t> words, const std::uint32_t* from) noexcept {
  if (copy_many == nullptr)
    return load_one_by_one(words.data(), const_cast<std::uint32_t*>(from), words.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
  copy_many(words.data(), from, words.size());
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

}  // namespace rths::broker
