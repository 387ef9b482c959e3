// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <rths/memmap/codec.hpp>

#include "support/realtime_guard.hpp"

namespace rths::memmap {
namespace {

Codec codec_for(WordType type, const std::string& unit) {
  Signal signal;
  signal.type = type;
  signal.unit = unit;
  return Codec{signal};
}

TEST(Codec, ReadsAFloatInItsUnitAsSi) {
  const Codec codec = codec_for(WordType::F32, "inch");

  EXPECT_DOUBLE_EQ(codec.decode(std::bit_cast<std::uint32_t>(2.0F)), 0.0508);
}

TEST(Codec, ReadsASignedIntegerBelowZero) {
  const Codec codec = codec_for(WordType::I32, "1");

  EXPECT_EQ(codec.decode(0xFFFF'FFFF), -1);
}

TEST(Codec, ReadsAnUnsignedIntegerAboveTheSignedRange) {
  const Codec codec = codec_for(WordType::U32, "1");

  EXPECT_EQ(codec.decode(0xFFFF'FFFF), 4294967295.0);
}

TEST(Codec, ReadsBackAWrittenValueToFloatPrecision) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> value{-1e4, 1e4};
  const Codec codec = codec_for(WordType::F32, "kip");

  for (int i = 0; i < 1000; ++i) {
    const double si = value(random);
    // A float has 24 binary digits.
    EXPECT_NEAR(codec.decode(codec.encode(si)), si, std::abs(si) * std::ldexp(1.0, -23));
  }
}

TEST(Codec, ShiftsTemperatures) {
  const Codec codec = codec_for(WordType::F32, "degC");

  EXPECT_NEAR(codec.decode(codec.encode(293.15)), 293.15, 1e-4);
  EXPECT_NEAR(codec.from_si(293.15), 20, 1e-9);
  EXPECT_NEAR(codec.to_si(20), 293.15, 1e-9);
}

TEST(Codec, RoundsIntegersToNearest) {
  const Codec codec = codec_for(WordType::I32, "1");

  EXPECT_EQ(codec.decode(codec.encode(2.6)), 3);
  EXPECT_EQ(codec.decode(codec.encode(-2.6)), -3);
}

TEST(Codec, SaturatesIntegers) {
  const double huge = 1e300;

  EXPECT_EQ(codec_for(WordType::I32, "1").encode(huge), 0x7FFF'FFFFU);
  EXPECT_EQ(codec_for(WordType::I32, "1").encode(-huge), 0x8000'0000U);
  EXPECT_EQ(codec_for(WordType::U32, "1").encode(huge), 0xFFFF'FFFFU);
  EXPECT_EQ(codec_for(WordType::U32, "1").encode(-1), 0U);
}

TEST(Codec, EncodesNaNAsZeroInAnInteger) {
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(codec_for(WordType::I32, "1").encode(nan), 0U);
  EXPECT_EQ(codec_for(WordType::U32, "1").encode(nan), 0U);
  EXPECT_TRUE(
      std::isnan(codec_for(WordType::F32, "1").decode(codec_for(WordType::F32, "1").encode(nan))));
}

TEST(Codec, WorksInRealTime) {
  const Codec codec = codec_for(WordType::I32, "mm");
  double value = 0;
  EXPECT_REALTIME(value += codec.from_si(codec.to_si(codec.decode(codec.encode(0.123)))));
  EXPECT_GT(value, 0);
}

}  // namespace
}  // namespace rths::memmap
