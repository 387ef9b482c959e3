// SPDX-License-Identifier: Apache-2.0
#include <type_traits>

#include <gtest/gtest.h>

#include <rths/core/ids.hpp>

namespace rths {
namespace {

// These must not compile: each would mix bytes, longwords and locations.
template <class To, class From>
concept AssignableFrom = requires(To to, From from) {
  to = from;
};
template <class A, class B>
concept Comparable = requires(A a, B b) {
  a == b;
};
template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};

static_assert(!AssignableFrom<LongwordOffset, std::uint32_t>);
static_assert(!AssignableFrom<LongwordOffset, ByteOffset>);
static_assert(!AssignableFrom<Location, LongwordOffset>);
static_assert(!AssignableFrom<NodeId, SignalId>);
static_assert(!Comparable<LongwordOffset, ByteOffset>);
static_assert(!Comparable<NodeId, std::uint16_t>);
static_assert(!Addable<LongwordOffset, ByteOffset>);
static_assert(!std::is_convertible_v<std::uint32_t, Location>);
static_assert(!std::is_convertible_v<LongwordOffset, std::uint32_t>);
static_assert(std::is_trivially_copyable_v<LongwordOffset>);

TEST(LongwordOffset, IsAQuarterOfTheByteOffset) {
  EXPECT_EQ(to_byte_offset(LongwordOffset{1024}), ByteOffset{4096});
  EXPECT_EQ(to_longword_offset(ByteOffset{0x5D05C}), LongwordOffset{95255});
}

TEST(Location, CountsFromOne) {
  EXPECT_EQ(to_location(LongwordOffset{0}), Location{1});
  EXPECT_EQ(to_longword_offset(Location{64}), LongwordOffset{63});
}

TEST(ByteOffset, IsAlignedAtEveryFourth) {
  EXPECT_TRUE(is_aligned(ByteOffset{4096}));
  EXPECT_FALSE(is_aligned(ByteOffset{4098}));
}

TEST(StrongId, IsOrderedByItsValue) {
  EXPECT_LT(LongwordOffset{1}, LongwordOffset{2});
  EXPECT_EQ(advance(LongwordOffset{1}, 3), LongwordOffset{4});
}

}  // namespace
}  // namespace rths
