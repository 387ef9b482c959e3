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

// 0.02 m are 2 cm, which the lag takes for 2 mm.
TEST_P(EveryVersion, TakesTheUnitsOfItsNodeForVariablesWithoutOne) {
  const auto file = test::lag_fmu(folder, GetParam(), "correct",
                                  {{"start=\"0\" unit=\"mm\"/>", "start=\"0\"/>"}});
  const auto adapter = node.make(file, test::lag_table(GetParam()) + "[units]\nu = \"cm\"\n");
  adapter->activate();
  Bench bench{*adapter};
  bench.in("ref.u") = 0.02;
  bench.in("ref.enabled") = 1;

  ASSERT_EQ(bench.step(0), Status::Ok);

  EXPECT_NEAR(bench.out("fbk.y"), 0.002 * kStep / (kStep + 0.01), 1e-17);
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
        Broken{"gives_nothing", 0, "its step wrote nan to '"},
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
    const experiment::Experiment setup;
    const auto adapter =
        read_fmu("mac", table, setup)
            .make(setup, {"mac", from_seconds(kStep), true, {}, node.map, {}, {}, {}, {}});
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
