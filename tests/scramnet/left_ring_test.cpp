// SPDX-License-Identifier: Apache-2.0
//
// `rths clean` and the rings that programs written for the cards leave.
#include <sys/wait.h>

#include <csignal>

#include <fmt/format.h>

#include "ring_use.hpp"

namespace {

using rths::broker::Ring;
using rths::test::Finished;
using rths::test::run_rths;
using rths::test::small_map;

class LeftRing : public rths::test::RingUse {};

TEST_F(LeftRing, KeepsIdleCardsUntilTheirRingIsNamed) {
  ASSERT_EQ(run_client().exit_code, 0);
  kill(start_client("client")->pid(), SIGKILL);  // as by ^C, which these programs do not handle

  const Finished clean = run_rths({"clean"});

  EXPECT_NE(clean.out.find(fmt::format("kept {0}: memory and registers of 1 card; 'rths clean {0}' "
                                       "removes it\n",
                                       name)),
            std::string::npos)
      << clean.out;
  EXPECT_NE(rths::test::error_of([&] {
              static_cast<void>(Ring::create(name, small_map()));
            }).find("exists already, made by programs written for the cards; remove it by"),
            std::string::npos);
  EXPECT_EQ(run_rths({"clean", name}).out, fmt::format("removed {}\n", name));
  EXPECT_FALSE(rths::broker::inspect_ring(name));
}

TEST_F(LeftRing, KeepsANamedRingThatIsInUse) {
  const auto running = start_client("client");

  const Finished clean = run_rths({"clean", name});

  EXPECT_EQ(clean.exit_code, 1);
  EXPECT_EQ(clean.out, fmt::format("kept {}: processes use it\n", name));
  EXPECT_EQ(run_rths({"clean", "no_such_ring"}).err, "rths: there is no ring 'no_such_ring'\n");
}

// The ring of a run that crashed is removed, although a card was on it.
TEST_F(LeftRing, DoesNotKeepCardsOfACrashedRun) {
  const pid_t run = fork();
  if (run == 0) {
    Ring made = Ring::create(name, small_map());
    const auto controller = made.join("controller", 0);
    kill(getpid(), SIGKILL);
  }
  ASSERT_EQ(waitpid(run, nullptr, 0), run);
  be_node("machine");
  ASSERT_EQ(run_client().exit_code, 0);

  static_cast<void>(run_rths({"clean"}));  // other tests may leave rings, too

  EXPECT_FALSE(rths::broker::inspect_ring(name));
}

}  // namespace
