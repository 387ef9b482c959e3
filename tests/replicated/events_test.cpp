// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "events.hpp"

namespace rths::replicated {
namespace {

TEST(EventQueue, GivesEventsByTimeThenNodeThenOrderOfPosting) {
  EventQueue queue;
  std::uint32_t posted = 0;
  const auto post = [&](int time, std::uint16_t node) {
    Event event;
    event.time = Time{time};
    event.node = node;
    event.subject = posted++;
    queue.post(event);
  };
  for (int i = 0; i < 8; ++i) post(2, 1);
  post(2, 0);
  post(1, 5);

  for (const std::uint32_t subject : {9U, 8U, 0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U})
    EXPECT_EQ(queue.take_first().subject, subject);
  EXPECT_TRUE(queue.is_empty());
}

}  // namespace
}  // namespace rths::replicated
