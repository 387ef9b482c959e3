// SPDX-License-Identifier: Apache-2.0
//
// The lateness of a host in the closed loop of a budget, made on purpose in virtual time.
#include <cmath>

#include <gtest/gtest.h>

#include "closed_loop_run.hpp"

namespace rths::budget {
namespace {

using test::apart;
using test::ClosedLoop;

/// Its time does not stand still while its host is late.
const std::vector<std::pair<std::string, std::string>> kRealMachine{
    {"node.srmd.late_inputs", "newest"}};

/// A host that stops one node, or all of them, for 5 to 9 ms, four times a second. After a common
/// stop, the nodes start again one after the other.
Duration stalls(const std::string& node, Duration due) {
  struct Stall {
    const char* node;      // "": all
    double from, seconds;  // within each second
  };
  constexpr Stall kStalls[] = {{"srmd", 0.1003, 0.0052},
                               {"xpc", 0.3101, 0.0064},
                               {"", 0.5202, 0.0089},
                               {"opf", 0.7504, 0.0071}};
  const double turn = node == "srmd" ? 0 : node == "xpc" ? 5e-5 : node == "opf" ? 1e-4 : 1.5e-4;
  const double time = std::fmod(to_seconds(due), 1.0);
  double late = 0;
  for (const auto& stall : kStalls) {
    const bool stops = stall.node[0] == '\0' || node == stall.node;
    const double end = stall.from + stall.seconds + turn;
    if (stops && time >= stall.from && time < end) late = end - time;
  }
  return from_seconds(late);
}

// While all nodes are late, rows are missing, and the lead of these ticks is interpolated.
TEST_F(ClosedLoop, ReproducesALateHost) {
  make(false, kRealMachine, stalls);
  ASSERT_FALSE(hybrid.host.order.machine_before.empty());

  EXPECT_LT(difference(closed_loop(hybrid, kAll)), 1e-3);
  EXPECT_GT(difference(closed_loop(hybrid, kAll & ~only(Part::Host))), 3e-3);
}

TEST_F(ClosedLoop, NamesTheLatenessOfTheHostAsAShare) {
  make(true, kRealMachine, stalls);
  const recording::Reader run{folder / "run.h5"};

  const auto found = session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr);

  for (const auto& axis : found.axes) {
    double sum = axis.remainder;
    for (const double share : axis.share) sum += share;
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_LT(axis.after, 0.03) << name_of(axis.axis);
    EXPECT_NE(axis.share[static_cast<std::size_t>(Part::Host)], 0) << name_of(axis.axis);
  }
}

/// A recorder that pauses once for 75 ms: at rest, or in strong motion.
Duration pause(const std::string& node, Duration due, double from) {
  constexpr double kLength = 0.075;  // [s]
  const double time = to_seconds(due);
  const bool pauses = node == "recorder" && time >= from && time < from + kLength;
  return from_seconds(pauses ? from + kLength - time : 0);
}

// Pauses of 50 ms once a second change a share by up to 0.07, and pauses of 100 ms by 0.3.
TEST_F(ClosedLoop, HasNoBudgetIfTheRecordingMissesManyIntegrationSteps) {
  make(true, {}, [](const auto& node, Duration due) { return pause(node, due, 5.6003); });
  const recording::Reader run{folder / "run.h5"};

  const std::string error = test::error_of([&] {
    static_cast<void>(session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr));
  });

  EXPECT_EQ(error,
            "the recording has no row from 5.600 s to 5.675 s, 75 ms of node 'xpc', expected gaps "
            "of at most 50 ms");
}

TEST_F(ClosedLoop, HasABudgetIfTheRecorderPausesBeforeTheFirstTarget) {
  make(true, {}, [](const auto& node, Duration due) { return pause(node, due, 0.2003); });
  const recording::Reader run{folder / "run.h5"};

  EXPECT_FALSE(session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr).is_empty());
}

/// A host that makes one step of each node late by 0.9 ms, four times a second: less than a period.
Duration delays(const std::string& node, Duration due) {
  const double time = to_seconds(due);
  const auto quarter = static_cast<long>(time / 0.25);
  const long stride = node == "srmd" ? 37 : node == "xpc" ? 101 : 173;  // coprime to 240
  const double at =
      0.25 * static_cast<double>(quarter) + 1e-3 * static_cast<double>(stride * quarter % 240);
  const bool is_late = quarter > 0 && time >= at && time < at + 0.00099;
  return from_seconds(is_late ? 0.0009 : 0);
}

/// The test with an actuator whose simulation is late by a period, always.
HybridTest with_late_actuator(HybridTest hybrid) {
  sim::TermSettings delay;
  delay.kind = delay.name = "actuator_delay";
  delay.axes = 3;
  delay.parameters = {{"delay", hybrid.period}};
  hybrid.machine_simulated.terms.push_back(delay);
  return hybrid;
}

// Some late steps change the loop less than an actuator that is late in all steps, whichever parts
// are as simulated: an ideal transfer system, too, leaves the platen at rest for a tick, but does
// not stop it and make it jump.
TEST_F(ClosedLoop, BearsALatenessBelowAPeriodWithEverySetOfParts) {
  make(true, kRealMachine, delays);
  ASSERT_FALSE(hybrid.host.order.machine_before.empty());
  const HybridTest late_actuator = with_late_actuator(hybrid);

  for (Parts parts = kNone; parts < only(Part::Host); ++parts) {
    if (has(parts, Part::Tracking)) continue;
    const Response punctual = closed_loop(hybrid, parts);
    const Response late = closed_loop(hybrid, parts | only(Part::Host));
    const Response later = closed_loop(late_actuator, parts);
    for (const std::size_t axis : {0U, 1U}) {
      EXPECT_GT(apart(punctual[axis], late[axis]), 0) << parts;
      EXPECT_LT(apart(punctual[axis], late[axis]), apart(punctual[axis], later[axis])) << parts;
    }
  }
}

// 0.02 is the share that the sentence of a budget names.
TEST_F(ClosedLoop, GivesALatenessBelowAPeriodNoShareWorthNaming) {
  make(true, kRealMachine, delays);
  const recording::Reader run{folder / "run.h5"};

  const auto found = session::budget_of_run(experiment, as_in_the_laboratory(), run, nullptr);

  for (const auto& axis : found.axes) {
    const double share = axis.share[static_cast<std::size_t>(Part::Host)];
    EXPECT_NE(share, 0) << name_of(axis.axis);
    EXPECT_LT(std::abs(share), 0.02) << name_of(axis.axis);
  }
}

}  // namespace
}  // namespace rths::budget
