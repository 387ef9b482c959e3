// SPDX-License-Identifier: Apache-2.0
//
// The blocks of a controller, and the diagram of the hybrid controller.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/adapters/simulink_like.hpp>

#include "diagrams.hpp"
#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::adapters {
namespace {

using namespace diagrams;

const std::string kForceOnN = input("n", "lab.{axis}.force", "N");

// A spring behind a machine that reaches 90 % of each target: its force is 10 % too small.
TEST(Diagram, CorrectsAForceForTheTrackingError) {
  const auto target =
      diagram(kX + block("u", "gain", "in.in = \"x\"\ngain = 0.9\nunit = \"m\"") +
              block("a", "gain", "in.in = \"x\"\ngain = 0\nunit = \"m/s2\"") +
              block("f", "gain", "in.in = \"u\"\ngain = 5e6\nunit = \"N\"") +
              block("at", "target_force",
                    "in.target = \"x\"\nin.displacement = \"u\"\nin.acceleration = \"a\"\n"
                    "in.force = \"f\"\nreach_m = [1.0]\nforgetting_s = 2"));
  test::Bench bench{*target};
  double corrected = 0, uncorrected = 0;
  for (int i = 0; i < 8000; ++i) {
    const double x = 0.02 * std::sin(2 * M_PI * 0.5 * 0.001 * i);
    bench.in("lab.long.displ") = x;
    static_cast<void>(bench.step(0.001 * i));
    if (i < 4000) continue;
    corrected = std::max(corrected, std::abs(bench.out("at.force.long") - 5e6 * x));
    uncorrected = std::max(uncorrected, std::abs(bench.out("f.out.long") - 5e6 * x));
  }
  EXPECT_NEAR(uncorrected, 0.1 * 5e6 * 0.02, 1);
  EXPECT_LT(corrected, 0.2 * uncorrected);
  EXPECT_EQ(bench.out("at.correction.lat"), 0);
}

// An elastic specimen whose expected stiffness is exact, ahead of a command of constant rate.
TEST(Diagram, StatesTheForceAheadOfACommand) {
  const std::string blocks = kX + block("v", "derivative", "in.in = \"x\"\nunit = \"m/s\"") +
                             block("a", "gain", "in.in = \"x\"\ngain = 0\nunit = \"m/s2\"") +
                             block("f", "gain", "in.in = \"x\"\ngain = 4e8\nunit = \"N\"");
  const std::string force =
      "in.target = \"x\"\nin.displacement = \"x\"\nin.acceleration = \"a\"\nin.force = \"f\"\n"
      "reach_m = [1.0]\nsmooth_reach_m = [1e-3, 1.0]\n"
      "expected_strengths_N = [0, 0, 4e8]\n";
  const std::string command =
      "in.command = \"x\"\nin.command_velocity = \"v\"\nin.command_acceleration = \"a\"\n";
  const auto target = diagram(blocks + block("at", "target_force", force) +
                              block("led", "target_force", force + command + "lead_time_s = 0.02"));
  test::Bench bench{*target};
  for (int i = 0; i < 100; ++i) {
    bench.in("lab.long.displ") = 5e-6 * i;
    static_cast<void>(bench.step(0.001 * i));
  }

  EXPECT_EQ(bench.out("at.ahead.long"), bench.out("f.out.long"));
  // 20 ms ahead of the command: 20 samples. tanh(x/1 m) is 1 − 10⁻⁷ of x/1 m.
  EXPECT_NEAR(bench.out("led.ahead.long"), 4e8 * 5e-6 * (99 + 20), 1);
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(
                  diagram(blocks + block("led", "target_force", force + "lead_time_s = 0.02")));
            }).find("lead_time_s needs the input 'command'") != std::string::npos,
            true);
}

TEST(Diagram, CorrectsAForceForItsLag) {
  const auto target =
      diagram(block("c", "constant", "value = 0\nunit = \"N\"") +
              block("m", "gain", "in.in = \"c\"\nsingle = true\ngain = 0.9\nunit = \"N\"") +
              block("lag", "lag_correction", "in.command = \"c\"\nin.measured = \"m\""));
  test::Bench bench{*target};
  const auto run = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      bench.in("c.value") = 1e6 * std::sin(0.0126 * i);
      static_cast<void>(bench.step(0.001 * i));
    }
  };

  run(0, 3000);

  EXPECT_NEAR(bench.out("lag.gain"), 0.9, 1e-3);
  EXPECT_NEAR(bench.out("lag.lag"), 0, 1e-5);
  EXPECT_NEAR(bench.out("lag.force"), bench.out("c.out"), 1e3);
  bench.in("lag.enabled") = 0;
  run(3000, 4000);
  EXPECT_EQ(bench.out("lag.force"), bench.out("m.out"));
}

TEST(AtsBlock, StartsEachAxisFromItsOwnCoefficients) {
  const auto ats = [](const std::string& initial) {
    return kX + block("v", "derivative", "in.in = \"x\"\nunit = \"m/s\"") +
           block("a", "derivative", "in.in = \"v\"\nunit = \"m/s2\"") +
           block("f", "ats",
                 "in.command = \"x\"\nin.velocity = \"v\"\nin.acceleration = \"a\"\n"
                 "in.measured = \"x\"\ninitial = " +
                     initial);
  };
  const auto target = diagram(ats("[1.0, 0.040, 0.0008, 0.9, 0.050, 0.0010]"));
  test::Bench bench{*target};

  static_cast<void>(bench.step(0));

  EXPECT_DOUBLE_EQ(bench.out("f.a1.long"), 0.040);
  EXPECT_DOUBLE_EQ(bench.out("f.a0.lat"), 0.9);
  EXPECT_DOUBLE_EQ(bench.out("f.a1.lat"), 0.050);
  EXPECT_NE(error_in(ats("[1.0, 0.040, 0.0008, 0.9]")).find("expected three, or three for each"),
            std::string::npos);
}

TEST(AdaptiveInverseBlock, SendsTheBareCommandWhileItIsOff) {
  const auto target =
      diagram(kX + kForceOnN +
              block("f", "adaptive_inverse",
                    "in.command = \"x\"\nin.measured = \"x\"\nin.force = \"n\"\nenabled = 0"));
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 0.25;
  bench.in("lab.lat.force") = 1e6;

  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.out("f.reference.long"), 0.25);
  EXPECT_EQ(bench.out("f.reference.lat"), 0);
  EXPECT_EQ(bench.out("f.a0.long"), 1);
  EXPECT_EQ(bench.out("f.learning.long"), 0);
}

TEST(AdaptiveInverseBlock, RefusesAnUnstableMachine) {
  const std::string message =
      error_in(kX + kForceOnN +
               block("f", "adaptive_inverse",
                     "in.command = \"x\"\nin.measured = \"x\"\nin.force = \"n\"\n"
                     "a2_s2 = [1e-5, 1e-5]"));

  EXPECT_NE(message.find("the initial coefficients invert an unstable machine"), std::string::npos)
      << message;
}

TEST(TableForceObserverBlock, SubtractsTheMachinesForcePerAxis) {
  const auto target =
      diagram(kX + kForceOnN + input("a", "lab.{axis}.accel", "m/s2") +
              block("f", "table_force_observer",
                    "in.displacement = \"x\"\nin.acceleration = \"a\"\nin.force = \"n\"\n"
                    "effective_mass_kg = [1000, 2000]\nforce_offset_N = [2000, -1500]"));
  test::Bench bench{*target};
  bench.in("lab.long.force") = 50e3;
  bench.in("lab.lat.accel") = 3;

  static_cast<void>(bench.step(0));

  EXPECT_DOUBLE_EQ(bench.out("f.force.long"), 50e3 - 2000);
  EXPECT_DOUBLE_EQ(bench.out("f.machine_force.lat"), 2000 * 3 - 1500);
}

TEST(TableForceObserverBlock, DelaysTheDisplacementOnlyWhileItDelaysTheForce) {
  for (const bool enabled : {true, false}) {
    const auto target = diagram(kX + kForceOnN + input("a", "lab.{axis}.accel", "m/s2") +
                                block("f", "table_force_observer",
                                      "in.displacement = \"x\"\nin.acceleration = \"a\"\n"
                                      "in.force = \"n\"\n"
                                      "accelerometer_delay_s = [0.005, 0.005]\nenabled = " +
                                          std::to_string(enabled ? 1 : 0)));
    test::Bench bench{*target};
    static_cast<void>(bench.step(0));
    bench.in("lab.long.force") = 50e3;
    bench.in("lab.long.displ") = 0.1;

    static_cast<void>(bench.step(1e-3));

    EXPECT_DOUBLE_EQ(bench.out("f.force.long"), enabled ? 0 : 50e3);
    EXPECT_DOUBLE_EQ(bench.out("f.displacement.long"), enabled ? 0 : 0.1);
  }
}

TEST(TableForceObserverBlock, RefusesValuesOutsideTheirRangesAndNamesTheAxis) {
  const auto refused = [](const std::string& setting) {
    return error_in(
        kX + kForceOnN + input("a", "lab.{axis}.accel", "m/s2") +
        block("f", "table_force_observer",
              "in.displacement = \"x\"\nin.acceleration = \"a\"\nin.force = \"n\"\n" + setting));
  };

  EXPECT_EQ(refused("presliding_m = [1e-7, 0.1]"), "");
  EXPECT_EQ(refused("presliding_m = [1e-4, 1e-300]"),
            "d.toml:25:16: presliding_m of axis 'lat' is 1e-300, expected 1e-07 to 0.1");
  for (const auto& [setting, message] :
       {std::pair<std::string, std::string>{"presliding_m = [nan, 1e-4]",
                                            "presliding_m is nan, expected a finite number"},
        {"presliding_m = [1e-4, 1e-4, 0]", "axis 'vert' is 0, expected 1e-07 to 0.1"},
        {"effective_mass_kg = [-1, 0]", "axis 'long' is -1, expected 0 to 1000000000"},
        {"coulomb_friction_N = [0, inf]", "coulomb_friction_N is inf, expected a finite number"},
        {"viscous_friction_N_s_per_m = [0, -1]", "axis 'lat' is -1, expected 0 to 1000000000"},
        {"force_offset_N = [0, -2e9]",
         "axis 'lat' is -2000000000, expected -1000000000 to 1000000000"},
        {"load_friction = [1.5, 0]", "axis 'long' is 1.5, expected 0 to 1"},
        {"accelerometer_delay_s = [0, 0.03]", "axis 'lat' is 0.03, expected 0 to 0.02"},
        {"displacement_lead_s = [-0.03, 0]", "axis 'long' is -0.03, expected -0.02 to 0.02"}})
    EXPECT_NE(refused(setting).find(message), std::string::npos) << refused(setting);
}

std::string vertical_block(const std::string& keys) {
  return input("f", "opf.vert.force", "N") + input("m", "srmd.vert.force", "N") + kX +
         block("v", "vertical_force",
               "in.target = \"f\"\nin.measured = \"m\"\nin.horizontal_target = \"x\"\n"
               "in.horizontal = \"x\"\nstiffness_N_per_m = 5e9\n" +
                   keys);
}

// Relative to the first target: a load of 10 MN is the rest position.
TEST(VerticalForceBlock, StartsAtRestAndFollowsTheHeightOfThePendulum) {
  const auto target = diagram(vertical_block(
      "lift_radius_m = -8\nobserver_bandwidth_Hz = 0\nservo_stiffness_N_per_m = 1e15"));
  test::Bench bench{*target};
  bench.in("opf.vert.force") = bench.in("srmd.vert.force") = 10e6;
  static_cast<void>(bench.step(0));
  EXPECT_EQ(bench.out("v.reference"), 0);

  bench.in("lab.long.displ") = 0.24;
  bench.in("lab.lat.displ") = 0.32;
  for (int i = 1; i < 500; ++i) static_cast<void>(bench.step(i * 1e-3));

  // u = 0.4 m: the platen gives way by u²/(2 R) = 10 mm.
  EXPECT_NEAR(bench.out("v.reference"), -0.01, 1e-6);
}

TEST(VerticalForceBlock, RunsThePapersCascade) {
  const auto target =
      diagram(vertical_block("law = \"cascade\"\ncascade_gain_per_s = 10\ncascade_lag_s = 0.04"));
  test::Bench bench{*target};
  bench.in("opf.vert.force") = bench.in("srmd.vert.force") = 10e6;
  static_cast<void>(bench.step(0));
  bench.in("opf.vert.force") = 11e6;
  static_cast<void>(bench.step(1e-3));

  // F/K + g Δt F/K + g T F/K
  EXPECT_NEAR(bench.out("v.reference"), 1e6 / 5e9 * (1 + 10 * 1e-3 + 10 * 0.04), 1e-12);
}

TEST(VerticalForceBlock, LimitsItsReference) {
  const auto target = diagram(vertical_block("law = \"cascade\"\nlimit_m = 0.001"));
  test::Bench bench{*target};
  bench.in("opf.vert.force") = bench.in("srmd.vert.force") = 10e6;
  static_cast<void>(bench.step(0));
  bench.in("opf.vert.force") = 50e6;
  static_cast<void>(bench.step(1e-3));

  EXPECT_EQ(bench.out("v.reference"), 0.001);
}

TEST(VerticalForceBlock, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(
      error_in(vertical_block("law = \"pid\"")).find("law is 'pid', expected lead or cascade"),
      std::string::npos);
  EXPECT_NE(error_in(vertical_block("position_gain_per_s = 0")).find("position_gain_per_s"),
            std::string::npos);
  EXPECT_NE(error_in(vertical_block("stifness = 1")).find("unknown key 'stifness'"),
            std::string::npos);
}

TEST(PredictorCorrectorBlock, CommandsASingleForce) {
  const std::string text = input("new", "opf.newTarget", "1") + input("f", "opf.vert.force", "N") +
                           block("p", "predictor_corrector",
                                 "single = true\nunit = \"N\"\nrate = 10\nin.new_target = \"new\"\n"
                                 "in.target = \"f\"\nin.displacement = \"f\"\nin.force = \"f\"");
  const auto target = diagram(text);

  EXPECT_EQ(port_named(*target, "p.command").unit, "N");
  EXPECT_EQ(port_named(*target, "p.velocity").unit, "N/s");
  EXPECT_NE(error_in(text + "unit = \"K\"").size(), 0U);
}

std::filesystem::path hybrid_controller() {
  return test::source_tree() / "adapters/simulink_like/diagrams/hybrid_controller.toml";
}

TEST(HybridController, SamplesAtTheTargetAndAnswersTheHandshake) {
  const auto target = make_simulink_like(hybrid_controller(), {});
  test::Bench bench{*target};
  static_cast<void>(bench.step(0));
  EXPECT_EQ(bench.out("daq.atTarget"), 1);
  EXPECT_EQ(bench.out("daq.switchPC"), 0);

  bench.in("opf.newTarget") = 1;
  bench.in("opf.long.displ.target") = 0.01;
  static_cast<void>(bench.step(0.001));
  EXPECT_EQ(bench.out("daq.switchPC"), 1);
  EXPECT_EQ(bench.out("daq.atTarget"), 0);

  bench.in("opf.newTarget") = 0;
  bench.in("srmd.long.displ.fbk") = 0.0098;
  static_cast<void>(bench.step(0.002));
  EXPECT_EQ(bench.out("daq.switchPC"), 0);
  for (int i = 3; i <= 10; ++i) static_cast<void>(bench.step(0.001 * i));

  EXPECT_EQ(bench.out("daq.atTarget"), 1);  // ten ticks of ten substeps each
  EXPECT_NEAR(bench.out("pc.command.long"), 0.01, 1e-12);
  EXPECT_NEAR(bench.out("daq.long.displ.fbk"), 0.0098, 1e-12);
}

TEST(HybridController, StepsInRealTime) {
  const auto target = make_simulink_like(hybrid_controller(), {});
  test::Bench bench{*target};
  Status status = Status::Ok;
  for (int i = 0; i < 30; ++i) {
    bench.in("opf.newTarget") = i % 10 < 3 ? 1 : 0;
    bench.in("srmd.long.displ.fbk") = 0.001 * i;
    EXPECT_REALTIME(status = bench.step(0.001 * i));
  }
  EXPECT_EQ(status, Status::Ok);
}

TEST(HybridController, RefusesASamplingDelayThatIsNoPartOfTheStep) {
  const auto refusal = [](const std::string& delays) {
    std::string text = test::content_of(hybrid_controller());
    constexpr std::string_view kAt = "hold_at = 0.5";
    text.replace(text.find(kAt), kAt.size(), "sampling_delay_s = " + delays);
    return test::error_of(
        [&] { static_cast<void>(make_simulink_like_from_text(text, "d.toml", {})); });
  };

  EXPECT_NE(refusal("[0.008, 0.008]")
                .find("the sampling delay is 0.80 of the step, expected less than 0.7"),
            std::string::npos);
  EXPECT_NE(
      refusal("[-0.001, 0]").find("sampling_delay_s of axis 'long' is -0.001, expected 0 to 10"),
      std::string::npos);
  EXPECT_NE(
      refusal("[0, 1e300]").find("sampling_delay_s of axis 'lat' is 1e+300, expected 0 to 10"),
      std::string::npos);
}

TEST(HybridController, ReturnsItsPeriod) {
  EXPECT_DOUBLE_EQ(diagram_period(hybrid_controller()), 0.001);
}

}  // namespace
}  // namespace rths::adapters
