// SPDX-License-Identifier: Apache-2.0
#include "record.hpp"

#if defined(RTHS_VECTOR_COPIES) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#include <immintrin.h>
#endif

namespace rths::broker {
namespace {

void store_one_by_one(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    std::atomic_ref{to[i]}.store(from[i], std::memory_order_release);
}

void load_one_by_one(std::uint32_t* to, std::uint32_t* from, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    to[i] = std::atomic_ref{from[i]}.load(std::memory_order_acquire);
}

#if defined(RTHS_VECTOR_COPIES) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__)

constexpr std::size_t kWordsPerVector = 8;

// x86-64 keeps stores in order and loads in order, vectors too; the fences hold the compiler to it.
// That a vector may be seen in parts does not matter: the count around it tells.
__attribute__((target("avx2"))) void copy_vectors(std::uint32_t* to, const std::uint32_t* from,
                                                  std::size_t vectors) noexcept {
  std::atomic_signal_fence(std::memory_order_seq_cst);
  for (std::size_t i = 0; i < vectors; ++i) {
    const auto* source = reinterpret_cast<const __m256i*>(from + i * kWordsPerVector);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + i * kWordsPerVector),
                        _mm256_loadu_si256(source));
  }
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

const bool has_vectors = __builtin_cpu_supports("avx2") > 0;

std::size_t copy_vectors_of(std::uint32_t* to, const std::uint32_t* from,
                            std::size_t count) noexcept {
  if (!has_vectors) return 0;
  const std::size_t vectors = count / kWordsPerVector;
  copy_vectors(to, from, vectors);
  return vectors * kWordsPerVector;
}

#else

std::size_t copy_vectors_of(std::uint32_t*, const std::uint32_t*, std::size_t) noexcept {
  return 0;
}

#endif

}  // namespace

void store_words(std::uint32_t* to, std::span<const std::uint32_t> words) noexcept {
  const std::size_t done = copy_vectors_of(to, words.data(), words.size());
  store_one_by_one(to + done, words.data() + done, words.size() - done);
}

void load_words(std::span<std::uint32_t> words, const std::uint32_t* from) noexcept {
  const std::size_t done = copy_vectors_of(words.data(), from, words.size());
  load_one_by_one(words.data() + done, const_cast<std::uint32_t*>(from) + done,
                  words.size() - done);
}

}  // namespace rths::broker
