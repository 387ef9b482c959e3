// SPDX-License-Identifier: Apache-2.0
#include <rths/core/sha256.hpp>

#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include <rths/core/file.hpp>

namespace rths {
namespace {

constexpr std::size_t kBlockBytes = 64, kRounds = 64, kWords = 8;
constexpr std::uint64_t kMostHashedBytes = 4ULL << 30U;

using Words = std::array<std::uint32_t, kWords>;
using Rounds = std::array<std::uint32_t, kRounds>;

// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
Rounds constants() {
  Rounds found{};
  std::size_t count = 0;
  for (unsigned candidate = 2; count < kRounds; ++candidate) {
    bool is_prime = true;
    for (unsigned divisor = 2; divisor * divisor <= candidate; ++divisor)
      is_prime = is_prime && candidate % divisor != 0;
    if (!is_prime) continue;
    const long double root = std::cbrt(static_cast<long double>(candidate));
    found[count++] = static_cast<std::uint32_t>(std::ldexp(root - std::floor(root), 32));
  }
  return found;
}

std::uint32_t big_endian(const char* bytes) {
  std::uint32_t word = 0;
  for (int i = 0; i < 4; ++i) word = word << 8U | static_cast<unsigned char>(bytes[i]);
  return word;
}

/// Words of a message, FIPS 180-4 section 6.2.2.
Rounds schedule_of(const char* block) {
  Rounds w{};
  for (std::size_t t = 0; t < 16; ++t) w[t] = big_endian(block + 4 * t);
  for (std::size_t t = 16; t < kRounds; ++t) {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3U);
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10U);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  return w;
}

void add_block(Words& hash, const char* block, const Rounds& k) {
  const Rounds w = schedule_of(block);
  auto [a, b, c, d, e, f, g, h] = hash;
  for (std::size_t t = 0; t < kRounds; ++t) {
    const std::uint32_t s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t first = h + s1 + ((e & f) ^ (~e & g)) + k[t] + w[t];
    const std::uint32_t s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t second = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + first, d = c, c = b, b = a, a = first + second;
  }
  const Words added{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < kWords; ++i) hash[i] += added[i];
}

}  // namespace

std::string sha256(std::string_view bytes) {
  static const Rounds k = constants();
  Words hash{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
             0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  const std::size_t whole = bytes.size() / kBlockBytes * kBlockBytes;
  for (std::size_t at = 0; at < whole; at += kBlockBytes) add_block(hash, bytes.data() + at, k);
  std::string last{bytes.substr(whole)};
  last += '\x80';
  while (last.size() % kBlockBytes != kBlockBytes - 8) last += '\0';
  for (int shift = 56; shift >= 0; shift -= 8)
    last += static_cast<char>((8 * std::uint64_t{bytes.size()}) >> static_cast<unsigned>(shift));
  for (std::size_t at = 0; at < last.size(); at += kBlockBytes)
    add_block(hash, last.data() + at, k);
  std::string digits;
  for (const std::uint32_t word : hash) digits += fmt::format("{:08x}", word);
  return digits;
}

std::string sha256_of(const std::filesystem::path& file) {
  return sha256(read_file(file, kMostHashedBytes));
}

}  // namespace rths
