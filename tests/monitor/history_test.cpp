// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/history.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace rths::monitor {
namespace {

/// Slots of two words with random extents, and the history of them.
struct Filled {
  explicit Filled(Slot first, Slot count) : history{2, 0, first} {
    std::mt19937 random{7};
    std::uniform_real_distribution<float> value{-1, 1};
    for (Slot i = 0; i < count; ++i) {
      const float a = value(random), b = value(random);
      slots.push_back({std::min(a, b), std::max(a, b)});
      const Extent both[] = {slots.back(), {-slots.back().high, -slots.back().low}};
      history.append(both);
    }
  }
  History history;
  std::vector<Extent> slots;
};

TEST(History, HasTheLowestAndHighestValueOfEachInterval) {
  constexpr Slot kFirst = 64 * 1000;
  const Filled filled{kFirst, 2048};

  for (int bits = 0; bits <= 8; ++bits) {
    const std::size_t width = std::size_t{1} << bits;
    std::vector<Extent> found(2048 >> bits);
    filled.history.reduce(0, kFirst, bits, found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      Extent direct = filled.slots[i * width];
      for (std::size_t k = i * width; k < (i + 1) * width; ++k) {
        direct.low = std::min(direct.low, filled.slots[k].low);
        direct.high = std::max(direct.high, filled.slots[k].high);
      }
      ASSERT_EQ(found[i].low, direct.low) << bits << " " << i;
      ASSERT_EQ(found[i].high, direct.high) << bits << " " << i;
    }
  }
}

TEST(History, KeepsWordsApart) {
  const Filled filled{0, 64};
  std::vector<Extent> first(1), second(1);

  filled.history.reduce(0, 0, 6, first);
  filled.history.reduce(1, 0, 6, second);

  EXPECT_EQ(first[0].low, -second[0].high);
}

TEST(History, KnowsNothingBeforeItsBeginAndBehindItsEnd) {
  const Filled filled{640, 64};
  std::vector<Extent> found(3);

  filled.history.reduce(0, 640 - 64, 6, found);

  EXPECT_TRUE(std::isnan(found[0].low));
  EXPECT_FALSE(std::isnan(found[1].low));
  EXPECT_TRUE(std::isnan(found[2].high));
}

TEST(History, ReachesFurtherBackInWiderIntervals) {
  constexpr Slot kFewest = History::kFewest;
  const Filled filled{0, 100 * kFewest};

  EXPECT_EQ(filled.history.end() - filled.history.begin(), 64 * kFewest);
  EXPECT_EQ(filled.history.width_bits_at(99 * kFewest, 0), 0);
  EXPECT_EQ(filled.history.width_bits_at(99 * kFewest, 4), 4);
  EXPECT_EQ(filled.history.width_bits_at(95 * kFewest, 0), 3);
  EXPECT_EQ(filled.history.width_bits_at(50 * kFewest, 0), 6);
  EXPECT_EQ(filled.history.width_bits_at(0, 0), 6);
}

TEST(History, HasTheExtentsOfLongAgo) {
  constexpr Slot kFewest = History::kFewest;
  const Filled filled{0, 100 * kFewest};
  const Slot from = 50 * kFewest;
  std::vector<Extent> found(1);

  filled.history.reduce(0, from, 6, found);

  Extent direct = filled.slots[static_cast<std::size_t>(from)];
  for (Slot k = from; k < from + 64; ++k) direct.add(filled.slots[static_cast<std::size_t>(k)]);
  EXPECT_EQ(found[0].low, direct.low);
  EXPECT_EQ(found[0].high, direct.high);
}

}  // namespace
}  // namespace rths::monitor
