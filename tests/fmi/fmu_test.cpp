// SPDX-License-Identifier: Apache-2.0
//
// FMUs of both versions of the standard: a first-order lag, correct and broken on purpose.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "bench_node.hpp"
#include "support/bench.hpp"
#include "support/realtime_guard.hpp"
#include "test_fmu.hpp"

namespace rths::fmi {
namespace {

using test::Bench;
using test::Change;

constexpr double kStep = 0.001;  // [s]

class EveryVersion : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] std::unique_ptr<adapters::Adapter> lag(const std::string& keys = "") const {
    return node.make(test::lag_fmu(folder, GetParam(), "correct"), test::lag_table(GetParam()),
                     keys);
  }

  test::TemporaryFolder folder;
  test::BenchNode node;
};

INSTANTIATE_TEST_SUITE_P(Fmi, EveryVersion, ::testing::Values(2, 3));

// y of a lag that follows a step of u from rest: uₖ(1 − aᵏ), a = τ/(h + τ). Rounding: k·2⁻⁵².
TEST_P(EveryVersion, MovesAsItsEquationSays) {
  const auto adapter = lag();
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;

  for (int k = 1; k <= 200; ++k) {
    ASSERT_EQ(bench.step(k * kStep), Status::Ok) << bench.message();
    const double expected = 0.02 * (1 - std::pow(0.01 / (kStep + 0.01), k));
    ASSERT_NEAR(bench.out("fbk.y"), expected, 200 * 2.3e-16);
    ASSERT_EQ(bench.out("fbk.count"), k);
  }
}

TEST_P(EveryVersion, ConvertsUnitsByTheFmusDefinitions) {
  const auto adapter = lag();
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;

  ASSERT_EQ(bench.step(0), Status::Ok);

  // `angle` is y in mm, stated in degrees.
  EXPECT_NEAR(bench.out("angle"), bench.out("fbk.y") * 1e3 * std::numbers::pi / 180, 1e-15);
  EXPECT_DOUBLE_EQ(bench.out("temperature"), 293.15);
}

TEST_P(EveryVersion, HoldsWhatItsFlagHolds) {
  const auto adapter = lag();
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;

  ASSERT_EQ(bench.step(0), Status::Ok);
  EXPECT_EQ(bench.out("fbk.y"), 0);
  bench.in("ref.enabled") = 1;
  ASSERT_EQ(bench.step(kStep), Status::Ok);
  EXPECT_GT(bench.out("fbk.y"), 0);
}

TEST_P(EveryVersion, TakesStartValuesAndTunableParameters) {
  const auto start = GetParam() == 3 ? "[start]\nlevel = 0\ntau = 0.03\n" : "[start]\ntau = 0.03\n";
  const auto adapter = node.make(test::lag_fmu(folder, GetParam(), "correct"),
                                 std::string{test::kLagSignals} + start, "tunable = [\"gain\"]\n");
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;

  ASSERT_EQ(bench.step(0), Status::Ok);
  const double first = 0.02 * kStep / (kStep + 0.03);
  EXPECT_NEAR(bench.out("fbk.y"), first, 1e-17);
  bench.in("gain") = 3;
  ASSERT_EQ(bench.step(kStep), Status::Ok);

  EXPECT_NEAR(bench.out("fbk.y"), first + (0.06 - first) * kStep / (kStep + 0.03), 1e-17);
}

TEST_P(EveryVersion, CallsItsFunctionsInTheOrderOfTheStandard) {
  const auto adapter = lag("log = true\n");
  testing::internal::CaptureStderr();

  adapter->activate();
  Bench bench{*adapter};
  for (int i = 0; i < 5; ++i) ASSERT_EQ(bench.step(i * kStep), Status::Ok);
  adapter->deactivate();

  const std::string setup = GetParam() == 2 ? "mac: FMU: setup\n" : "";
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "mac: FMU: instantiate\n" + setup +
                "mac: FMU: enter\nmac: FMU: exit\nmac: FMU: third step\nmac: FMU: terminate\n"
                "mac: FMU: free\n");
}

TEST_P(EveryVersion, BeginsAgainAfterDeactivation) {
  const auto adapter = lag();
  double last[2] = {};
  for (double& value : last) {
    adapter->activate();
    Bench bench{*adapter};
    bench.in("ref.u") = 0.02;
    bench.in("ref.enabled") = 1;
    for (int i = 0; i < 10; ++i) ASSERT_EQ(bench.step(i * kStep), Status::Ok);
    value = bench.out("fbk.y");
    adapter->deactivate();
  }
  EXPECT_EQ(last[0], last[1]);
}

TEST_P(EveryVersion, RunsInAProcessOfItsOwn) {
  const auto adapter = lag("own_process = true\n");
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;

  ASSERT_EQ(bench.step(0), Status::Ok);

  EXPECT_NEAR(bench.out("fbk.y"), 0.02 * kStep / 0.011, 1e-17);
}

TEST(Fmu3, ExchangesEveryKindOfNumber) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto adapter = node.make(test::lag_fmu(folder, 3, "correct"),
                                 std::string{test::kLagSignals} +
                                     "single = \"fbk.single\"\nlevel = \"ref.level\"\nlevel_back = "
                                     "\"fbk.level_back\"\n");
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;
  bench.in("ref.level") = 200;

  ASSERT_EQ(bench.step(0), Status::Ok);
  EXPECT_EQ(bench.out("fbk.level_back"), 200);
  EXPECT_NEAR(bench.out("fbk.single"), bench.out("fbk.y"), 1e-7 * bench.out("fbk.y"));

  // A UInt8 holds no more than 255.
  bench.in("ref.level") = 300;
  EXPECT_EQ(bench.step(kStep), Status::LimitExceeded);
  EXPECT_EQ(bench.out("fbk.level_back"), 255);
}

/// A lag whose step breaks a rule.
struct Broken {
  const char* name;
  int version;  ///< 0: both
  const char* message;
  friend std::ostream& operator<<(std::ostream& out, const Broken& b) { return out << b.name; }
};

class BrokenFmu : public ::testing::TestWithParam<Broken> {};

void expect_fault(const Broken& broken, int version, const std::string& keys) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto adapter =
      node.make(test::lag_fmu(folder, version, broken.name), test::lag_table(version), keys);
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.enabled") = 1;
  Status status = Status::Ok;
  for (int i = 0; i < 110 && status == Status::Ok; ++i) status = bench.step(i * kStep);

  EXPECT_EQ(status, Status::Fault) << "FMI " << version;
  EXPECT_NE(std::string{bench.message()}.find(broken.message), std::string::npos)
      << bench.message();
  EXPECT_NE(std::string{bench.message()}.find("FMU 'unpacked': "), std::string::npos)
      << bench.message();
  EXPECT_EQ(bench.step(1), Status::Fault);
  adapter->deactivate();
}

TEST_P(BrokenFmu, EndsTheTestWithItsReason) {
  const Broken& broken = GetParam();
  if (broken.name == std::string{"allocates"} && !test::RealTimeGuard::supported())
    GTEST_SKIP() << "SKIPPED: sanitizers replace the heap";
  for (const int version : {2, 3})
    if (broken.version == 0 || broken.version == version)
      expect_fault(broken, version, "deadline_s = 0.2\n");
}

INSTANTIATE_TEST_SUITE_P(
    Fmi, BrokenFmu,
    ::testing::Values(
        Broken{"refuses_step", 3,
               "refused the step from 0.1 s to 0.101 s (fmi3Discard), computed until 0.1005 s"},
        Broken{"refuses_step", 2,
               "refused the step from 0.1 s to 0.101 s (fmi2Discard), computed until 0.1005 s"},
        Broken{"fails_step", 3, "fmi3DoStep returned fmi3Error: the pump is off"},
        Broken{"fails_step", 2, "fmi2DoStep returned fmi2Error: the pump is off"},
        Broken{"is_fatal", 0, "Fatal"}, Broken{"writes_nan", 0, "its step wrote nan to '"},
        Broken{"crashes", 0, "its step crashed: Segmentation fault"},
        Broken{"loops", 0, "its step did not return within 0.2 s"},
        Broken{"leaves_range", 0, "its step wrote 2 to 'fbk.y', which it states as -1 to 1"},
        Broken{"allocates", 0, "its step used the heap 2 times"},
        Broken{"terminates", 0, "asks for the end of the test, which only a solver can"},
        Broken{"needs_event", 3, "asks for event mode, which is not supported"},
        Broken{"returns_early", 3, "returned early, which is not supported"},
        Broken{"is_pending", 2, "returned fmi2Pending, expected the end of the step"}));

TEST(Fmu, ThatCrashesInItsOwnProcessEndsTheTestWithItsReason) {
  for (const int version : {2, 3})
    expect_fault({"crashes", 0, "its step crashed: Segmentation fault"}, version,
                 "own_process = true\n");
}

TEST(Fmu, ThatIsASolverEndsTheTestWhenItTerminates) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  for (const int version : {2, 3}) {
    const auto file = test::lag_fmu(folder, version, "terminates");
    const Config table = Config::parse(
        "file = \"" + file.string() + "\"\nrole = \"solver\"\n" + test::lag_table(version), "node");
    const adapters::TestSetup setup;
    const auto adapter =
        read_fmu("mac", table, setup)
            .make(setup, {"mac", from_seconds(kStep), true, {}, node.map, {}, {}, {}});
    adapter->activate();
    Bench bench{*adapter};
    Status status = Status::Ok;
    int steps = 0;
    for (; steps < 110 && status == Status::Ok; ++steps) status = bench.step(steps * kStep);
    EXPECT_EQ(status, Status::Done) << bench.message();
    EXPECT_EQ(steps, 101);
  }
}

TEST(Fmu, RampsTheOutputsThatItsNodeNames) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto adapter =
      node.make(test::lag_fmu(folder, 3, "correct"), test::lag_table(3), "ramp = [\"y\"]\n");
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;
  Status status = Status::Ok;
  for (int i = 0; i < 100; ++i) status = bench.step(i * kStep);
  const double held = bench.out("fbk.y");

  // Held for 0.2 s, then ramped to rest in 1 s.
  status = bench.step(0.1, true);
  EXPECT_NEAR(bench.out("fbk.y"), held, 1e-12);
  for (int i = 1; i <= 1300 && status != Status::Done; ++i)
    status = bench.step(0.1 + i * kStep, true);

  EXPECT_EQ(status, Status::Done);
  EXPECT_NEAR(bench.out("fbk.y"), 0, 1e-12);
}

/// What makes an FMU unusable.
struct Refused {
  const char* name;  ///< of the case
  int version;
  std::vector<Change> changes;  ///< of its description
  const char* tables;           ///< empty: the usual ones
  const char* keys;
  const char* message;
  friend std::ostream& operator<<(std::ostream& out, const Refused& r) { return out << r.name; }
};

class RefusedFmu : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedFmu, SaysWhatIsWrong) {
  const Refused& refused = GetParam();
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto file = test::lag_fmu(folder, refused.version, "correct", refused.changes);
  const std::string tables =
      *refused.tables != '\0' ? refused.tables : test::lag_table(refused.version);

  const auto error = test::error_of([&] {
    const auto adapter = node.make(file, tables, refused.keys);
    adapter->activate();
  });

  EXPECT_NE(error.find(refused.message), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

const char* const kInput3 =
    "<Float64 name=\"u\" valueReference=\"1\" causality=\"input\" start=\"0\" unit=\"mm\"/>";

INSTANTIATE_TEST_SUITE_P(
    Fmi, RefusedFmu,
    ::testing::Values(
        Refused{"token",
                3,
                {{"8c4e", "0000"}},
                "",
                "",
                "fmi3Instantiate failed: wrong instantiation token"},
        Refused{"guid",
                2,
                {{"8c4e", "0000"}},
                "",
                "",
                "fmi2Instantiate failed: wrong GUID '{0000810f-3df3-4a00-8276-176fa3c9f9e0}'"},
        Refused{"version",
                2,
                {{"fmiVersion=\"2.0\"", "fmiVersion=\"1.0\""}},
                "",
                "",
                "fmiVersion is '1.0', expected 2.0 or 3.0"},
        Refused{"xml", 3, {{"</ModelVariables>", ""}}, "", "", "is no XML"},
        Refused{"exchange",
                3,
                {{"<CoSimulation", "<ModelExchange"}},
                "",
                "",
                "has no <CoSimulation>, but <ModelExchange>"},
        Refused{"tool",
                2,
                {{"<CoSimulation ", "<CoSimulation needsExecutionTool=\"true\" "}},
                "",
                "",
                "needsExecutionTool is true"},
        Refused{"identifier",
                3,
                {{"modelIdentifier=\"correct\"", "modelIdentifier=\"other\""}},
                "",
                "",
                "has no binaries/x86_64-linux/other.so: it has binaries for x86_64-linux"},
        Refused{"unknown unit",
                3,
                {{kInput3,
                  "<Float64 name=\"u\" valueReference=\"1\" causality=\"input\" "
                  "unit=\"furlongish\"/>"}},
                "",
                "",
                "unit 'furlongish' of 'u': unit 'furlongish' does not parse"},
        Refused{"other quantity",
                3,
                {{"m=\"1\" factor=\"0.001\"", "mol=\"1\" s=\"-1\""}},
                "",
                "",
                "unit 'mm' of 'u': the quantity of unit 's-1.mol' is not supported"},
        Refused{"wrong unit",
                3,
                {},
                "[signals]\nu = \"ref.force\"\ny = \"fbk.y\"\nenabled = "
                "\"ref.enabled\"\n[start]\nlevel = 0\n",
                "",
                "node 'mac' reads 'ref.force' in [m], the map gives [N]"},
        Refused{"no unit",
                3,
                {{"unit=\"mm\"/>", "/>"}},
                "",
                "",
                "node 'mac' reads 'ref.u' in [1], the map gives [m]"},
        Refused{"two units",
                2,
                {},
                "[units]\nu = \"mm\"\n",
                "",
                "node.toml:4:5: the FMU states [mm] for 'u'"},
        Refused{"unit of a flag",
                2,
                {},
                "[units]\nenabled = \"mm\"\n",
                "",
                "'enabled' is of type Boolean, which has no unit"},
        Refused{"no signal",
                3,
                {},
                "[signals]\nu = \"ref.u\"\n",
                "",
                "node 'mac': node.toml:1:1: input 'enabled' has no signal"},
        Refused{"no output",
                2,
                {},
                "[signals]\nu = \"ref.u\"\nenabled = \"ref.enabled\"\ny = \"fbk.z\"\n",
                "",
                "no signal 'fbk.z'"},
        Refused{"no variable",
                2,
                {},
                "[signals]\nenabed = \"ref.u\"\n",
                "",
                "the FMU has no variable 'enabed' (did you mean 'enabled'?)"},
        Refused{"array",
                3,
                {},
                "[signals]\nrow = \"ref.u\"\n",
                "",
                "'row' is an array, expected a scalar"},
        Refused{"text", 3, {}, "[start]\ntitle = 1\n", "", "'title' is of type String"},
        Refused{"text 2", 2, {}, "[start]\ntitle = 1\n", "", "'title' is of type String"},
        Refused{
            "clock", 3, {}, "[signals]\ntick = \"ref.enabled\"\n", "", "'tick' is of type Clock"},
        Refused{"clocked",
                3,
                {},
                "[signals]\nsampled = \"fbk.y\"\n",
                "",
                "'sampled' belongs to a clock"},
        Refused{"parameter as signal",
                3,
                {},
                "[signals]\ntau = \"ref.u\"\n",
                "",
                "'tau' has causality parameter, expected input or output"},
        Refused{"start of an output",
                3,
                {},
                "[start]\ny = 1\n",
                "",
                "'y' has causality output, expected parameter or input"},
        Refused{
            "start outside", 3, {}, "[start]\ntau = 2\n", "", "tau is 2, the FMU allows 0 to 1"},
        Refused{"start beyond its type",
                3,
                {},
                "[start]\nlevel = 300\nu = 0\nenabled = true\n",
                "",
                "a value of [start] is outside the range of its type"},
        Refused{"start of a flag", 3, {}, "[start]\nenabled = 1\n", "", "expected true or false"},
        Refused{"fixed parameter",
                3,
                {},
                "",
                "tunable = [\"tau\"]\n",
                "'tau' is a fixed parameter, expected a tunable parameter"},
        Refused{
            "ramp of an input", 3, {}, "", "ramp = [\"u\"]\n", "'u' is no output with a signal"},
        Refused{"key", 3, {}, "", "files = 1\n", "did you mean 'file'?"},
        Refused{"reference",
                3,
                {{"valueReference=\"1\"", "valueReference=\"-1\""}},
                "",
                "",
                "valueReference is '-1', expected a number"},
        Refused{"factor",
                3,
                {{"factor=\"0.001\"", "factor=\"0\""}},
                "",
                "",
                "factor of unit 'mm' is 0"}));

TEST(Fmu, WithAFixedStepIsRefusedAtAnotherPeriod) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto file = test::lag_fmu(folder, 3, "correct");

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(node.make(file, test::lag_table(3), "", 0.0015));
            }).find("period_s is 0.0015, expected a multiple of the FMU's fixed step, 0.001 s"),
            std::string::npos);
  EXPECT_EQ(
      test::error_of([&] { static_cast<void>(node.make(file, test::lag_table(3), "", 0.003)); }),
      "");
}

TEST(Fmu, GivesItsNodeItsPreferredStep) {
  const test::TemporaryFolder folder;
  const auto file =
      test::lag_fmu(folder, 2, "correct", {{"stepSize=\"0.001\"", "stepSize=\"0.004\""}});
  const Config table =
      Config::parse("file = \"" + file.string() + "\"\nrole = \"machine\"\n", "node");

  EXPECT_EQ(read_fmu("mac", table, {}).schedule.period, from_seconds(0.004));
}

TEST(Fmu, ThatFailsInItsInitializationIsFreed) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  for (const int version : {2, 3}) {
    const auto adapter = node.make(test::lag_fmu(folder, version, "initialization_fails"),
                                   test::lag_table(version), "log = true\n");
    testing::internal::CaptureStderr();

    const auto error = test::error_of([&] { adapter->activate(); });

    EXPECT_NE(error.find("ExitInitializationMode returned fmi"), std::string::npos) << error;
    EXPECT_NE(error.find("no equilibrium"), std::string::npos) << error;
    EXPECT_NE(testing::internal::GetCapturedStderr().find("mac: FMU: free\n"), std::string::npos);
  }
}

// After an error, the standard allows no terminate.
TEST(Fmu, ThatFailsInAStepIsFreed) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  for (const int version : {2, 3}) {
    const auto adapter = node.make(test::lag_fmu(folder, version, "fails_step"),
                                   test::lag_table(version), "log = true\n");
    testing::internal::CaptureStderr();
    adapter->activate();
    Bench bench{*adapter};
    Status status = Status::Ok;
    for (int i = 0; i < 110 && status == Status::Ok; ++i) status = bench.step(i * kStep);
    adapter->deactivate();

    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_NE(log.find("mac: FMU: error: the pump is off\nmac: FMU: free\n"), std::string::npos)
        << log;
  }
}

TEST(Fmu, ThatAllowsOneInstancePerProcessHasOne) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto file = test::lag_fmu(
      folder, 3, "correct",
      {{"<CoSimulation ", "<CoSimulation canBeInstantiatedOnlyOncePerProcess=\"true\" "}});
  const auto first = node.make(file, test::lag_table(3)),
             second = node.make(file, test::lag_table(3));
  first->activate();

  EXPECT_NE(test::error_of([&] { second->activate(); }).find("only once per process"),
            std::string::npos);
  first->deactivate();
  EXPECT_EQ(test::error_of([&] { second->activate(); }), "");
}

}  // namespace
}  // namespace rths::fmi
