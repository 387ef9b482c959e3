// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

namespace rths {
namespace {

TEST(Error, IsOneLineWithoutControlCharacters) {
  using namespace std::string_literals;
  const std::string name = "a\nb\0c\x1b[31m\x7f\xc2\x9b µ"s;

  EXPECT_STREQ(Error{name}.what(), "a\\nb\\x00c\\x1b[31m\\x7f\\x9b µ");
}

TEST(Error, OfSeveralMistakesHasALineForEach) {
  EXPECT_STREQ((Error{std::vector<std::string>{"one", "t\nwo"}}.what()), "one\nt\\nwo");
}

}  // namespace
}  // namespace rths
