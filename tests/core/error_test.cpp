// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"

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

TEST(Require, NamesSubjectValueAndExpectation) {
  constexpr Require kRequire{"valve"};
  const auto refused = [](const auto& check) { return test::error_of(check); };

  EXPECT_EQ(refused([&] { kRequire.positive("gain", 0); }),
            "valve: gain is 0, expected a positive number");
  EXPECT_EQ(refused([&] { kRequire.zero_or_more("lag", -1e-3); }),
            "valve: lag is -0.001, expected 0 or more");
  EXPECT_EQ(refused([&] { kRequire.positive("gain", std::nan("")); }),
            "valve: gain is nan, expected a positive number");
  EXPECT_EQ(refused([&] { kRequire(true, "gain", 1, "anything"); }), "");
}

}  // namespace
}  // namespace rths
