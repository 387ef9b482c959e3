// SPDX-License-Identifier: Apache-2.0
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

TEST(Diagram, LoadsTheSpecimenAsThePlantDoesUnlessAValueIsGiven) {
  DiagramContext context;
  context.specimen = std::make_shared<const sim::Bearing>(sim::Bearing{"", {}, 0.95e6});

  const auto of_plant = diagram(block("load", "static_load", ""), context);
  const auto given = diagram(block("load", "static_load", "value = 2e6"), context);

  EXPECT_EQ(port_named(*of_plant, "load.value").initial, 0.95e6);
  EXPECT_EQ(port_named(*given, "load.value").initial, 2e6);
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
            "d.toml:13:13: low-pass: a cut-off of 900 Hz needs a sampling rate above twice "
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

}  // namespace
}  // namespace rths::adapters
