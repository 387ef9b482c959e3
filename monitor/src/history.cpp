// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/history.hpp>

#include <algorithm>
#include <cmath>

namespace rths::monitor {

void Extent::add(float value) { add({value, value}); }

void Extent::add(const Extent& other) {
  low = std::fmin(low, other.low);  // of a number and NaN: the number
  high = std::fmax(high, other.high);
}

History::History(std::size_t words, std::size_t bytes, Slot first)
    : words_{words}, first_{first}, end_{first}, levels_(kLevels) {
  const std::size_t of_a_row = std::max<std::size_t>(1, words * sizeof(Extent) * kLevels);
  while (capacity_ < kMost && 2 * capacity_ * of_a_row <= bytes) capacity_ *= 2;
  for (auto& level : levels_) {
    level.rows = std::make_unique<Extent[]>(capacity_ * words);
    level.pending.assign(words, kUnknown);
  }
}

void History::append(std::span<const Extent> slot) {
  std::span<const Extent> row = slot;
  for (int i = 0; i < kLevels; ++i) {
    Level& level = levels_[static_cast<std::size_t>(i)];
    for (std::size_t word = 0; word < words_; ++word) level.pending[word].add(row[word]);
    const int bits = kLevelBits * i;
    if (((end_ + 1) & ((Slot{1} << bits) - 1)) != 0) break;
    const auto at = static_cast<std::size_t>(end_ >> bits) & (capacity_ - 1);
    Extent* const begin = level.rows.get() + at * words_;
    std::copy(level.pending.begin(), level.pending.end(), begin);
    std::fill(level.pending.begin(), level.pending.end(), kUnknown);
    row = {begin, words_};
  }
  ++end_;
}

Slot History::begin_of(int level) const {
  const int bits = kLevelBits * level;
  const Slot kept = (end_ >> bits) - static_cast<Slot>(capacity_);
  return std::max(first_, kept << bits);
}

Slot History::begin() const { return begin_of(kLevels - 1); }

int History::width_bits_at(Slot from, int width_bits) const {
  const Slot known = std::max(from, begin());
  for (int level = width_bits / kLevelBits; level < kLevels - 1; ++level) {
    if (begin_of(level) <= known) return std::max(width_bits, kLevelBits * level);
  }
  return std::max(width_bits, kLevelBits * (kLevels - 1));
}

const Extent& History::at(int level, Slot interval, std::size_t word) const {
  const auto row = static_cast<std::size_t>(interval) & (capacity_ - 1);
  return levels_[static_cast<std::size_t>(level)].rows[row * words_ + word];
}

void History::reduce(std::size_t word, Slot from, int width_bits,
                     std::span<Extent> intervals) const {
  const int level = std::min(width_bits / kLevelBits, kLevels - 1);
  const int bits = kLevelBits * level;
  const Slot each = Slot{1} << (width_bits - bits);
  const Slot first = begin_of(level) >> bits, end = end_ >> bits;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    intervals[i] = kUnknown;
    const Slot begin = (from >> bits) + static_cast<Slot>(i) * each;
    for (Slot part = std::max(begin, first); part < std::min(begin + each, end); ++part)
      intervals[i].add(at(level, part, word));
  }
}

}  // namespace rths::monitor
