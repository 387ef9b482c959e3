// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "launch/src/launcher_link.hpp"

namespace rths::launch {
namespace {

TEST(StepTimes, ArriveAsTheyWereSent) {
  const adapters::StepTimes sent{{2e-5F, 0, 0.0123F}, {3e-5F, 1e-6F, 2}};

  testing::internal::CaptureStdout();
  send_times(sent);
  const std::string line = testing::internal::GetCapturedStdout();

  ASSERT_EQ(line.rfind(kTimesLine, 0), 0U) << line;
  adapters::StepTimes received;
  read_times(line.substr(std::string{kTimesLine}.size()), received);
  EXPECT_EQ(received.late, sent.late);
  EXPECT_EQ(received.duration, sent.duration);
}

// A node that dies while it writes leaves half a line.
TEST(StepTimes, OfHalfAStepAreIgnored) {
  adapters::StepTimes received;

  read_times("10 20 30", received);
  read_times("ten", received);

  EXPECT_EQ(received.late.size(), 1U);
  EXPECT_EQ(received.duration.size(), 1U);
}

}  // namespace
}  // namespace rths::launch
