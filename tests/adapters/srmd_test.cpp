// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/adapters/srmd.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::adapters {
namespace {

SrmdSettings srmd_settings() {
  SrmdSettings s;
  s.machine = sim::srmd_machine();
  s.machine.noise = {0, 0, 0};
  s.machine.specimen = test::plain_lead_rubber();
  return s;
}

TEST(Srmd, MovesToItsReferencesAndMeasures) {
  const auto machine = make_srmd(srmd_settings());
  test::Bench bench{*machine};
  bench.in("xpc.long.displ.ref") = 0.05;
  bench.in("xpc.lat.displ.ref") = -0.03;
  for (int i = 0; i < 2000; ++i) static_cast<void>(bench.step(0.001 * i));

  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), 0.05, 0.004);
  EXPECT_NEAR(bench.out("srmd.lat.displ.fbk"), -0.03, 0.004);
  EXPECT_NEAR(bench.out("srmd.long.force.fbk"), bench.out("true.force.long") + 2000, 6000);
  EXPECT_EQ(bench.out("srmd.long.displ.ref_echo"), 0.05);
}

TEST(Srmd, AnswersItsVerticalAndUserWords) {
  const auto machine = make_srmd(srmd_settings());
  test::Bench bench{*machine};
  bench.in("xpc.compression.force.ref") = 9e6;
  bench.in("xpc.3.user_input") = 1.5;
  for (int i = 0; i < 1000; ++i) static_cast<void>(bench.step(0.001 * i));

  EXPECT_NEAR(bench.out("srmd.compression.force.fbk"), 9e6, 1e3);
  EXPECT_NEAR(bench.out("srmd.ne.outrigger.force.fbk"), 9e6 / 4, 1e3);
  EXPECT_EQ(bench.out("srmd.3.user_input_echo"), 1.5);
  EXPECT_GT(bench.out("srmd.lift.pressure.fbk"), 0);
}

TEST(Srmd, LoadsAnEmptyTableThroughRollersOnly) {
  for (const bool has_rollers : {true, false}) {
    SrmdSettings s = srmd_settings();
    s.machine.has_specimen = false;
    s.machine.has_rollers = has_rollers;
    const auto machine = make_srmd(s);
    test::Bench bench{*machine};
    bench.in("xpc.compression.force.ref") = 9e6;
    for (int i = 0; i < 2000; ++i) static_cast<void>(bench.step(0.001 * i));

    EXPECT_NEAR(bench.out("srmd.compression.force.fbk"), has_rollers ? 9e6 : 0, 1e3);
  }
}

TEST(Srmd, ClampsItsLoadToTheVerticalCapacity) {
  const auto machine = make_srmd(srmd_settings());
  test::Bench bench{*machine};
  bench.in("xpc.compression.force.ref") = 112e6;
  Status status = Status::Ok;
  for (int i = 0; i < 2000; ++i) status = bench.step(0.001 * i);

  EXPECT_EQ(status, Status::LimitExceeded);
  EXPECT_NEAR(bench.out("srmd.compression.force.fbk"), 53.4e6, 1e3);
  EXPECT_EQ(bench.out("srmd.compression.force.ref_echo"), 112e6);

  SrmdSettings heavy = srmd_settings();
  heavy.machine.specimen.axial_load = 60e6;
  EXPECT_EQ(test::error_of([&] { static_cast<void>(make_srmd(heavy)); }),
            "srmd: the specimen carries 60 MN, expected at most 53.4 MN");
}

TEST(Srmd, KeepsAnAxisAtRestThatIsNotTested) {
  SrmdSettings s = srmd_settings();
  s.axes = {"long"};
  const auto machine = make_srmd(s);
  test::Bench bench{*machine};
  bench.in("xpc.lat.displ.ref") = 0.1;
  for (int i = 0; i < 500; ++i) static_cast<void>(bench.step(0.001 * i));

  EXPECT_NEAR(bench.out("srmd.lat.displ.fbk"), 0, 1e-3);
}

// During the stop it ignores its inputs: it holds, ramps down, and returns Done.
TEST(SrmdAdapter, HoldsCommandAndRampsToRestDuringTheStop) {
  const auto machine = make_srmd(srmd_settings());
  test::Bench bench{*machine};
  bench.in("xpc.long.displ.ref") = 0.1;
  for (int i = 0; i < 1000; ++i) static_cast<void>(bench.step(0.001 * i));
  bench.in("xpc.long.displ.ref") = -1.0;  // invalid value from a failing peer

  double time = 1.0;
  Status status = Status::Ok;
  double lowest = 1;
  while (status != Status::Done && time < 5) {
    status = bench.step(time, true);
    lowest = std::min(lowest, bench.out("srmd.long.displ.fbk"));
    time += 0.001;
  }

  EXPECT_NEAR(time, 2.2, 0.01);
  EXPECT_GT(lowest, -0.01);
  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), 0, 0.01);
}

TEST(Srmd, ReportsALimitThatWasHit) {
  const auto machine = make_srmd(srmd_settings());
  test::Bench bench{*machine};
  bench.in("xpc.lat.displ.ref") = 0.7;

  EXPECT_EQ(bench.step(0), Status::LimitExceeded);
}

TEST(Srmd, RefusesAnAxisItDoesNotDrive) {
  SrmdSettings s = srmd_settings();
  s.axes = {"roll"};

  EXPECT_EQ(test::error_of([&] { static_cast<void>(make_srmd(s)); }),
            "srmd: axis 'roll' is not driven, expected long or lat");
}

}  // namespace
}  // namespace rths::adapters
