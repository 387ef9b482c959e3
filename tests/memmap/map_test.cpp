// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"

namespace rths::memmap {
namespace {

constexpr const char* kText = R"(
ringmap = 1
[ring]
name = "lab"
version = 3
size_bytes = 8192
[nodes]
controller = 20
machine = 30
[[partition]]
name = "fbk"
node = "machine"
byte_offset = 4096
longwords = 8
tear_group = true
[[partition.signal]]
name = "displ"
index = ["long", "lat"]
location = 1025
type = "f32"
unit = "mm"
range = [-1220, 1220.5]
[[partition]]
name = "ref"
node = "controller"
offset = 0
longwords = 4
[[partition.signal]]
name = "mode"
offset = 2
type = "u32"
values = { run = 1, idle = 0 }
initial = 1
interrupt = true
event = true
)";

TEST(Map, PlacesWordsByOffsetLocationOrBytes) {
  const Map map = parse_map(kText, "lab.toml");

  EXPECT_EQ(map.entry(map.signal("fbk.long.displ")).signal->offset, LongwordOffset{1024});
  EXPECT_EQ(map.entry(map.signal("fbk.lat.displ")).signal->offset, LongwordOffset{1025});
  EXPECT_EQ(map.partitions()[1].base, LongwordOffset{1024});
}

TEST(Map, ListsSignalsInOrderOfOffset) {
  const Map map = parse_map(kText, "lab.toml");

  ASSERT_EQ(map.signals().size(), 3U);
  EXPECT_EQ(map.signals()[0].name, "ref.mode");
  EXPECT_EQ(map.signals()[2].name, "fbk.lat.displ");
}

TEST(Map, FindsTheWriterOfAWord) {
  const Map map = parse_map(kText, "lab.toml");

  EXPECT_EQ(map.partition_at(LongwordOffset{1031})->node, "machine");
  EXPECT_EQ(map.partition_at(LongwordOffset{1032}), nullptr);
  EXPECT_EQ(map.node("machine"), NodeId{30});
  EXPECT_EQ(map.node_name(NodeId{20}), "controller");
  EXPECT_EQ(map.node_name(NodeId{99}), "99");
}

TEST(Map, SuggestsTheSignalForAMisspeltOne) {
  const Map map = parse_map(kText, "lab.toml");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(map.signal("fbk.lng.displ")); }),
            "map 'lab' has no signal 'fbk.lng.displ' (did you mean 'fbk.long.displ'?)");
}

TEST(Map, ReportsEveryMistakeOfAFile) {
  std::string text = kText;
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("unit = \"mm\"", "unit = \"mmm\"");
  replace("type = \"u32\"", "type = \"u33\"");
  replace("machine = 30", "machine = 20");
  replace("[nodes]", "colour = 3\n[nodes]");

  const std::string error = test::error_of([&] { static_cast<void>(parse_map(text, "lab.toml")); });

  EXPECT_EQ(error,
            "lab.toml:7:10: unknown key 'colour', expected one of name, size_bytes, version\n"
            "lab.toml:32:8: type is 'u33', expected i32, u32 or f32");
  replace("colour = 3\n", "");
  replace("type = \"u33\"", "type = \"u32\"");
  EXPECT_EQ(test::error_of([&] { static_cast<void>(parse_map(text, "lab.toml")); }),
            "lab.toml:9:11: nodes 'controller' and 'machine' both have id 20\n"
            "lab.toml:16:1: signal 'long.displ': unit 'mmm' does not parse\n"
            "lab.toml:16:1: signal 'lat.displ': unit 'mmm' does not parse");
}

TEST(Map, ReadsItsCanonicalSpellingBack) {
  const Map map = parse_map(kText, "lab.toml");

  const Map again = parse_map(map.to_toml(), "canonical");

  EXPECT_EQ(again.to_toml(), map.to_toml());
  EXPECT_EQ(again.hash(), map.hash());
}

TEST(Map, ReadsTheNamesOfValuesBack) {
  std::string text = kText;
  text.replace(text.find("idle = 0"), 8, "\"at-rest_2\" = 0");
  const Map map = parse_map(text, "lab.toml");

  EXPECT_EQ(parse_map(map.to_toml(), "canonical").hash(), map.hash());
}

TEST(Map, HasTheSameHashInEverySpelling) {
  std::string reordered = kText;
  const auto second = reordered.rfind("[[partition]]");
  const std::string head = reordered.substr(0, reordered.find("[[partition]]"));
  const std::string first_partition = reordered.substr(head.size(), second - head.size());
  reordered = head + reordered.substr(second) + first_partition + "\n# a comment\n";

  EXPECT_EQ(parse_map(reordered, "x").hash(), parse_map(kText, "y").hash());
}

TEST(Map, HasAnotherHashWhenTheMeaningOfAWordChanges) {
  const auto hash_with = [](const std::string& from, const std::string& to) {
    std::string text = kText;
    text.replace(text.find(from), from.size(), to);
    return parse_map(text, "x").hash();
  };
  const auto original = parse_map(kText, "x").hash();

  EXPECT_NE(hash_with("\"mm\"", "\"inch\""), original);
  EXPECT_NE(hash_with("offset = 2", "offset = 3"), original);
  EXPECT_NE(hash_with("version = 3", "version = 4"), original);
  EXPECT_NE(hash_with("idle = 0", "rest = 0"), original);
  EXPECT_NE(hash_with("machine = 30", "machine = 31"), original);
  EXPECT_NE(hash_with("tear_group = true", "tear_group = false"), original);
}

TEST(Map, KeepsItsPointersValidInACopy) {
  const Map map = parse_map(kText, "lab.toml");

  const Map copy = map;  // NOLINT: tests the copy

  EXPECT_EQ(copy.signals()[0].partition, &copy.partitions()[0]);
  EXPECT_EQ(copy.hash(), map.hash());
}

// Random valid layouts must pass the checks and read back unchanged from their canonical spelling.
TEST(Map, AcceptsEveryValidLayout) {
  const int trials = test::Repetitions{1000, 200, 50}.count();
  std::mt19937 random{2026};
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int trial = 0; trial < trials; ++trial) {
    MapDescription description;
    description.name = "random";
    description.size_longwords = 4096;
    description.nodes = {{"a", NodeId{1}, ""}, {"b", NodeId{2}, ""}};
    std::uint32_t next = below(50);
    for (int p = 0; p < 8; ++p) {
      Partition partition;
      partition.name = "p" + std::to_string(p);
      partition.node = below(2) == 0 ? "a" : "b";
      partition.base = LongwordOffset{next};
      partition.longwords = 1 + below(40);
      partition.tear_group = below(2) == 0;
      for (std::uint32_t word = 0; word < partition.longwords; word += 1 + below(3)) {
        Signal signal;
        signal.name = "s" + std::to_string(word);
        signal.offset = advance(partition.base, word);
        signal.type = static_cast<WordType>(below(3));
        const double scales[] = {0.25, 1e20, -1e-20};
        signal.initial = scales[below(3)] * below(100);
        partition.signals.push_back(signal);
      }
      next += partition.longwords + below(60);
      description.partitions.push_back(partition);
    }
    const Map map{description};
    EXPECT_EQ(parse_map(map.to_toml(), "again").hash(), map.hash());
  }
}

}  // namespace
}  // namespace rths::memmap
