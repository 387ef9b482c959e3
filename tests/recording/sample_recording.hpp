// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

namespace rths::recording {

/// Two partitions with signals in non-SI units, a step counter and an event.
inline memmap::Map sample_map() {
  return memmap::parse_map(R"(
ringmap = 1
[ring]
name = "sample"
version = 2
size_bytes = 4096
[nodes]
machine = 1
[[partition]]
name = "fbk"
node = "machine"
offset = 0
longwords = 2
[[partition.signal]]
name = "displ"
index = ["long", "lat"]
offset = 0
type = "f32"
unit = "mm"
[[partition]]
name = "monitor.machine"
node = "machine"
offset = 16
longwords = 2
[[partition.signal]]
name = "host.step"
offset = 16
type = "f32"
[[partition.signal]]
name = "host.status"
offset = 17
type = "f32"
event = true
)",
                           "sample");
}

inline std::vector<SignalId> all_signals(const memmap::Map& map) {
  std::vector<SignalId> ids;
  for (std::uint32_t i = 0; i < map.signals().size(); ++i) ids.push_back(SignalId{i});
  return ids;
}

inline Writer open_writer(const std::filesystem::path& file, double steps_per_row = 1) {
  const memmap::Map map = sample_map();
  return {file,
          map,
          all_signals(map),
          {{{"lab.toml", "name = \"lab\"\n"}, {"empty", ""}},
           {{"host", "here"}},
           {{"machine", steps_per_row}}}};
}

/// Row number `i`. Its values follow from `i`, so that a reader can check them.
inline std::vector<double> row(int i) { return {i * 1.0, i * -2.0, i + 1.0, i >= 30 ? 1.0 : 0.0}; }
inline Duration time_of(int i) { return Duration{i * 1'000'000LL}; }

inline void write_rows(Writer& writer, int from, int to) {
  for (int i = from; i < to; ++i) writer.append(time_of(i), row(i));
}

inline void expect_rows(const Reader& reader, std::size_t rows) {
  const auto along = reader.signal("fbk.long.displ");
  const auto across = reader.signal("fbk.lat.displ");
  ASSERT_EQ(along.size(), rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const auto expected = row(static_cast<int>(i));
    ASSERT_EQ(along[i], expected[0]);
    ASSERT_EQ(across[i], expected[1]);
    ASSERT_NEAR(reader.time()[i], 0.001 * static_cast<double>(i), 1e-12);
  }
}

}  // namespace rths::recording
