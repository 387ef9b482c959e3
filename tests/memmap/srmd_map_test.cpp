// SPDX-License-Identifier: Apache-2.0
//
// The SRMD's map, word for word as on the laboratory's sheet.
#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>

#include "memmap/srmd.hpp"
#include "support/map_image.hpp"

namespace rths::memmap {
namespace {

std::uint32_t word_of(const Map& map, const std::string& signal) {
  return map.entry(map.signal(signal)).signal->offset.value();
}

TEST(SrmdMap, HasTheLaboratorysNodeIds) {
  const Map map = srmd();

  EXPECT_EQ(map.node("srmd"), NodeId{1});
  EXPECT_EQ(map.node("xpc"), NodeId{2});
  EXPECT_EQ(map.node("opf"), NodeId{3});
}

TEST(SrmdMap, HasReferencesFromWordZeroInTheMachinesOrder) {
  const Map map = srmd();

  const char* order[] = {"long", "lat", "vert", "roll", "pitch", "yaw"};
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(word_of(map, std::string{"xpc."} + order[i] + ".displ.ref"), i);
    EXPECT_EQ(word_of(map, std::string{"srmd."} + order[i] + ".displ.ref_echo"), 64 + i);
    EXPECT_EQ(word_of(map, std::string{"srmd."} + order[i] + ".displ.fbk"), 71 + i);
    EXPECT_EQ(word_of(map, std::string{"opf."} + order[i] + ".displ.target"), 1025 + i);
    EXPECT_EQ(word_of(map, std::string{"daq."} + order[i] + ".displ.fbk"), 1062 + i);
  }
  EXPECT_EQ(word_of(map, "xpc.compression.force.ref"), 6U);
  EXPECT_EQ(word_of(map, "srmd.compression.force.fbk"), 77U);
}

TEST(SrmdMap, HasTheMachinesOtherWordsAtTheSheetsOffsets) {
  const Map map = srmd();

  EXPECT_EQ(word_of(map, "xpc.1.user_input"), 7U);
  EXPECT_EQ(word_of(map, "xpc.8.user_input"), 14U);
  EXPECT_EQ(word_of(map, "srmd.long.accel.fbk"), 78U);
  EXPECT_EQ(word_of(map, "srmd.vert.accel.fbk"), 80U);
  EXPECT_EQ(word_of(map, "srmd.long.force.fbk"), 81U);
  EXPECT_EQ(word_of(map, "srmd.yaw.moment.fbk"), 86U);
  EXPECT_EQ(word_of(map, "srmd.ne.outrigger.force.fbk"), 87U);
  EXPECT_EQ(word_of(map, "srmd.lift.pressure.fbk"), 91U);
  EXPECT_EQ(word_of(map, "srmd.1.user_ad"), 92U);
  EXPECT_EQ(word_of(map, "srmd.12.user_ad"), 103U);
  EXPECT_EQ(word_of(map, "srmd.1.user_input_echo"), 104U);
}

TEST(SrmdMap, RaisesTheFrameSyncWithItsLastWord) {
  const Map map = srmd();

  const auto& last = map.entry(map.signal("srmd.8.user_input_echo"));
  EXPECT_EQ(last.signal->offset, LongwordOffset{111});
  EXPECT_TRUE(last.signal->interrupt);
}

TEST(SrmdMap, HasTheOpenFrescoBlockAtByte4096) {
  const Map map = srmd();

  EXPECT_EQ(to_byte_offset(LongwordOffset{word_of(map, "opf.newTarget")}), ByteOffset{4096});
  EXPECT_EQ(word_of(map, "opf.long.veloc.target"), 1032U);
  EXPECT_EQ(word_of(map, "opf.long.accel.target"), 1039U);
  EXPECT_EQ(word_of(map, "opf.long.force.target"), 1046U);
  EXPECT_EQ(word_of(map, "opf.1.time.target"), 1053U);
  EXPECT_EQ(word_of(map, "opf.7.time.target"), 1059U);
  EXPECT_EQ(word_of(map, "daq.switchPC"), 1060U);
  EXPECT_EQ(word_of(map, "daq.atTarget"), 1061U);
  EXPECT_EQ(word_of(map, "daq.long.veloc.fbk"), 1069U);
  EXPECT_EQ(word_of(map, "daq.long.accel.fbk"), 1076U);
  EXPECT_EQ(word_of(map, "daq.long.force.fbk"), 1083U);
  EXPECT_EQ(word_of(map, "daq.7.time.fbk"), 1096U);
}

TEST(SrmdMap, LetsEachPartitionBeWrittenByItsNode) {
  const Map map = srmd();

  const std::pair<std::uint32_t, const char*> writers[] = {
      {0, "xpc"},    {14, "xpc"},   {64, "srmd"},  {111, "srmd"},
      {1024, "opf"}, {1059, "opf"}, {1060, "xpc"}, {1096, "xpc"}};
  for (const auto& [word, node] : writers)
    EXPECT_EQ(map.partition_at(LongwordOffset{word})->node, node) << word;
  for (const std::uint32_t blank : {15U, 63U, 112U, 1023U, 1097U})
    EXPECT_EQ(map.partition_at(LongwordOffset{blank}), nullptr) << blank;
}

// If these bytes change, increment the map's version.
TEST(SrmdMap, HasTheGoldenByteImage) {
  const Map map = srmd();

  // The image has numbers in the map's units; the hash covers the units themselves.
  EXPECT_EQ(map.description().version, 1U);
  EXPECT_EQ(hash_text(map.hash()), "6c85bb8e8ef0495f");
  EXPECT_TRUE(test::image_of(map) ==
              test::content_of(test::source_tree() / "tests/data/srmd_map_v1.image"));
}

}  // namespace
}  // namespace rths::memmap
