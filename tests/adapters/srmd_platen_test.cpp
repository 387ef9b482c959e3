// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/adapters/srmd.hpp>
#include <rths/experiment/experiment.hpp>

#include "sim/machine/srmd_file.hpp"
#include "support/bench.hpp"

namespace rths::adapters {
namespace {

SrmdPlatenSettings platen_settings() {
  SrmdPlatenSettings s;
  s.machine = test::srmd_machine_with_bearing();
  return s;
}

TEST(SrmdPlaten, MovesToItsReferencesAndMeasures) {
  const auto machine = make_srmd_platen(platen_settings());
  test::Bench bench{*machine};
  bench.in("xpc.long.displ.ref") = 0.05;
  bench.in("xpc.lat.displ.ref") = -0.03;
  bench.in("xpc.yaw.displ.ref") = 0.005;
  for (int i = 0; i < 2000; ++i) static_cast<void>(bench.step(0.001 * i));

  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), 0.05, 0.003);
  EXPECT_NEAR(bench.out("srmd.lat.displ.fbk"), -0.03, 0.003);
  EXPECT_NEAR(bench.out("srmd.yaw.displ.fbk"), 0.005, 0.001);
  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), bench.out("true.displ.long"), 1e-5);
  EXPECT_EQ(bench.out("srmd.long.displ.ref_echo"), 0.05);
  EXPECT_EQ(bench.out("srmd.lift.pressure.fbk"), 8.963e6);
}

TEST(SrmdPlaten, KeepsItsLoadUntilTheControllerWritesOne) {
  const auto machine = make_srmd_platen(platen_settings());
  test::Bench bench{*machine};
  for (int i = 0; i < 500; ++i) static_cast<void>(bench.step(0.001 * i));
  EXPECT_NEAR(bench.out("srmd.compression.force.fbk"), test::kAxialLoad, 0.01 * test::kAxialLoad);

  bench.in("xpc.compression.force.ref") = 8e6;
  for (int i = 500; i < 3000; ++i) static_cast<void>(bench.step(0.001 * i));
  EXPECT_NEAR(bench.out("srmd.compression.force.fbk"), 8e6, 0.03 * 8e6);
}

// User input 1 is the feed-forward at the valves: the platen is less late behind a ramp.
TEST(SrmdPlaten, TakesItsFeedForwardFromUserInputOne) {
  const auto lag = [](double volts) {
    const auto machine = make_srmd_platen(platen_settings());
    test::Bench bench{*machine};
    bench.in("xpc.1.user_input") = volts;
    for (int i = 0; i < 1000; ++i) {
      bench.in("xpc.long.displ.ref") = 0.2e-3 * i;
      static_cast<void>(bench.step(0.001 * i));
    }
    return bench.in("xpc.long.displ.ref") - bench.out("srmd.long.displ.fbk");
  };

  EXPECT_NEAR(lag(0) - lag(4), 0.4 * 0.2 / platen_settings().machine.along_long.position_gain,
              2e-4);
}

TEST(SrmdPlaten, HoldsAndRampsToRestDuringTheStop) {
  const auto machine = make_srmd_platen(platen_settings());
  test::Bench bench{*machine};
  bench.in("xpc.long.displ.ref") = 0.1;
  for (int i = 0; i < 1000; ++i) static_cast<void>(bench.step(0.001 * i));
  bench.in("xpc.long.displ.ref") = -1.0;  // from a failing peer
  bench.in("xpc.compression.force.ref") = 0;

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
  EXPECT_NEAR(bench.out("srmd.long.displ.fbk"), 0, 0.012);
}

TEST(SrmdPlaten, RefusesAnAxisItDoesNotDrive) {
  SrmdPlatenSettings s = platen_settings();
  s.axes = {"roll"};

  EXPECT_EQ(test::error_of([&] { static_cast<void>(make_srmd_platen(s)); }),
            "srmd: axis 'roll' is not driven, expected long or lat");
}

TEST(SrmdPlatenNode, ReadsMachineMemberAndChanges) {
  const std::string file = (test::source_tree() / "sim/machines/srmd.toml").string();
  const auto refusal = [&](const std::string& more) {
    return test::error_of([&] {
      static_cast<void>(
          read_srmd("srmd", Config::parse("model = \"" + file + "\"\n" + more, "n.toml"), {}));
    });
  };

  EXPECT_NE(refusal("family_member = 201").find("family_member"), std::string::npos);
  EXPECT_NE(refusal("[changes.supply]\npressure_Pa = -1").find("n.toml:3"), std::string::npos);
  EXPECT_NE(refusal("[changes.suply]\npressure_Pa = 1").find("suply"), std::string::npos);
  experiment::Experiment setup;
  setup.axes = {"long", "lat"};
  setup.specimen = test::plain_lead_rubber();
  const auto settings = read_srmd(
      "srmd", Config::parse("model = \"" + file + "\"\nfamily_member = 3", "n.toml"), setup);
  EXPECT_TRUE(settings.make != nullptr);
}

}  // namespace
}  // namespace rths::adapters
