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
  EXPECT_EQ(number_of("1.5D-3"), 1.5e-3);
  for (const char* text : {"", "1,5", "1.5x", "x", "1 2", "1d2d", "d", "dead", "1.5D"})
    EXPECT_FALSE(number_of(text)) << text;
}

TEST(Text, HasHalvesOfNumbersWithDecimalCommas) {
  EXPECT_TRUE(are_halves({"0", "005", "-1", "5"}));
  EXPECT_TRUE(are_halves({"2", "094E-03"}));
  EXPECT_FALSE(are_halves({"1", "2", "3", "4"}));
  EXPECT_FALSE(are_halves({"0", "005", "1"}));
}

TEST(Text, HasSmallLettersOfAsciiOnly) {
  EXPECT_EQ(in_small_letters("AZ[\xC3\x84"), "az[\xC3\x84");
}

TEST(Text, HasDecimalPointsWhereCommasAreDecimal) {
  const std::pair<const char*, const char*> cases[] = {
      {"t;u\n0;1,5\n0,1;-2,5e-3\n", "t;u\n0;1.5\n0.1;-2.5e-3\n"},
      {"0,1\t1,5\n0,2\t,5\n", "0.1\t1.5\n0.2\t.5\n"},
      {"a, b\n0,1 1,5\n", "a, b\n0.1 1.5\n"},
      {"\"0,1\",\"1,5\"\n", "\"0.1\",\"1.5\"\n"},
      {"Rate;1000.0\nday;t;u\nMon;0,1;1,5\n", "Rate;1000.0\nday;t;u\nMon;0.1;1.5\n"},
      {"13.05.2024 14:37:48;0,1;1,5", "13.05.2024 14:37:48;0.1;1.5"}};
  for (const auto& [text, expected] : cases) EXPECT_EQ(with_decimal_points(text), expected);
  // A comma between columns, a point in a number, a single number per line, a comment.
  for (const std::string text :
       {"0,1,2\n0,3,4\n", "0,1;1.5\n", "0,5\n0,6\n", "1, 2, 3\n", "0.1;1,5\n0,2;1,6\n",
        "# 0,1;1,5\n", "a,b\n", "1,000;2,500\n1,005;-2,600\n", ""})
    EXPECT_EQ(with_decimal_points(text), text);
}

}  // namespace
}  // namespace rths
