// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/gtest.hpp>

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <limits>
#include <thread>

#include <gtest/gtest-spi.h>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/waiting.hpp"
#include "testkit/src/link.hpp"

namespace rths::testkit {
namespace {

std::string two_signals() {
  return (test::source_tree() / "examples/python/two_signals.ringmap.toml").string();
}

/// A machine of the C++ API: answers each command with the force of a spring of 1 MN/m.
Program spring(bool is_linked = false) {
  return {"machine", {(test::build_tree() / "bin/rths_test_spring").string(), "{ring}"}, is_linked};
}

class LaboratoryOfATest : public LaboratoryTest {
 protected:
  Laboratory& with_spring(bool is_linked = false) {
    auto& lab = laboratory(two_signals(), 20);
    lab.start(spring(is_linked));
    solver_ = lab.join("solver");
    move(0.01);
    lab.expect_within(5, "machine.force", 1e4);
    return lab;
  }
  void move(double displacement) { solver_->write("solver.displacement", displacement); }

 private:
  std::unique_ptr<SignalNode> solver_;
};

TEST_F(LaboratoryOfATest, HasAProgramThatAnswers) {
  with_spring();
  move(0.1);
  expect_within(5, "machine.force", {1e5, 10});
  never(0.02, "machine.force", above(1.1e5));
}

TEST_F(LaboratoryOfATest, CarriesTheMessagesOfALinkedProgramInBothDirections) {
  with_spring(true);
  for (const double displacement : {0.02, 0.03, 0.04}) {
    move(displacement);
    expect_within(5, "machine.force", 1e6 * displacement);
  }
}

/// The message of a check; empty if it passes.
std::string failure_of(const std::function<void()>& check) { return test::error_of(check); }

/// Stores into a word of the solver through a plain pointer, as a program of the cards.
void steal(const std::string& name, std::uint32_t value) {
  auto ring = broker::Ring::attach(name);
  auto thief = ring.join_plain("");
  const auto offset =
      ring.map().entry(ring.map().signal("solver.displacement")).signal->offset.value();
  std::atomic_ref{thief.plain_memory()[offset]}.store(value);
  std::this_thread::sleep_for(
      std::chrono::milliseconds{150});  // its name is known while it is there
}

TEST_F(LaboratoryOfATest, NamesAProcessThatStoresIntoTheWordOfAnother) {
  auto& lab = with_spring();
  steal(lab.name(), 0x40000000);

  const std::string found = failure_of([&] { lab.check_programs(); });

  EXPECT_TRUE(found.starts_with("solver.displacement: stored as ")) << found;
  EXPECT_NE(found.find("by a client (process " + std::to_string(getpid()) + ") at "),
            std::string::npos)
      << found;
  EXPECT_TRUE(found.ends_with("expected stores by its owner solver alone")) << found;
  EXPECT_EQ(failure_of([&] { lab.never(0.01, "machine.force", above(1e9)); }), found);
  EXPECT_EQ(failure_of([&] { lab.check_owners(); }), found);
  lab.close();  // the end of this test would fail
}

TEST_F(LaboratoryOfATest, JudgesTheStoresOfTheLastMoment) {
  auto& lab = with_spring();
  EXPECT_EQ(failure_of([&] { lab.check_owners(); }), "");
  auto ring = broker::Ring::attach(lab.name());
  auto thief = ring.join_plain("");
  const auto offset =
      ring.map().entry(ring.map().signal("solver.displacement")).signal->offset.value();
  std::atomic_ref{thief.plain_memory()[offset]}.store(0x40000000);

  EXPECT_NE(failure_of([&] { lab.check_owners(); }), "");
  lab.close();
}

// A word between those of the SRMD's nodes.
TEST_F(LaboratoryOfATest, NamesAStoreIntoAWordThatNobodyOwns) {
  auto& lab = laboratory((test::source_tree() / "memmap/maps/srmd.ringmap.toml").string(), 20);
  auto ring = broker::Ring::attach(lab.name());
  auto thief = ring.join_plain("");
  std::atomic_ref{thief.plain_memory()[20]}.store(7);

  const std::string found = failure_of([&] { lab.check_owners(); });

  EXPECT_TRUE(found.starts_with("longword 20: stored as 0x00000007 by ")) << found;
  EXPECT_TRUE(found.ends_with("expected no store, because no node owns the word")) << found;
  lab.close();
}

TEST_F(LaboratoryOfATest, NamesALinkedProgramThatStoresIntoTheWordOfAnother) {
  auto& lab = with_spring(true);
  steal(lab.name() + ".machine", 0x40000000);

  EXPECT_TRUE(failure_of([&] { lab.check_programs(); }).starts_with("solver.displacement: "));
  lab.close();
}

/// The map of these tests without the words of one node.
std::string without_words_of(const std::string& node, const test::TemporaryFolder& folder) {
  auto description = memmap::load_map(two_signals()).description();
  std::erase_if(description.partitions, [&](const auto& part) { return part.node == node; });
  return folder.write("one_node.toml", memmap::Map{description}.to_toml()).string();
}

TEST_F(LaboratoryOfATest, CarriesTheMessagesOfTheOnlyNodeWithWords) {
  const test::TemporaryFolder folder;
  auto& lab = laboratory(without_words_of("machine", folder), 20);
  const std::string pusher = (test::build_tree() / "bin/rths_test_pusher").string();
  lab.start({"solver", {pusher, "{ring}"}, true});
  expect_within(5, "solver.displacement", {0.1, 1e-6});
  lab.expect_end(5, "solver");
}

TEST_F(LaboratoryOfATest, CarriesTheMessagesOfOthersToANodeWithoutWords) {
  const test::TemporaryFolder folder;
  auto& lab = laboratory(without_words_of("machine", folder), 20);
  Link link{lab.name(), lab.ring()->map(), "machine"};
  auto image = broker::Ring::attach(link.image());
  const auto machine = image.join("machine", 0);
  const auto offset = lab.ring()->entry("solver.displacement").signal->offset;
  const auto before = machine.read(offset);
  const auto solver = lab.join("solver");
  solver->write("solver.displacement", 0.1);

  EXPECT_TRUE(test::comes_true([&] { return machine.read(offset) != before; }));
  EXPECT_TRUE(
      test::comes_true([&] { return lab.ring()->observe()->presence_of("machine") == "alive"; }));
  EXPECT_EQ(link.trouble(), "");
}

TEST_F(LaboratoryOfATest, DropsMessagesUntilTheyAreRestored) {
  auto& lab = with_spring(true);
  lab.drop("machine");
  move(0.02);
  never(0.05, "machine.force", 2e4);
  lab.restore("machine");
  move(0.03);
  expect_within(5, "machine.force", 3e4);
}

TEST_F(LaboratoryOfATest, FlipsABitOfASignal) {
  auto& lab = with_spring(true);
  lab.flip("machine.force", 31);
  move(0.02);
  expect_within(5, "machine.force", {-2e4, 1});
}

TEST_F(LaboratoryOfATest, DelaysMessages) {
  auto& lab = with_spring(true);
  lab.delay("machine", 0.1);
  move(0.02);
  never(0.08, "machine.force", 2e4);
  expect_within(5, "machine.force", 2e4);
}

TEST_F(LaboratoryOfATest, FreezesAndThawsAProgram) {
  auto& lab = with_spring();
  lab.freeze("machine");
  move(0.02);
  never(0.03, "machine.force", 2e4);
  lab.thaw("machine");
  expect_within(5, "machine.force", 2e4);
}

TEST_F(LaboratoryOfATest, HasAProgramOfTheVendorsApi) {
  auto& lab = laboratory(two_signals(), 20);
  lab.start({"machine", {(test::build_tree() / "bin/rths_test_vendor_spring").string()}});
  const auto solver = lab.join("solver");
  solver->write("solver.displacement", 0.1);
  expect_within(5, "machine.force", {1e5, 10});
  lab.freeze("machine");
  solver->write("solver.displacement", 0.2);
  never(0.03, "machine.force", 2e5);
  lab.thaw("machine");
  expect_within(5, "machine.force", {2e5, 10});
}

TEST_F(LaboratoryOfATest, DamagesTheMessagesOfAProgramOfTheVendorsApi) {
  auto& lab = laboratory(two_signals(), 20);
  lab.start({"machine", {(test::build_tree() / "bin/rths_test_vendor_spring").string()}, true});
  const auto solver = lab.join("solver");
  lab.flip("machine.force", 31);
  solver->write("solver.displacement", 0.1);
  expect_within(5, "machine.force", {-1e5, 10});
  lab.drop("machine");
  solver->write("solver.displacement", 0.2);
  never(0.05, "machine.force", below(-1.5e5));
}

TEST_F(LaboratoryOfATest, SaysWhichExpectationIsNotMet) {
  auto& lab = with_spring();
  EXPECT_EQ(test::error_of([&] {
              lab.expect_within(0.02, "machine.force", {5e4, 1});
            }),
            "machine.force: expected 50000 N ± 1 within 0.02 s, last value 10000 N");
  EXPECT_NE(test::error_of([&] {
              lab.never(1, "machine.force", below(2e4));
            }).find("machine.force: expected never below 20000, found 10000 N"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { lab.eventually("machine.forse", 1); }).find("machine.force"),
            std::string::npos);
  EXPECT_NONFATAL_FAILURE(expect_within(0.01, "machine.force", 7), "last value 10000 N");
}

TEST_F(LaboratoryOfATest, FailsIfAProgramFails) {
  auto& lab = with_spring();
  lab.start({"", {"sh", "-c", "echo no licence; exit 3"}, false, "model"});
  EXPECT_NE(test::error_of([&] {
              lab.never(5, "machine.force", 1);
            }).find("program 'model' ended with 3: no licence"),
            std::string::npos);
}

TEST_F(LaboratoryOfATest, RefusesMessageFaultsOfAProgramThatIsNotLinked) {
  auto& lab = with_spring();
  EXPECT_EQ(test::error_of([&] { lab.drop("machine"); }),
            "the program of node 'machine' is not linked, so its messages cannot be changed");
}

TEST_F(LaboratoryOfATest, RefusesTimesThatAreNone) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  auto& lab = with_spring(true);
  EXPECT_EQ(test::error_of([&] { lab.delay("machine", kInfinity); }),
            "the delay is inf s, expected 0 to 1000000 s");
  Program late{"", {"true"}, false, "late"};
  late.ready_s = -1;
  EXPECT_EQ(test::error_of([&] { lab.start(late); }), "ready_s is -1 s, expected 0 to 1000000 s");
  EXPECT_EQ(test::error_of([&] { lab.expect_within(kInfinity, "machine.force", 7); }),
            "the time is inf s, expected 0 to 1000000 s");
  EXPECT_EQ(test::error_of([&] {
              const Laboratory endless{lab.folder(), two_signals(), kInfinity};
            }),
            "deadline_s is inf s, expected 0 to 1000000 s");
}

TEST_F(LaboratoryOfATest, IsUsableAfterALinkThatCouldNotBeMade) {
  auto& lab = laboratory(two_signals(), 20);
  {
    const auto taken = broker::Ring::create(lab.name() + ".machine", lab.ring()->map());
    EXPECT_NE(test::error_of([&] { lab.start(spring(true)); }).find("is in use"),
              std::string::npos);
  }
  lab.check_programs();
  EXPECT_NE(test::error_of([&] { lab.drop("machine"); }).find("is not linked"), std::string::npos);
  lab.start(spring(true));
  lab.drop("machine");
}

TEST(Laboratory, LeavesNothingBehind) {
  const test::TemporaryFolder folder;
  std::string name;
  int pid = 0;
  {
    Laboratory lab{folder.path(), two_signals()};
    name = lab.name();
    lab.start(spring(true));
    lab.start({"", {"sh", "-c", "sleep 60 & echo $!; exit 0"}, false, "wrapper"});
    lab.expect_end(5, "wrapper");
    pid = std::stoi(lab.log("wrapper"));
    EXPECT_TRUE(test::is_running(pid));
  }
  EXPECT_TRUE(test::comes_true([&] { return !test::is_running(pid); }));
  for (const auto& report : broker::list_rings())
    EXPECT_FALSE(report.name.starts_with(name)) << report.name;
}

// `rths test` is killed; its program is a shell with a child of its own.
TEST(Laboratory, EndsAllProcessesOfATestThatWasKilled) {
  const test::TemporaryFolder folder;
  const auto pids = folder.path() / "pids";
  const auto file = folder.write(
      "killed.toml", "format = 1\nname = \"killed\"\ndeadline_s = 60\nmap = \"" + two_signals() +
                         "\"\n[[program]]\nnode = \"machine\"\ncommand = [\"sh\", \"-c\", "
                         "\"sleep 60 & echo $! $$ > " +
                         pids.string() + ".part; mv " + pids.string() + ".part " + pids.string() +
                         "; wait\"]\n" +
                         "[[expect]]\nsignal = \"machine.force\"\nabove = 1\nwithin_s = 60\n");
  test::Running running{
      {test::rths_command(), "test", file.string(), "--keep", (folder.path() / "kept").string()}};
  ASSERT_TRUE(test::comes_true([&] { return std::filesystem::exists(pids); }));
  int child = 0, program = 0;
  ASSERT_EQ(std::sscanf(test::content_of(pids).c_str(), "%d %d", &child, &program), 2);
  ASSERT_TRUE(test::is_running(child));

  kill(running.pid(), SIGKILL);
  EXPECT_TRUE(test::comes_true([&] { return !test::is_running(child); }));
  EXPECT_TRUE(test::comes_true([&] { return !test::is_running(program); }));
}

TEST(Laboratory, RemovesTheRingsOfATestThatWasKilled) {
  const test::TemporaryFolder folder;
  const std::string dead =
      "test_4194304_of_a_test_that_was_killed";  // above the largest process id
  { const auto ring = broker::Ring::create(dead, memmap::load_map(two_signals())); }
  ASSERT_TRUE(broker::inspect_ring(dead));
  { const Laboratory lab{folder.path(), two_signals()}; }
  EXPECT_FALSE(broker::inspect_ring(dead));
}

TEST(Laboratory, KeepsEveryChangeInItsRecording) {
  const test::TemporaryFolder folder;
  Laboratory lab{folder.path(), two_signals()};
  const auto solver = lab.join("solver");
  for (int i = 1; i <= 100; ++i) solver->write("solver.displacement", 0.001 * i);
  lab.keep();

  const recording::Reader recorded{folder.path() / "run.h5"};
  const auto values = recorded.signal("solver.displacement");
  ASSERT_EQ(values.size(), 101U);
  for (int i = 0; i <= 100; ++i) EXPECT_NEAR(values[static_cast<std::size_t>(i)], 0.001 * i, 1e-6);
}

// A node of strangers that writes another node's word, where present.
class StrangersPump : public LaboratoryTest {};

TEST_F(StrangersPump, IsNamedWhenItWritesTheWordOfAnother) {
  const auto data = test::source_tree() / "../shared/data/strangers/kit";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "SKIPPED: there is no " << data;
  const test::TemporaryFolder folder;
  const auto library = test::build_tree() / "broker/scramnet";
  const std::string pump = (folder.path() / "pump").string();
  const auto compiled = test::Running{
      {"/usr/bin/cc", (data / "pump.c").string(),
       "-I" + (test::source_tree() / "broker/scramnet/include/scramnet").string(),
       "-L" + library.string(), "-Wl,-rpath," + library.string(), "-lplus", "-o",
       pump}}.wait();
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  auto& lab = laboratory((data / "pump.ringmap.toml").string(), 20);
  lab.start({"pump", {pump, "owner"}});
  const auto plc = lab.join("plc");
  plc->write("plc.speed", 50.0);

  const std::string found = failure_of([&] { lab.never(3, "plc.speed", above(1001)); });

  EXPECT_TRUE(found.starts_with("plc.speed: stored as 999 rad/s by pump (process ")) << found;
  EXPECT_TRUE(found.ends_with("expected stores by its owner plc alone")) << found;
  lab.close();
}

}  // namespace
}  // namespace rths::testkit
