// SPDX-License-Identifier: Apache-2.0
#include "record.hpp"

#ifdef RTHS_VECTORS
#include <immintrin.h>
#endif

namespace rths::broker::detail {

#ifdef RTHS_VECTORS
namespace {

__attribute__((target("avx512f"))) void copy_512(std::uint32_t* to, const std::uint32_t* from,
                                                 std::size_t count) noexcept {
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) _mm512_storeu_si512(to + i, _mm512_loadu_si512(from + i));
  copy_few(to + i, from + i, count - i);
}

__attribute__((target("avx2"))) void copy_256(std::uint32_t* to, const std::uint32_t* from,
                                              std::size_t count) noexcept {
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8)
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + i),
                        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + i)));
  copy_few(to + i, from + i, count - i);
}

void copy_128(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) copy_four(to + i, from + i);
  copy_few(to + i, from + i, count - i);
}

using Copy = void (*)(std::uint32_t*, const std::uint32_t*, std::size_t) noexcept;

Copy widest_copy() noexcept {
  if (__builtin_cpu_supports("avx512f") > 0) return copy_512;
  return __builtin_cpu_supports("avx2") > 0 ? copy_256 : copy_128;
}

const Copy widest = widest_copy();

}  // namespace

void copy_many(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  widest(to, from, count);
}
#endif

// Processors that do not know these hints do nothing.
void ask_for_lines(const std::uint32_t* begin, std::size_t bytes) noexcept {
  const auto* line = reinterpret_cast<const char*>(begin);
  for (const char* end = line + bytes; line < end; line += kLineBytes)
#if defined(__x86_64__)
    asm volatile("prefetchw %0" : : "m"(*line));
#else
    __builtin_prefetch(line, 1);
#endif
}

void pass_on_lines([[maybe_unused]] const std::uint32_t* begin,
                   [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__x86_64__)
  const auto* line = reinterpret_cast<const char*>(begin);
  for (const char* end = line + bytes; line < end; line += kLineBytes)
    asm volatile("cldemote %0" : : "m"(*line));
#endif
}

}  // namespace rths::broker::detail
