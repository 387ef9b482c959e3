// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/adapters/simulink_like.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::adapters {
namespace {

const std::string kHead = "diagram = 1\nbase_rate_Hz = 1000\nsubsteps = 10\n";

std::string input(const std::string& name, const std::string& signal,
                  const std::string& unit = "m") {
  return "[[block]]\nname = \"" + name + "\"\ntype = \"ring_input\"\nsignal = \"" + signal +
         "\"\nunit = \"" + unit + "\"\n";
}

std::string block(const std::string& name, const std::string& type, const std::string& rest) {
  return "[[block]]\nname = \"" + name + "\"\ntype = \"" + type + "\"\n" + rest + "\n";
}

std::unique_ptr<Adapter> diagram(const std::string& blocks, const DiagramContext& context = {}) {
  return make_simulink_like_from_text(kHead + blocks, "d.toml", context);
}

std::string error_in(const std::string& blocks) {
  return test::error_of([&] { static_cast<void>(diagram(blocks)); });
}

Port port_named(const Adapter& adapter, const std::string& name) {
  for (const auto& port : adapter.ports())
    if (port.name == name) return port;
  ADD_FAILURE() << "there is no port " << name;
  return {};
}

const std::string kX = input("x", "lab.{axis}.displ");

TEST(Diagram, CarriesAValuePerAxisFromTheRingToTheRing) {
  const auto target =
      diagram(kX + block("twice", "gain", "in.in = \"x\"\ngain = 2") +
              block("y", "ring_output", "in.in = \"twice\"\nsignal = \"out.{axis}\""));
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 1.5;
  bench.in("lab.lat.displ") = -4;

  EXPECT_EQ(bench.step(0), Status::Ok);

  EXPECT_EQ(bench.out("out.long"), 3);
  EXPECT_EQ(bench.out("out.lat"), -8);
}

TEST(Diagram, MonitorsEveryOutputOfEveryBlock) {
  const auto target = diagram(kX + block("twice", "gain", "in.in = \"x\"\ngain = 2"));
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 1.5;

  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.out("x.out.long"), 1.5);
  EXPECT_EQ(bench.out("twice.out.long"), 3);
}

TEST(Diagram, LetsEveryParameterBeTuned) {
  const auto target = diagram(kX + block("k", "gain", "in.in = \"x\"\ngain = 2"));
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 1;
  bench.in("k.gain") = 7;

  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.out("k.out.long"), 7);
}

TEST(Diagram, RunsBlocksInTheOrderOfTheirWiresNotOfTheFile) {
  const auto target = diagram(block("c", "gain", "in.in = \"b\"\ngain = 5") +
                              block("b", "gain", "in.in = \"x\"\ngain = 3") + kX);
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 1;

  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.out("c.out.long"), 15);
}

TEST(Diagram, TakesUnitsFromTheFirstInput) {
  const auto target = diagram(block("c", "gain", "in.in = \"b\"") +
                              block("b", "saturation", "in.in = \"x\"\nlimits = [1, 1]") + kX);

  EXPECT_EQ(port_named(*target, "c.out.long").unit, "m");
}

// Two axes of a laboratory, in its own units.
DiagramContext laboratory() {
  DiagramContext context;
  for (const char* axis : {"long", "lat"})
    for (const auto& [signal, unit] :
         {std::pair{"displ", "inch"}, std::pair{"force", "kip"}, std::pair{"veloc", "inch/s"}})
      context.signal_units[std::string{"lab."} + axis + "." + signal] = unit;
  return context;
}

const std::string kForce = input("f", "lab.{axis}.force", "N");

std::string error_in_laboratory(const std::string& blocks) {
  return test::error_of([&] { static_cast<void>(diagram(blocks, laboratory())); });
}

TEST(Diagram, TakesTheUnitOfTheMapWhereItStatesNone) {
  const auto target =
      diagram(block("x", "ring_input", "signal = \"lab.{axis}.displ\"") +
                  block("y", "ring_output", "in.in = \"x\"\nsignal = \"lab.{axis}.displ\""),
              laboratory());

  EXPECT_EQ(port_named(*target, "x.out.long").unit, "m");
}

TEST(Diagram, RefusesAnInputOfAnotherUnitThanTheMap) {
  EXPECT_EQ(error_in_laboratory(input("x", "lab.{axis}.force", "m")),
            "d.toml:4:1: block 'x' has unit [m], the map gives 'lab.long.force' [N]");
}

TEST(Diagram, RefusesASignalThatTheMapLacks) {
  EXPECT_EQ(error_in_laboratory(input("x", "lab.{axis}.dspl")),
            "d.toml:4:1: block 'x': the map has no signal 'lab.long.dspl' (did you mean "
            "'lab.long.displ'?)");
}

TEST(Diagram, RefusesAForceAsADisplacementOnTheRing) {
  const std::string out = "in.in = \"{}\"\nsignal = \"lab.{axis}.displ\"";
  const auto fed_by = [&](const std::string& wire) {
    return block("y", "ring_output", std::string{out}.replace(out.find("{}"), 2, wire));
  };
  EXPECT_EQ(error_in_laboratory(kForce + fed_by("f")),
            "d.toml:9:1: 'y.in' takes [m], the unit of 'lab.long.displ', 'f' gives [N]");
  // Through blocks that keep the unit.
  EXPECT_EQ(
      error_in_laboratory(kForce + block("k", "gain", "in.in = \"f\"\ngain = 1e-6") +
                          block("s", "saturation", "in.in = \"k\"\nlimits = [1, 1]") + fed_by("s")),
      "d.toml:19:1: 'y.in' takes [m], the unit of 'lab.long.displ', 's' gives [N]");
  EXPECT_EQ(
      error_in_laboratory(kForce + block("k", "gain", "in.in = \"f\"\ngain = 1e-6\nunit = \"m\"") +
                          fed_by("k")),
      "");
  EXPECT_EQ(error_in_laboratory(block("free", "sine", "amplitude = 0.1") + fed_by("free")),
            "");  // unknown
}

TEST(Diagram, RefusesToAddOrSelectDifferentUnits) {
  const std::string x = input("x", "lab.{axis}.displ", "mm");
  EXPECT_EQ(error_in_laboratory(x + kForce + block("s", "sum", "in.in1 = \"x\"\nin.in2 = \"f\"")),
            "d.toml:14:1: 's.in2' takes [mm], 'f' gives [N]");
  EXPECT_EQ(
      error_in_laboratory(x + kForce + block("s", "switch", "in.in1 = \"f\"\nin.in2 = \"x\"")),
      "d.toml:14:1: 's.in2' takes [N], 'x' gives [mm]");
}

TEST(Diagram, RefusesAWrongUnitOfADerivative) {
  EXPECT_EQ(error_in(kX + block("v", "derivative", "in.in = \"x\"\nunit = \"m\"")),
            "d.toml:9:1: 'v' has unit [m], the derivative of [m] has [m/s]");
}

TEST(Diagram, StatesTheRangesOfItsParameters) {
  const auto target =
      diagram(kX + block("k", "gain", "in.in = \"x\"\ngain = 2\nrange.gain = [0, 3]") +
              block("lead", "feed_forward",
                    "in.reference = \"x\"\nin.velocity = \"v\"\nin.acceleration = \"a\"") +
              block("v", "derivative", "in.in = \"x\"\nunit = \"m/s\"") +
              block("a", "derivative", "in.in = \"v\"\nunit = \"m/s2\""));

  EXPECT_EQ(port_named(*target, "k.gain").range, (std::pair<double, double>{0, 3}));
  EXPECT_EQ(port_named(*target, "lead.enabled").range, (std::pair<double, double>{0, 1}));
  EXPECT_EQ(port_named(*target, "lead.velocity_gain_s").range, (std::pair<double, double>{-1, 1}));
}

TEST(Diagram, RefusesAParameterOutsideItsRange) {
  const std::string gain = "in.in = \"x\"\ngain = 4\n";
  EXPECT_EQ(error_in(kX + block("k", "gain", gain + "range.gain = [0, 3]")),
            "d.toml:13:8: gain is 4, expected 0 to 3");
  EXPECT_EQ(error_in(kX + block("k", "gain", gain + "range.gain = [3, 0]")),
            "d.toml:14:14: a range is [lowest, highest]");
  EXPECT_EQ(error_in(kX + block("k", "gain", gain + "range.gian = [0, 3]")),
            "d.toml:14:14: unknown key 'gian' (did you mean 'gain'?)");
}

TEST(Diagram, RunsFastBlocksSeveralTimesAStep) {
  // Each substep adds x once: ten times per step.
  const auto target =
      diagram(kX + block("sum", "sum", "rate = 10\nin.in1 = \"x\"\nin.in2 = \"held\"") +
              block("held", "unit_delay", "rate = 10\nin.in = \"sum\""));
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 1;

  static_cast<void>(bench.step(0));
  EXPECT_EQ(bench.out("sum.out.long"), 10);
  static_cast<void>(bench.step(0.001));
  EXPECT_EQ(bench.out("sum.out.long"), 20);
}

TEST(Diagram, ComputesTheDocumentedOutputsOfItsBlocks) {
  const std::string rest =
      block("sum", "sum", "in.in1 = \"x\"\nin.in2 = \"x\"\nin.in3 = \"x\"\nsigns = \"+-+\"") +
      block("sat", "saturation", "in.in = \"x\"\nlimits = [2, 1]") +
      block("rate", "rate_limiter", "in.in = \"x\"\nlimits = [1000, 1000]") +
      block("either", "switch", "in.in1 = \"x\"\nin.in2 = \"sat\"") +
      block("old", "unit_delay", "in.in = \"x\"") +
      block("older", "transport_delay", "in.in = \"x\"\ndelay_s = 0.003") +
      block("v", "derivative", "in.in = \"x\"\nunit = \"m/s\"") +
      block("mean", "moving_average", "in.in = \"x\"\nsamples = 2") +
      block("c", "constant", "value = 4") + block("now", "clock", "") +
      block("then", "unit_delay", "single = true\nin.in = \"now\"") +
      block("free", "remove_offset", "in.in = \"x\"\nduration_s = 0.002");
  const auto target = diagram(kX + rest);
  test::Bench bench{*target};
  const double x[] = {3, 5, 5, 5, 9};
  for (int i = 0; i < 5; ++i) {
    bench.in("lab.long.displ") = x[i];
    bench.in("either.first") = i == 4 ? 0 : 1;
    static_cast<void>(bench.step(0.001 * i));
    EXPECT_EQ(bench.out("sum.out.long"), x[i]);
    EXPECT_EQ(bench.out("old.out.long"), i > 0 ? x[i - 1] : 0);
    EXPECT_EQ(bench.out("older.out.long"), i > 2 ? x[i - 3] : 0);
  }
  EXPECT_EQ(bench.out("sat.out.long"), 2);
  EXPECT_EQ(bench.out("rate.out.long"), 5);  // one unit a step
  EXPECT_EQ(bench.out("either.out.long"), 2);
  EXPECT_NEAR(bench.out("v.out.long"), 4000, 1e-9);
  EXPECT_EQ(bench.out("mean.out.long"), 7);
  EXPECT_EQ(bench.out("c.out"), 4);
  EXPECT_EQ(bench.out("now.out"), 0.004);
  EXPECT_EQ(bench.out("then.out"), 0.003);
  EXPECT_EQ(bench.out("free.out.long"), 9 - 4);  // the mean of the first two samples is 4
}

TEST(Diagram, GivesSinesAndFiltersThem) {
  const auto target = diagram(block("s", "sine", "amplitude = 2\nfrequency_Hz = 50\nunit = \"m\"") +
                              block("lp", "low_pass", "in.in = \"s\"\norder = 4\ncutoff_Hz = 5"));
  test::Bench bench{*target};
  double largest = 0;
  double largest_filtered = 0;
  for (int i = 0; i < 2000; ++i) {
    static_cast<void>(bench.step(0.001 * i));
    EXPECT_NEAR(bench.out("s.out.lat"), 2 * std::sin(2 * std::numbers::pi * 0.05 * i), 1e-9);
    if (i < 1000) continue;
    largest = std::max(largest, std::abs(bench.out("s.out.lat")));
    largest_filtered = std::max(largest_filtered, std::abs(bench.out("lp.out.lat")));
  }

  EXPECT_NEAR(largest, 2, 1e-6);
  EXPECT_LT(largest_filtered, 2e-3);  // (1/10)⁴ of 2 is 2e-4, and the bilinear map attenuates more
}

TEST(Diagram, RunsEveryBlockInRealTime) {
  const auto target =
      diagram(kX + block("free", "remove_offset", "in.in = \"x\"\nduration_s = 0.002") +
              block("wave", "sine", "amplitude = 2\nfrequency_Hz = 50\nunit = \"m\"") +
              block("c", "constant", "value = 4\nunit = \"m\"") + block("now", "clock", "") +
              block("twice", "gain", "in.in = \"free\"\ngain = 2") +
              block("sum", "sum", "rate = 10\nin.in1 = \"twice\"\nin.in2 = \"wave\"") +
              block("sat", "saturation", "in.in = \"sum\"\nlimits = [2, 1]") +
              block("rate", "rate_limiter", "in.in = \"sat\"\nlimits = [1000, 1000]") +
              block("either", "switch", "in.in1 = \"rate\"\nin.in2 = \"sat\"") +
              block("old", "unit_delay", "in.in = \"either\"") +
              block("older", "transport_delay", "in.in = \"old\"\ndelay_s = 0.003") +
              block("v", "derivative", "in.in = \"older\"\nunit = \"m/s\"") +
              block("mean", "moving_average", "in.in = \"v\"\nsamples = 2") +
              block("lp", "low_pass", "in.in = \"mean\"\norder = 4\ncutoff_Hz = 5") +
              input("flag", "lab.flag", "1") + block("end", "stop", "in.in = \"flag\"") +
              block("y", "ring_output", "in.in = \"older\"\nsignal = \"out.{axis}\""));
  test::Bench bench{*target};
  Status status = Status::Ok;
  for (int i = 0; i < 20; ++i) {
    bench.in("lab.long.displ") = 0.1 * i;
    bench.in("lab.flag") = i > 15 ? 1 : 0;
    EXPECT_REALTIME(status = bench.step(0.001 * i));
  }
  EXPECT_NE(status, Status::Fault);
}

TEST(Diagram, StopsTheRunAndRampsItsOutputsToRest) {
  DiagramContext context;
  context.retreat = {0.01, 0.1};
  const auto target =
      diagram(kX + input("flag", "lab.flag", "1") + block("end", "stop", "in.in = \"flag\"") +
                  block("ref", "ring_output",
                        "in.in = \"x\"\nsignal = \"ref.{axis}\"\nat_stop = \"ramp\"") +
                  block("echo", "ring_output", "in.in = \"x\"\nsignal = \"echo.{axis}\""),
              context);
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 0.8;
  static_cast<void>(bench.step(0));
  bench.in("lab.flag") = 1;
  bench.in("lab.long.displ") = 0.9;  // inputs after the stop do not move the machine

  double time = 0.001;
  double before = 0.8;
  while (bench.step(time) == Status::Ok) {
    EXPECT_LE(bench.out("ref.long"), before + 1e-12);
    EXPECT_LT(before - bench.out("ref.long"), 0.8 * 0.02);
    EXPECT_EQ(bench.out("echo.long"), 0.9);
    before = bench.out("ref.long");
    time += 0.001;
  }

  EXPECT_NEAR(time, 0.001 + 0.11, 0.0015);
  EXPECT_EQ(bench.out("ref.long"), 0);
}

TEST(Diagram, RampsItsOutputsToRestWhenTheRunStops) {
  DiagramContext context;
  context.retreat = {0.0, 0.05};
  const auto target =
      diagram(kX + block("ref", "ring_output",
                         "in.in = \"x\"\nsignal = \"ref.{axis}\"\nat_stop = \"ramp\""),
              context);
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 0.8;
  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.step(0.001, true), Status::Ok);
  EXPECT_EQ(bench.out("ref.long"), 0.8);
  EXPECT_EQ(bench.step(0.1, true), Status::Done);
  EXPECT_EQ(bench.out("ref.long"), 0);
}

TEST(Diagram, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_in(block("g", "gian", "")),
            "d.toml:6:8: there is no block type 'gian' (did you mean 'gain'?)");
  EXPECT_EQ(error_in(kX + block("g", "gain", "in.in = \"x.ut\"")),
            "d.toml:9:1: block 'g' reads 'x.ut', which no block outputs (did you mean 'x.out'?)");
  EXPECT_EQ(error_in(kX + block("x", "constant", "")), "d.toml:10:8: there are two blocks 'x'");
  EXPECT_EQ(error_in(kX + block("g", "gain", "in.inn = \"x\"")),
            "d.toml:12:10: unknown key 'inn' (did you mean 'in'?)");
  EXPECT_EQ(error_in(kX + block("g", "gain", "in.in = \"x\"\ngian = 2")),
            "d.toml:13:8: unknown key 'gian' (did you mean 'gain'?)");
  EXPECT_EQ(error_in(kX + block("g", "gain", "in.in = \"x\"\nrate = 3")),
            "d.toml:13:8: rate is 3, expected 1 or 10");
}

TEST(Diagram, RefusesPortsThatDoNotFit) {
  EXPECT_EQ(error_in(block("c", "constant", "") + block("g", "gain", "in.in = \"c\"")),
            "d.toml:8:1: 'g.in' takes one value per axis, 'c' gives a single one");
  EXPECT_EQ(error_in(kX + input("f", "lab.{axis}.force", "N") +
                     block("lead", "feed_forward",
                           "in.reference = \"f\"\nin.velocity = \"x\"\nin.acceleration = \"x\"")),
            "d.toml:14:1: 'lead.reference' takes [m], 'f' gives [N]");
}

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
      "expected_strength_N = 4e8\nexpected_stiffness_N_per_m = 4e8\n";
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

TEST(Diagram, RefusesAnAlgebraicLoopAndNamesIt) {
  EXPECT_EQ(error_in(kX + block("a", "sum", "in.in1 = \"x\"\nin.in2 = \"b\"") +
                     block("b", "gain", "in.in = \"a\"")),
            "d.toml:9:1: algebraic loop: a <- b <- a; a unit_delay block would break it");
}

TEST(Diagram, RefusesABaseRateBlockBetweenFastOnes) {
  EXPECT_EQ(error_in(kX + block("a", "gain", "rate = 10\nin.in = \"x\"") +
                     block("b", "gain", "in.in = \"a\"") +
                     block("c", "gain", "rate = 10\nin.in = \"b\"")),
            "d.toml:14:1: block 'b' at the base rate lies between fast blocks");
}

TEST(Diagram, RefusesInvalidParametersOfBlocks) {
  EXPECT_EQ(error_in(kX + block("f", "low_pass", "in.in = \"x\"\ncutoff_Hz = 900")),
            "d.toml:13:13: low-pass: a cut-off of 900.000000 Hz needs a sampling rate above twice "
            "that");
  EXPECT_EQ(error_in(kX + block("f", "saturation", "in.in = \"x\"\nlimits = [1]")),
            "d.toml:13:10: limits has 1 numbers, none for axis 'lat'");
  EXPECT_EQ(
      error_in(kX + block("f", "saturation", "in.in = \"x\"\nlimits = [1, 1, 1, 1, 1, 1, 1]")),
      "d.toml:13:10: limits has 7 numbers, expected one per axis, long first");
  EXPECT_EQ(error_in(kX + block("f", "sum", "in.in1 = \"x\"\nsigns = \"+*\"")),
            "d.toml:13:9: signs is '+*', expected '+' and '-' only");
  EXPECT_EQ(error_in(""), "d.toml:1:1: the diagram has no blocks");
}

const std::string kForceOnN = input("n", "lab.{axis}.force", "N");

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

std::filesystem::path hybrid_controller() {
  return test::source_tree() / "adapters/simulink_like/diagrams/hybrid_controller.toml";
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

TEST(Diagram, TakesKeysOfItsBlocksFromTheExperiment) {
  const std::string text = kX + block("k", "saturation", "in.in = \"x\"\nlimits = [1, 1]");
  DiagramContext context;
  context.blocks = Config::parse("k.limits = [2, 2]", "e.toml");
  const auto target = diagram(text, context);
  test::Bench bench{*target};
  bench.in("lab.long.displ") = 3;
  static_cast<void>(bench.step(0));

  EXPECT_EQ(bench.out("k.out.long"), 2);
  context.blocks = Config::parse("kk.limits = [2, 2]", "e.toml");
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(diagram(text, context));
            }).find("e.toml:1:1: the diagram has no block 'kk' (did you mean 'k'?)"),
            std::string::npos);
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

TEST(HybridController, RefusesASamplingDelayOfTheWholeStep) {
  std::string text = test::content_of(hybrid_controller());
  text.replace(text.find("slow_down_from = 0.6"), 20, "sampling_delay_s = [0.008, 0.008]");

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(make_simulink_like_from_text(text, "d.toml", {}));
            }).find("the sampling delay is 0.80 of the step, expected less than 0.8"),
            std::string::npos);
}

TEST(HybridController, ReturnsItsPeriod) {
  EXPECT_DOUBLE_EQ(diagram_period(hybrid_controller()), 0.001);
}

}  // namespace
}  // namespace rths::adapters
