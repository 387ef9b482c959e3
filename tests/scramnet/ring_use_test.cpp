// SPDX-License-Identifier: Apache-2.0
//
// Programs written for the cards beside a run, and the rings that they leave.
#include <sys/wait.h>

#include <csignal>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "vendor_ring.hpp"

namespace {

using rths::broker::Ring;
using rths::test::Finished;
using rths::test::run_rths;
using rths::test::Running;
using rths::test::small_map;

class RingUse : public rths::test::VendorRing {
 protected:
  void SetUp() override { use(name); }
  void TearDown() override {
    for (const char* variable : {"RTHS_SCRAMNET_NODE", "RTHS_SCRAMNET_SHARE"}) unsetenv(variable);
    rths::broker::remove_ring(name);
    use(ring());
  }
  static void be_node(const std::string& node) { setenv("RTHS_SCRAMNET_NODE", node.c_str(), 1); }
  /// A client that stores two words and ends.
  static Finished run_client() { return Running{client("peer", {"40", "2", "0"})}.wait(); }
  /// Starts a client that stays on the ring, and waits until it is there.
  [[nodiscard]] std::unique_ptr<Running> start_client(const std::string& node) const {
    auto started = std::make_unique<Running>(client("peer", {"40", "900", "20000"}));
    for (int i = 0; i < 5000 && !is_on_ring(node, started->pid()); ++i) usleep(1000);
    EXPECT_TRUE(is_on_ring(node, started->pid()));
    return started;
  }
  [[nodiscard]] bool is_on_ring(const std::string& node, int pid) const {
    const auto report = rths::broker::inspect_ring(name);
    if (!report || report->cards == 0) return false;
    for (const auto& occupant : report->occupants)
      if (occupant.node == node && occupant.pid == pid) return true;
    return false;
  }

  std::string name = ring() + "_use";
};

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

  EXPECT_EQ(error, fmt::format("ring '{0}' exists already, made by programs written for the cards; "
                               "end client (pid {1}); remove it by 'rths clean {0}' and start the "
                               "run before them",
                               name, running->pid()));
}

TEST_F(RingUse, KeepsIdleCardsUntilTheirRingIsNamed) {
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

TEST_F(RingUse, KeepsANamedRingThatIsInUse) {
  const auto running = start_client("client");

  const Finished clean = run_rths({"clean", name});

  EXPECT_EQ(clean.exit_code, 1);
  EXPECT_EQ(clean.out, fmt::format("kept {}: processes use it\n", name));
  EXPECT_EQ(run_rths({"clean", "no_such_ring"}).err, "rths: there is no ring 'no_such_ring'\n");
}

// The ring of a run that crashed is removed, although a card was on it.
TEST_F(RingUse, DoesNotKeepCardsOfACrashedRun) {
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
