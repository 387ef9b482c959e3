// SPDX-License-Identifier: Apache-2.0
#include <rths/core/axis.hpp>

#include <gtest/gtest.h>

namespace rths {
namespace {

TEST(Axis, IsFoundByItsNameAndPlacedAsInTheLists) {
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    EXPECT_EQ(index_of(kAxes[i]), i);
    EXPECT_EQ(axis_named(name_of(kAxes[i])), kAxes[i]);
  }
  for (std::size_t i = 0; i < kTranslations.size(); ++i) EXPECT_EQ(kTranslations[i], kAxes[i]);
  for (std::size_t i = 0; i < kHorizontal.size(); ++i) EXPECT_EQ(kHorizontal[i], kAxes[i]);
  EXPECT_FALSE(axis_named("longitudinal"));
  EXPECT_FALSE(axis_named(""));
}

TEST(Axis, IsATranslationOrARotation) {
  for (const Axis axis : kTranslations) EXPECT_EQ(kind_of(axis), AxisKind::Translational);
  for (const Axis axis : {Axis::Roll, Axis::Pitch, Axis::Yaw})
    EXPECT_EQ(kind_of(axis), AxisKind::Rotational);
}

TEST(Axis, IsHorizontalIfItIsLongOrLat) {
  EXPECT_EQ(horizontal_axis_named("lat"), Axis::Lat);
  EXPECT_FALSE(horizontal_axis_named("vert"));
  EXPECT_FALSE(horizontal_axis_named("x"));
}

TEST(Axis, IsFoundAmongNames) {
  const auto names = names_of(kHorizontal);
  EXPECT_EQ(names, (std::vector<std::string>{"long", "lat"}));
  EXPECT_TRUE(contains(names, Axis::Lat));
  EXPECT_FALSE(contains(names, Axis::Vert));
  EXPECT_EQ(horizontal_among(std::vector<std::string>{"vert", "lat"}), (std::array{false, true}));
}

}  // namespace
}  // namespace rths
