// SPDX-License-Identifier: Apache-2.0
//
// Programs written for the cards beside a run.
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "ring_use.hpp"

namespace {

using rths::broker::Ring;
using rths::test::Finished;
using rths::test::RingUse;
using rths::test::Running;
using rths::test::small_map;

TEST_F(RingUse, RefusesANodeThatIsRunning) {
  Ring made = Ring::create(name, small_map());
  const auto controller = made.join("controller", 0);
  be_node("controller");

  const Finished refused = run_client();

  EXPECT_NE(refused.exit_code, 0);
  EXPECT_EQ(refused.err,
            fmt::format("scramnet: node 'controller' of ring '{}' is process {}, which writes its "
                        "words; choose another node, or set RTHS_SCRAMNET_SHARE=1 to store into "
                        "them too\n",
                        name, getpid()));
}

TEST_F(RingUse, SharesARunningNodeOnRequestAndSaysSo) {
  Ring made = Ring::create(name, small_map());
  const auto controller = made.join("controller", 0);
  be_node("controller");
  setenv("RTHS_SCRAMNET_SHARE", "1", 1);

  const Finished shared = run_client();

  EXPECT_EQ(shared.exit_code, 0);
  EXPECT_EQ(shared.err, fmt::format("scramnet: node 'controller' of ring '{}' is also process {}\n",
                                    name, getpid()));
}

TEST_F(RingUse, AnnouncesTheOtherProcessOfACard) {
  const Ring made = Ring::create(name, small_map());
  for (const std::string node : {"machine", "7"}) {
    be_node(node);
    const auto first = start_client(node == "7" ? "client" : node);

    const Finished second = run_client();

    EXPECT_EQ(second.exit_code, 0);
    EXPECT_EQ(second.err, fmt::format("scramnet: node '{}' of ring '{}' is also process {}\n", node,
                                      name, first->pid()));
  }
}

TEST_F(RingUse, KeepsAProgramWhoseForkedChildHasExited) {
  Ring made = Ring::create(name, small_map());
  const auto observer = made.observe();
  be_node("machine");
  const Running program{client("forking")};

  for (int i = 0; i < 5000 && observer.read(rths::LongwordOffset{40}) != 1; ++i) usleep(1000);

  ASSERT_EQ(observer.read(rths::LongwordOffset{40}), 1U);
  EXPECT_TRUE(is_on_ring("machine", program.pid()));
}

TEST_F(RingUse, ReachesARunningRingFromAGtCardByItsName) {
  Ring made = Ring::create(name, small_map());
  const auto observer = made.observe();
  setenv("RTHS_SCGT_RING", name.c_str(), 1);

  const Finished sent = Running{client("gt_sender", {"broadcast", "0", "5"})}.wait();

  EXPECT_EQ(sent.exit_code, 0) << sent.err;
  EXPECT_EQ(observer.read(rths::LongwordOffset{16}), 5U);
}

TEST_F(RingUse, AnnouncesARingThatItMakesWithoutAMap) {
  EXPECT_EQ(run_client().err,
            fmt::format("scramnet: made ring '{}' without a map; to join a run of this name, start "
                        "the run first; RTHS_SCRAMNET_MAP gives a new ring a map\n",
                        name));
  EXPECT_EQ(run_client().err, "");
}

TEST_F(RingUse, MakesARunSayWhichProgramHasItsRing) {
  const auto running = start_client("client");

  const auto error =
      rths::test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); });

  EXPECT_EQ(error,
            fmt::format("ring '{0}' exists already, made by programs written for the cards; "
                        "end client (process {1}); remove it by 'rths clean {0}' and start the "
                        "run before them",
                        name, running->pid()));
}

}  // namespace
