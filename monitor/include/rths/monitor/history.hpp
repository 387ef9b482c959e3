// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <rths/core/clock.hpp>

namespace rths::monitor {

/// Lowest and highest value of a word during an interval.
struct Extent {
  float low, high;

  void add(float value);
  void add(const Extent& other);
};
/// Of an interval without a known value.
inline constexpr Extent kUnknown{std::numeric_limits<float>::quiet_NaN(),
                                 std::numeric_limits<float>::quiet_NaN()};

/// A slot is the shortest interval of a history. Its number counts from the origin of
/// CLOCK_MONOTONIC.
using Slot = std::int64_t;
inline constexpr Duration kSlot = std::chrono::milliseconds{1};

/// The last minutes of all words, in constant memory: extents of slots, of 8 slots, and of 64
/// slots. The coarser ones reach further back.
///
/// Not safe for concurrent use.
class History {
 public:
  /// @param bytes  of all extents together, if the words are not too many: at least kFewest extents
  ///               of each kind are kept
  /// @param first  the first slot
  History(std::size_t words, std::size_t bytes, Slot first);

  static constexpr std::size_t kFewest = 2048, kMost = 65536;
  static constexpr int kLevels = 3;
  static constexpr int kLevelBits = 3;  ///< of a level's interval, log2 of those of the finer level

  /// Appends the next slot, an extent for each word.
  void append(std::span<const Extent> slot);
  [[nodiscard]] Slot begin() const;
  /// The first slot that is not appended yet.
  [[nodiscard]] Slot end() const { return end_; }
  /// The narrowest intervals of at least 2^width_bits slots that still reach back to a slot.
  /// @returns log2 of their slots
  [[nodiscard]] int width_bits_at(Slot from, int width_bits) const;
  /// Lowest and highest value in each of consecutive intervals of 2^width_bits slots.
  /// @param from  a multiple of the interval
  void reduce(std::size_t word, Slot from, int width_bits, std::span<Extent> intervals) const;

 private:
  struct Level {
    /// A row of all words for each interval, a ring. It is written once at the beginning, so that
    /// the system gives all of its memory then.
    std::unique_ptr<Extent[]> rows;
    std::vector<Extent> pending;  ///< the row that is not complete yet
  };
  [[nodiscard]] Slot begin_of(int level) const;
  [[nodiscard]] const Extent& at(int level, Slot interval, std::size_t word) const;

  std::size_t words_;
  std::size_t capacity_ = kFewest;  ///< rows of each level, a power of 2
  Slot first_, end_;
  std::vector<Level> levels_;
};

}  // namespace rths::monitor
