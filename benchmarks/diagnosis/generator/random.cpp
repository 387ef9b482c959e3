// SPDX-License-Identifier: Apache-2.0
#include "random.hpp"

#include <bit>
#include <cmath>

namespace trial {
namespace {

// Fills the state from one word, as the authors of xoshiro recommend.
std::uint64_t split_mix(std::uint64_t& word) {
  word += 0x9e3779b97f4a7c15U;
  std::uint64_t mixed = word;
  mixed = (mixed ^ (mixed >> 30U)) * 0xbf58476d1ce4e5b9U;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94d049bb133111ebU;
  return mixed ^ (mixed >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) : state_{} {
  std::uint64_t word = seed;
  word = split_mix(word) ^ stream;
  for (std::uint64_t& element : state_) element = split_mix(word);
}

std::uint64_t Random::bits() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17U;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform(double low, double high) {
  constexpr double kUnit = 0x1p-53;
  return low + (high - low) * static_cast<double>(bits() >> 11U) * kUnit;
}

double Random::gaussian() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double x = 0, y = 0, square = 0;
  do {  // Marsaglia's polar method
    x = uniform(-1, 1);
    y = uniform(-1, 1);
    square = x * x + y * y;
  } while (square >= 1 || square == 0);
  const double scale = std::sqrt(-2 * std::log(square) / square);
  spare_ = y * scale;
  has_spare_ = true;
  return x * scale;
}

std::size_t Random::below(std::size_t bound) {
  return static_cast<std::size_t>(uniform(0, static_cast<double>(bound)));
}

}  // namespace trial
