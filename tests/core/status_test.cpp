// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/core/status.hpp>

namespace rths {
namespace {

constexpr Status kAll[] = {Status::Ok,    Status::Done,          Status::Late,
                           Status::Stale, Status::LimitExceeded, Status::Fault};

TEST(Status, WorstOfTwoWinsInEitherOrder) {
  for (const Status a : kAll)
    for (const Status b : kAll) {
      EXPECT_EQ(worst(a, b), worst(b, a));
      EXPECT_GE(worst(a, b), a);
    }
  EXPECT_EQ(worst(Status::LimitExceeded, Status::Late), Status::LimitExceeded);
}

TEST(Status, HasAWordForEachValue) {
  std::set<std::string> words;
  for (const Status status : kAll) words.insert(to_text(status));
  EXPECT_EQ(words.size(), std::size(kAll));
}

TEST(Assertion, StopsTheProcessWithTheClaim) {
  EXPECT_DEATH(assertion_failed("one == two", "file.cpp", 7), "file.cpp:7: .*one == two");
}

}  // namespace
}  // namespace rths
