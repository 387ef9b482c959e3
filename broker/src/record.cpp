// SPDX-License-Identifier: Apache-2.0
#include "record.hpp"

#include <algorithm>

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

bool has_512() noexcept { return __builtin_cpu_supports("avx512f") > 0; }
bool has_256() noexcept { return __builtin_cpu_supports("avx2") > 0; }
Copy widest_copy() noexcept { return has_512() ? copy_512 : has_256() ? copy_256 : copy_128; }

constinit Copy widest = copy_128;
[[maybe_unused]] const Copy kChosen = widest = widest_copy();

}  // namespace

void copy_many(std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
  widest(to, from, count);
}
#endif

std::vector<Copy> copies() {
  std::vector<Copy> all{
      [](std::uint32_t* to, const std::uint32_t* from, std::size_t count) noexcept {
        store_words(to, {from, count});
      }};
#ifdef RTHS_VECTORS
  all.push_back(copy_128);
  if (has_256()) all.push_back(copy_256);
  if (has_512()) all.push_back(copy_512);
#endif
  return all;
}

constexpr std::size_t kMostLines = 32;  // a processor can prefetch these without evicting them

// Processors without these instructions execute them as no-ops.
void prefetch_lines(const std::uint32_t* begin, std::size_t bytes) noexcept {
  const auto* line = reinterpret_cast<const char*>(begin);
  for (const char* end = line + std::min(bytes, kMostLines * kLineBytes); line < end;
       line += kLineBytes)
#if defined(__x86_64__)
    asm volatile("prefetchw %0" : : "m"(*line));
#else
    __builtin_prefetch(line, 1);
#endif
}

void demote_lines([[maybe_unused]] const std::uint32_t* begin,
                  [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__x86_64__)
  const auto* line = reinterpret_cast<const char*>(begin);
  for (const char* end = line + bytes; line < end; line += kLineBytes)
    asm volatile("cldemote %0" : : "m"(*line));
#endif
}

}  // namespace rths::broker::detail
