// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/core/text.hpp>

namespace rths {
namespace {

using Texts = std::vector<std::string_view>;

TEST(Text, HasLinesThatEndInAnyWay) {
  EXPECT_EQ(lines_of("a\nb\r\nc\rd"), (Texts{"a", "b", "c", "d"}));
  EXPECT_EQ(lines_of("\xEF\xBB\xBF"
                     "a\n\n"),
            (Texts{"a", ""}));
  EXPECT_TRUE(lines_of("").empty());
}

TEST(Text, HasCellsWithoutBlanksAndQuotes) {
  EXPECT_EQ(cells_of(" a , \"b c\",,d", ','), (Texts{"a", "b c", "", "d"}));
  EXPECT_EQ(cells_of("  a \t b ", ' '), (Texts{"a", "b"}));
}

TEST(Text, IsANumberAsAWholeOnly) {
  EXPECT_EQ(number_of("+1.5e-3"), 1.5e-3);
  for (const char* text : {"", "1,5", "1.5x", "x", "1 2"}) EXPECT_FALSE(number_of(text)) << text;
}

TEST(Text, HasHalvesOfNumbersWithDecimalCommas) {
  EXPECT_TRUE(are_halves({"0", "005", "-1", "5"}));
  EXPECT_TRUE(are_halves({"2", "094E-03"}));
  EXPECT_FALSE(are_halves({"1", "2", "3", "4"}));
  EXPECT_FALSE(are_halves({"0", "005", "1"}));
}

}  // namespace
}  // namespace rths
