// SPDX-License-Identifier: Apache-2.0
//
// Maps with one error each. The last line of each file is the exact message of the checker.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>

#include "support/files.hpp"

namespace rths::memmap {
namespace {

std::vector<std::filesystem::path> bad_maps() {
  std::vector<std::filesystem::path> files;
  for (const auto& file :
       std::filesystem::directory_iterator{test::source_tree() / "tests/data/bad_maps"})
    files.push_back(file.path());
  std::sort(files.begin(), files.end());
  return files;
}

class BadMap : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(BadMap, IsRefusedWithTheExactMessage) {
  const std::string text = test::content_of(GetParam());
  const std::string mark = "# error: ";
  const auto golden = text.rfind(mark);
  ASSERT_NE(golden, std::string::npos);
  std::string expected = text.substr(golden + mark.size());
  expected.erase(expected.find_last_not_of('\n') + 1);

  const std::string found =
      test::error_of([&] { static_cast<void>(parse_map(text, GetParam().filename().string())); });

  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(All, BadMap, ::testing::ValuesIn(bad_maps()),
                         [](const auto& map) { return map.param.stem().string(); });

TEST(BadMaps, AreAtLeastTwenty) { EXPECT_GE(bad_maps().size(), 20U); }

}  // namespace
}  // namespace rths::memmap
