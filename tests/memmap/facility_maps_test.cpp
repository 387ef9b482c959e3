// SPDX-License-Identifier: Apache-2.0
//
// The maps of the other laboratories that use OpenFresco. Every word is listed here by hand from
// OpenFresco's models, independently of the map files.
#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>

#include "support/files.hpp"
#include "support/map_image.hpp"

namespace rths::memmap {
namespace {

using Names = std::vector<std::string>;
constexpr WordType kI32 = WordType::I32;
constexpr WordType kU32 = WordType::U32;

/// Consecutive words, both ends included. Each name in turn replaces '#' in the signal.
struct Words {
  std::string signal;
  Names names;
  std::uint32_t first;
  std::uint32_t last;
  WordType type = WordType::F32;
};
using Block = std::vector<Words>;

Names numbers(int count) {
  Names names;
  for (int i = 1; i <= count; ++i) names.push_back(std::to_string(i));
  return names;
}

const Names kLines{"long", "lat", "vert"};
const Names kTurns{"roll", "pitch", "yaw"};
const Names kAxes{"long", "lat", "vert", "roll", "pitch", "yaw"};
const Names kActuators{"x1i", "x1o", "x3i", "x3o", "y2i", "y2o",
                       "y4i", "y4o", "z1",  "z2",  "z3",  "z4"};
const Names kAccelerometers{"ax1", "ax4", "ax5", "ay1", "ay2", "ay5",
                            "az1", "az2", "az3", "az4", "az5"};

Block sts_machine() {
  return {
      {"xpc.span", {}, 0, 0},
      {"xpc.#.mode", numbers(8), 1, 8, kU32},
      {"xpc.#.displ.cmd", numbers(8), 9, 16},
      {"xpc.#.force.cmd", numbers(8), 17, 24},
      {"xpc.#.displ.fbk", numbers(8), 25, 32},
      {"xpc.#.force.fbk", numbers(8), 33, 40},
      {"xpc.#.pressure_difference.fbk", numbers(8), 41, 48},
      {"xpc.#.adc", numbers(12), 49, 60},
      {"xpc.#.duc", numbers(8), 61, 68},
      {"xpc.#.encoder", numbers(2), 69, 70},
      {"xpc.#.digital_output", numbers(4), 71, 74, kU32},
      {"sts.span", {}, 75, 75},
      {"sts.#.mode", numbers(8), 76, 83, kU32},
      {"sts.#.displ.cmd", numbers(8), 84, 91},
      {"sts.#.force.cmd", numbers(8), 92, 99},
      {"sts.#.displ.fbk", numbers(8), 100, 107},
      {"sts.#.force.fbk", numbers(8), 108, 115},
      {"sts.#.pressure_difference.fbk", numbers(8), 116, 123},
      {"sts.#.valve.cmd", numbers(8), 124, 131},
      {"sts.#.adc", numbers(12), 132, 143},
      {"sts.#.duc", numbers(8), 144, 151},
      {"sts.#.encoder", numbers(2), 152, 153},
      {"sts.#.digital_input", numbers(4), 154, 157, kU32},
      {"sts.#.encoder.cmd_out", numbers(2), 158, 159},
      {"sts.#.encoder.cmd_in", numbers(2), 160, 161},
  };
}

Block sts_openfresco() {
  return {
      {"opf.newTarget", {}, 95255, 95255, kI32},
      {"opf.#.displ.target", numbers(8), 95256, 95263},
      {"opf.#.veloc.target", numbers(8), 95264, 95271},
      {"opf.#.accel.target", numbers(8), 95272, 95279},
      {"opf.#.force.target", numbers(8), 95280, 95287},
      {"opf.#.time.target", numbers(8), 95288, 95295},
      {"daq.#", {"switchPC", "atTarget"}, 95296, 95297, kI32},
      {"daq.#.displ.fbk", numbers(8), 95298, 95305},
      {"daq.#.veloc.fbk", numbers(8), 95306, 95313},
      {"daq.#.accel.fbk", numbers(8), 95314, 95321},
      {"daq.#.force.fbk", numbers(8), 95322, 95329},
      {"daq.#.time.fbk", numbers(8), 95330, 95337},
  };
}

Block mts469d_150() {
  return {
      {"xpc.sts.span", {}, 0, 0},
      {"xpc.sts.#.mode", numbers(4), 1, 4, kU32},
      {"xpc.sts.#.displ.cmd", numbers(4), 5, 8},
      {"xpc.sts.#.force.cmd", numbers(4), 9, 12},
      {"xpc.sts.#.displ.fbk", numbers(4), 13, 16},
      {"xpc.sts.#.force.fbk", numbers(4), 17, 20},
      {"xpc.sts.#.pressure_difference.fbk", numbers(4), 21, 24},
      {"xpc.sts.#.digital_output", numbers(4), 25, 28, kU32},
      {"sts.span", {}, 64, 64},
      {"sts.#.mode", numbers(4), 65, 68, kU32},
      {"sts.#.displ.cmd", numbers(4), 69, 72},
      {"sts.#.force.cmd", numbers(4), 73, 76},
      {"sts.#.displ.fbk", numbers(4), 77, 80},
      {"sts.#.force.fbk", numbers(4), 81, 84},
      {"sts.#.pressure_difference.fbk", numbers(4), 85, 88},
      {"sts.#.valve.cmd", numbers(4), 89, 92},
      {"sts.#.digital_input", numbers(4), 93, 96, kU32},
      {"xpc.mts469d.span", {}, 128, 128},
      {"xpc.mts469d.displ.ref", {}, 129, 129},
      {"mts469d.span", {}, 192, 192},
      {"mts469d.displ.ref", {}, 193, 193},
      {"mts469d.#.fbk", {"displ", "veloc", "accel", "force"}, 194, 197},
      {"opf.newTarget", {}, 1024, 1024, kI32},
      {"opf.#.target", {"displ", "veloc", "accel", "force", "time"}, 1025, 1029},
      {"daq.#", {"switchPC", "atTarget"}, 1030, 1031, kI32},
      {"daq.#.fbk", {"displ", "veloc", "accel", "force", "time"}, 1032, 1036},
  };
}

Block mts469d_gt() {
  return {
      {"xpc.span", {}, 0, 0},
      {"xpc.#.displ.ref", kAxes, 1, 6},
      {"xpc.#.displ.fbk", kActuators, 7, 18},
      {"xpc.#.accel.fbk", kAccelerometers, 19, 29},
      {"xpc.#.force.fbk", kActuators, 30, 41},
      {"xpc.#.valve.offset", kActuators, 42, 53},
      {"xpc.#.adc", numbers(40), 54, 93},
      {"xpc.#.duc", numbers(4), 94, 97},
      {"mts469d.span", {}, 256, 256},
      {"mts469d.#.displ.ref", kAxes, 257, 262},
      {"mts469d.#.displ.fbk", kAxes, 263, 268},
      {"mts469d.#.table.displ.fbk", kAxes, 269, 274},
      {"mts469d.#.table.veloc.fbk", kAxes, 275, 280},
      {"mts469d.#.table.accel.fbk", kAxes, 281, 286},
      {"mts469d.#.table.force.fbk", kLines, 287, 289},
      {"mts469d.#.table.moment.fbk", kTurns, 290, 292},
      {"mts469d.#.valve.cmd", kActuators, 293, 304},
      {"mts469d.#.adc", numbers(40), 305, 344},
      {"mts469d.#.duc", numbers(4), 345, 348},
      {"opf.newTarget", {}, 512, 512, kI32},
      {"opf.#.displ.target", kAxes, 513, 518},
      {"opf.#.veloc.target", kAxes, 519, 524},
      {"opf.#.accel.target", kAxes, 525, 530},
      {"opf.#.force.target", kLines, 531, 533},
      {"opf.#.moment.target", kTurns, 534, 536},
      {"opf.#.time.target", numbers(6), 537, 542},
      {"daq.#", {"switchPC", "atTarget"}, 543, 544, kI32},
      {"daq.#.displ.fbk", kAxes, 545, 550},
      {"daq.#.veloc.fbk", kAxes, 551, 556},
      {"daq.#.accel.fbk", kAxes, 557, 562},
      {"daq.#.force.fbk", kLines, 563, 565},
      {"daq.#.moment.fbk", kTurns, 566, 568},
      {"daq.#.time.fbk", numbers(6), 569, 574},
  };
}

Block flextest_machine() {
  return {
      {"xpc.span", {}, 0, 0},
      {"xpc.#.mode", numbers(6), 1, 6, kU32},
      {"xpc.#.displ.cmd", numbers(6), 7, 12},
      {"xpc.#.force.cmd", numbers(6), 13, 18},
      {"flextest.span", {}, 64, 64},
      {"flextest.#.mode", numbers(6), 65, 70, kU32},
      {"flextest.#.displ.cmd", numbers(6), 71, 76},
      {"flextest.#.force.cmd", numbers(6), 77, 82},
      {"flextest.#.displ.fbk", numbers(6), 83, 88},
      {"flextest.#.force.fbk", numbers(6), 89, 94},
      {"flextest.#.valve.cmd", numbers(6), 95, 100},
      {"flextest.#.adc", numbers(8), 101, 108},
  };
}

Block flextest_ucb_openfresco() {
  return {{"opf.newTarget", {}, 1024, 1024, kI32},
          {"opf.displ.target", {}, 1025, 1025},
          {"daq.#", {"switchPC", "atTarget"}, 1026, 1027, kI32},
          {"daq.#.fbk", {"displ", "force"}, 1028, 1029}};
}

Block flextest_osu_openfresco() {
  return {{"opf.newTarget", {}, 1024, 1024, kI32},
          {"opf.#.displ.target", numbers(2), 1025, 1026},
          {"daq.#", {"switchPC", "atTarget"}, 1027, 1028, kI32},
          {"daq.#.displ.fbk", numbers(2), 1029, 1030},
          {"daq.#.force.fbk", numbers(2), 1031, 1032}};
}

using Nodes = std::vector<std::pair<std::string, std::uint16_t>>;
const Nodes kSts{{"sts", 1}, {"xpc", 2}, {"opf", 3}};
const Nodes k469d150{{"sts", 1}, {"mts469d", 2}, {"xpc", 3}, {"opf", 4}};
const Nodes k469dGt{{"mts469d", 1}, {"xpc", 2}, {"opf", 3}};
const Nodes kFlexTest{{"opf", 10}, {"xpc", 20}, {"flextest", 30}};

struct Facility {
  std::string map;
  std::string image;  ///< shared by both rings of the STS: their words are the same
  std::string hash;
  Nodes nodes;
  std::uint32_t openfresco_byte;  ///< begin of OpenFresco's block
  std::vector<Block> blocks;
  std::set<std::uint32_t> interrupts = {};  ///< none if a GT card broadcasts the frame sync
  friend std::ostream& operator<<(std::ostream& out, const Facility& f) { return out << f.map; }
};

std::vector<Facility> facilities() {
  const std::vector<Block> sts{sts_machine(), sts_openfresco()};
  const std::vector<Block> ucb{flextest_machine(), flextest_ucb_openfresco()};
  const std::vector<Block> osu{flextest_machine(), flextest_osu_openfresco()};
  return {
      {"sts", "sts", "38c2f0725841349a", kSts, 381020, sts, {161}},
      {"sts_gt", "sts", "7c756b9e1e8cff93", kSts, 381020, sts},
      {"mts469d_150", "mts469d_150", "43edf2845de1deab", k469d150, 4096, {mts469d_150()}, {197}},
      {"mts469d_gt", "mts469d_gt", "90d51f025302c0b0", k469dGt, 2048, {mts469d_gt()}},
      {"flextest_ucb", "flextest_ucb", "f7cb84249a4d28ca", kFlexTest, 4096, ucb},
      {"flextest_osu", "flextest_osu", "9a6121a54f4997c5", kFlexTest, 4096, osu},
  };
}

class FacilityMap : public ::testing::TestWithParam<Facility> {
 protected:
  const Map map_ =
      load_map(test::source_tree() / "memmap/maps" / (GetParam().map + ".ringmap.toml"));
};

/// The signal of a row's i-th word.
std::string name_at(const Words& row, std::size_t i) {
  const std::size_t mark = row.signal.find('#');
  if (mark == std::string::npos) return row.signal;
  return row.signal.substr(0, mark) + row.names.at(i) + row.signal.substr(mark + 1);
}

TEST_P(FacilityMap, HasTheFacilitysNodeIds) {
  EXPECT_EQ(map_.description().nodes.size(), GetParam().nodes.size());
  for (const auto& [name, id] : GetParam().nodes) EXPECT_EQ(map_.node(name), NodeId{id}) << name;
}

TEST_P(FacilityMap, HasExactlyTheListedWordsAtTheirOffsets) {
  std::size_t listed = 0;
  for (const Block& block : GetParam().blocks) {
    for (const Words& row : block) {
      const std::uint32_t count = row.last - row.first + 1;
      ASSERT_EQ(count, std::max<std::size_t>(row.names.size(), 1)) << row.signal;
      for (std::uint32_t i = 0; i < count; ++i) {
        const Signal& signal = *map_.entry(map_.signal(name_at(row, i))).signal;
        EXPECT_EQ(signal.offset, LongwordOffset{row.first + i}) << name_at(row, i);
        EXPECT_EQ(signal.type, row.type) << name_at(row, i);
      }
      listed += count;
    }
  }
  EXPECT_EQ(map_.signals().size(), listed);
}

TEST_P(FacilityMap, HasTheNodeOfThePartitionsNameAsItsWriter) {
  std::size_t written = 0;
  for (const Partition& partition : map_.partitions()) {
    const std::string first = partition.name.substr(0, partition.name.find('.'));
    // The target xpc writes the answers to OpenFresco.
    EXPECT_EQ(partition.node, first == "daq" ? "xpc" : first) << partition.name;
    written += partition.longwords;
  }
  // Every word of a partition has a meaning.
  EXPECT_EQ(written, map_.signals().size());
}

TEST_P(FacilityMap, HasTheOpenFrescoBlockAtItsByte) {
  const auto& flag = map_.entry(map_.signal("opf.newTarget"));
  EXPECT_EQ(to_byte_offset(flag.signal->offset), ByteOffset{GetParam().openfresco_byte});
}

TEST_P(FacilityMap, RaisesTheFrameSyncWithTheFacilitysWord) {
  std::set<std::uint32_t> interrupts;
  for (const auto& entry : map_.signals())
    if (entry.signal->interrupt) interrupts.insert(entry.signal->offset.value());

  EXPECT_EQ(interrupts, GetParam().interrupts);
}

// In the image the k-th signal by offset is k + 1/2 in its unit (an integer: k); other words are 0.
// The hash also covers names, units and frame sync. If either changes, increment the map's version.
TEST_P(FacilityMap, HasTheGoldenByteImage) {
  EXPECT_EQ(map_.description().version, 1U);
  EXPECT_EQ(hash_text(map_.hash()), GetParam().hash);
  EXPECT_TRUE(test::image_of(map_) == test::content_of(test::source_tree() / "tests/data" /
                                                       (GetParam().image + "_map_v1.image")));
}

INSTANTIATE_TEST_SUITE_P(Of, FacilityMap, ::testing::ValuesIn(facilities()),
                         [](const auto& facility) { return facility.param.map; });

}  // namespace
}  // namespace rths::memmap
