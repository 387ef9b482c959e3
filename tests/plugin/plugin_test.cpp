// SPDX-License-Identifier: Apache-2.0
//
// A plugin as an adapter, in this process and in one of its own: its faults end the step, not the
// process, and name plugin and reason.
#include <rths/plugin/plugin_adapter.hpp>

#include <cstdlib>

#include <gtest/gtest.h>

#include <rths/plugin/child_adapter.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::plugin {
namespace {

PluginSettings settings_of(const std::string& name) {
  PluginSettings settings;
  settings.library = test::build_tree() / "broken" / (name + ".so");
  settings.step_deadline = 1;
  return settings;
}

std::unique_ptr<adapters::Adapter> make(const std::string& name, bool in_child) {
  if (!in_child) return make_plugin(settings_of(name));
  ChildSettings child;
  child.title = "child";
  child.step_deadline = 5;
  return make_child([name] { return make_plugin(settings_of(name)); }, child);
}

/// Steps until a fault. @returns its message; empty without one
std::string fault_of(const std::string& name, bool in_child) {
  const auto adapter = make(name, in_child);
  adapter->activate();
  test::Bench bench{*adapter};
  bench.in("xpc.long.displ.ref") = 0.01;
  for (int i = 0; i < 120; ++i) {
    const double before = bench.out("srmd.long.displ.fbk");
    if (bench.step(0.001 * i) != Status::Fault) continue;
    EXPECT_EQ(bench.out("srmd.long.displ.fbk"), before) << "keeps the last valid value";
    EXPECT_EQ(bench.step(0.001 * (i + 1)), Status::Fault) << "is not called again";
    const std::string message = bench.message();
    adapter->deactivate();
    return message;
  }
  adapter->deactivate();
  return "";
}

class EveryProcess : public ::testing::TestWithParam<bool> {};

// The leak sanitizer finds the memory of a plugin that crashed in this process.
bool is_tried(bool in_child) { return in_child || test::RealTimeGuard::supported(); }
constexpr const char* kSkipped = "SKIPPED: a plugin that crashed keeps its memory";

TEST_P(EveryProcess, NamesThePluginAndItsFault) {
  if (!is_tried(GetParam())) GTEST_SKIP() << kSkipped;
  const auto expect = [&](const std::string& name, const std::string& reason) {
    EXPECT_EQ(fault_of(name, GetParam()), "plugin 'lag' (" + name + ".so): " + reason);
  };
  expect("step_crashes", "its step crashed: Segmentation fault");
  expect("step_divides_by_zero", "its step crashed: Floating point exception");
  expect("step_writes_nan", "its step wrote nan to 'srmd.long.displ.fbk', expected a number");
  expect("step_leaves_its_range",
         "its step wrote 1.5 to 'srmd.long.displ.fbk', which it states as -1 to 1");
  expect("step_writes_behind", "its step wrote beyond its 3 outputs");
  expect("step_fails", "the pump is off");
  expect("step_returns_unknown", "its step returned status 17, expected 0 to 4");
  if (test::RealTimeGuard::supported())
    expect("step_allocates_later", "its step used the heap 2 times, expected none");
}

TEST_P(EveryProcess, EndsAStepThatLoopsForEver) {
  if (!is_tried(GetParam())) GTEST_SKIP() << kSkipped;
  EXPECT_EQ(fault_of("step_loops", GetParam()),
            "plugin 'lag' (step_loops.so): its step did not return within 1 s");
}

TEST_P(EveryProcess, SaysWhyAPluginCannotBeUsed) {
  if (!is_tried(GetParam())) GTEST_SKIP() << kSkipped;
  const auto error = [&](const std::string& name) {
    return test::error_of([&] { make(name, GetParam())->activate(); });
  };
  EXPECT_EQ(error("create_fails"),
            "plugin 'lag' (create_fails.so): no licence found, expected one");
  EXPECT_EQ(error("activate_fails"), "plugin 'lag' (activate_fails.so): the amplifier is off");
  EXPECT_EQ(error("signals_change"),
            "plugin 'lag' (signals_change.so): lists other signals after activate, expected the "
            "same ones");
  EXPECT_EQ(error("activate_aborts"),
            "plugin 'lag' (activate_aborts.so): activate crashed: Aborted");
}

TEST(Child, ThatExitsIsNotCalledLate) {
  ChildSettings settings;
  settings.title = "child";
  const auto exits = []() -> std::unique_ptr<adapters::Adapter> { std::_Exit(0); };

  EXPECT_EQ(test::error_of([&] { static_cast<void>(make_child(exits, settings)); }),
            "child: create ended its process with exit code 0");
}

TEST_P(EveryProcess, GivesTheSameValues) {
  const auto reference = make("correct", false);
  const auto adapter = make("correct", GetParam());
  test::Bench expected{*reference}, bench{*adapter};
  reference->activate();
  adapter->activate();
  for (int i = 0; i < 50; ++i) {
    expected.in("xpc.long.displ.ref") = bench.in("xpc.long.displ.ref") = 0.001 * i;
    ASSERT_EQ(expected.step(0.001 * i), bench.step(0.001 * i));
    EXPECT_EQ(expected.outputs(), bench.outputs());
  }
}

TEST_P(EveryProcess, ComesToRestByItsOwnStop) {
  const auto adapter = make("correct", GetParam());
  adapter->activate();
  test::Bench bench{*adapter};
  Status status = bench.step(0);
  for (int i = 1; i < 100 && status != Status::Done; ++i) status = bench.step(0.001 * i, true);

  EXPECT_EQ(status, Status::Done);
}

INSTANTIATE_TEST_SUITE_P(Plugins, EveryProcess, ::testing::Bool(), [](const auto& in_child) {
  return std::string{in_child.param ? "InItsOwn" : "InThisOne"};
});

TEST(Plugin, IsRampedToRestWithoutAStopOfItsOwn) {
  const auto adapter = make("earlier_minor", false);
  adapter->activate();
  test::Bench bench{*adapter};
  bench.in("xpc.long.displ.ref") = 0.01;
  double time = 0;
  for (int i = 0; i < 200; ++i) EXPECT_EQ(bench.step(time += 0.001), Status::Ok);
  const double held = bench.out("srmd.long.displ.fbk");
  ASSERT_GT(held, 0.009);
  EXPECT_EQ(bench.step(time, true), Status::Ok);
  EXPECT_EQ(bench.out("srmd.long.displ.fbk"), held);
  EXPECT_EQ(bench.step(time + 0.7, true), Status::Ok);
  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), held / 2, 1e-12);
  EXPECT_EQ(bench.step(time + 1.2, true), Status::Done);
  EXPECT_EQ(bench.out("srmd.long.displ.fbk"), 0);
}

TEST(Plugin, MustComeToRestInTime) {
  const auto adapter = make("never_rests", false);
  adapter->activate();
  test::Bench bench{*adapter};
  EXPECT_EQ(bench.step(0, true), Status::Ok);
  EXPECT_EQ(bench.step(1.8, true), Status::Fault);
  EXPECT_STREQ(bench.message(),
               "plugin 'lag' (never_rests.so): was not at rest 1.7 s after the stop");
}

TEST(Plugin, StepsInRealTime) {
  const auto adapter = make("correct", false);
  adapter->activate();
  test::Bench bench{*adapter};
  Status status = Status::Ok;
  EXPECT_REALTIME(status = bench.step(0));
  EXPECT_EQ(status, Status::Ok);
}

}  // namespace
}  // namespace rths::plugin
