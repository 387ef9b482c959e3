// SPDX-License-Identifier: Apache-2.0
//
// Adapters broken on purpose: each breaks exactly its rule.
#include <rths/plugin/conformance.hpp>

#include <sys/prctl.h>
#include <sys/wait.h>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"
#include "support/waiting.hpp"

namespace rths::plugin {
namespace {

struct Broken {
  const char* file;
  const char* rule;
  const char* text;  ///< part of the message
  friend std::ostream& operator<<(std::ostream& out, const Broken& b) { return out << b.file; }
};

class BrokenAdapter : public ::testing::TestWithParam<Broken> {};

std::vector<Finding> findings_of(const std::string& name) {
  ConformanceSettings settings;
  settings.step_deadline = 0.5;
  return check_plugin(test::build_tree() / "broken" / (name + ".so"), settings);
}

TEST_P(BrokenAdapter, BreaksExactlyItsRule) {
  const std::string rule = GetParam().rule;
  if (rule == "allocation" && !test::RealTimeGuard::supported())
    GTEST_SKIP() << "SKIPPED: sanitizers replace the heap";

  for (const auto& finding : findings_of(GetParam().file)) {
    if (finding.rule == rule) {
      EXPECT_EQ(finding.outcome, Finding::Outcome::Fail) << finding.rule << ": " << finding.text;
      EXPECT_NE(finding.text.find(GetParam().text), std::string::npos) << finding.text;
    } else {
      EXPECT_NE(finding.outcome, Finding::Outcome::Fail) << finding.rule << ": " << finding.text;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenAdapter,
    ::testing::Values(Broken{"exports_more", "exports", "another_symbol"},
                      Broken{"no_entry", "abi", "exports no rths_adapter_entry"},
                      Broken{"entry_returns_null", "abi", "returned NULL"},
                      Broken{"wrong_major", "abi", "expected 1.x"},
                      Broken{"struct_too_small", "abi", "struct_size 24"},
                      Broken{"no_name", "abi", "no name"},
                      Broken{"no_step", "abi", "lacks a function"},
                      Broken{"create_fails", "lifecycle", "no licence found"},
                      Broken{"create_fails_silently", "lifecycle", "without a message"},
                      Broken{"activate_fails", "lifecycle", "the amplifier is off"},
                      Broken{"step_returns_unknown", "lifecycle", "returned 17"},
                      Broken{"step_fails", "lifecycle", "the pump is off"},
                      Broken{"no_signals", "signals", "0 signals"},
                      Broken{"no_name_of_a_signal", "signals", "no name"},
                      Broken{"signal_twice", "signals", "listed twice"},
                      Broken{"direction_unknown", "signals", "direction 9"},
                      Broken{"signals_change", "signals", "after activate"},
                      Broken{"unit_not_si", "units", "expected [m]"},
                      Broken{"unit_unknown", "units", "furlongish"},
                      Broken{"initial_outside", "range", "begins with 2"},
                      Broken{"range_reversed", "range", "lowest < highest"},
                      Broken{"step_leaves_its_range", "range", "stated as -1 to 1"},
                      Broken{"step_writes_nan", "nan", "step 100 left nan"},
                      Broken{"step_writes_infinity", "nan", "left inf"},
                      Broken{"step_writes_behind", "bounds", "outside its 3 outputs"},
                      Broken{"step_writes_before", "bounds", "outside its 3 outputs"},
                      Broken{"step_writes_inputs", "bounds", "inputs"},
                      Broken{"create_loops", "deadline", "create did not return"},
                      Broken{"step_loops", "deadline", "step 100 did not return"},
                      Broken{"step_waits", "deadline", "half of the steps"},
                      Broken{"step_is_slow_once", "deadline", "step 99 took"},
                      Broken{"step_is_slow_at_random", "deadline", "steps of two runs took more"},
                      Broken{"step_allocates", "allocation", "step 0 used the heap 2 times"},
                      Broken{"step_allocates_later", "allocation", "step 99"},
                      Broken{"never_rests", "stop", "RTHS_DONE"},
                      Broken{"keeps_its_state", "restart", "initial state"},
                      Broken{"state_is_shared", "instances", "static"},
                      Broken{"uses_the_clock", "determinism", "another process"},
                      Broken{"step_crashes", "crash", "step 100 crashed: Segmentation fault"},
                      Broken{"step_divides_by_zero", "crash", "Floating point exception"},
                      Broken{"create_exits", "crash", "create ended the process with exit code 7"},
                      Broken{"activate_aborts", "crash", "activate crashed: Aborted"},
                      Broken{"deactivate_crashes", "crash", "deactivate crashed"},
                      Broken{"destroys_twice", "crash", "destroy crashed"},
                      Broken{"destructor_aborts", "crash", "exit crashed: Aborted"}),
    [](const auto& broken) { return std::string{broken.param.file}; });

TEST(Conformance, PassesACorrectAdapterByEveryRule) {
  for (const char* name : {"correct", "earlier_minor", "later_minor", "step_is_slow_in_one_run"})
    for (const auto& finding : findings_of(name)) {
      const bool is_counted = finding.rule != "allocation" || test::RealTimeGuard::supported();
      if (!is_counted) continue;
      EXPECT_EQ(finding.outcome, Finding::Outcome::Pass)
          << name << " " << finding.rule << ": " << finding.text;
    }
}

TEST(Conformance, EndsTheProcessesOfThePlugin) {
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // orphans become children of this process

  static_cast<void>(findings_of("create_forks"));

  EXPECT_TRUE(test::comes_true([] { return waitpid(-1, nullptr, WNOHANG) == -1; }));
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

// The project's own controller, machine and recorder, through the same door.
TEST(Conformance, PassesTheNativeControllerMachineAndRecorder) {
  const test::TemporaryFolder folder;
  // The rules write into every word, the operator's stop of the safety layer among them.
  const auto experiment = folder.write(
      "bare.toml", "folder = \"" + (test::source_tree() / "examples").string() + "\"\n" +
                       test::content_of(test::source_tree() / "examples/srmd_lprb_2d.toml") +
                       "\n[node.srmd.safety]\nenabled = false\n");
  for (const char* node : {"xpc", "srmd", "recorder"}) {
    ConformanceSettings settings;
    settings.config = "experiment = \"" + experiment.string() + "\"\nnode = \"" + node + "\"\n";
    if (std::string{node} == "recorder")
      settings.config += "recording = \"" + (folder.path() / "run.h5").string() + "\"\n";
    for (const auto& finding :
         check_plugin(test::build_tree() / "lib/rths/librths_native.so", settings))
      EXPECT_NE(finding.outcome, Finding::Outcome::Fail)
          << node << " " << finding.rule << ": " << finding.text;
  }
}

}  // namespace
}  // namespace rths::plugin
