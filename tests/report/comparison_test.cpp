// SPDX-License-Identifier: Apache-2.0
#include <rths/report/comparison.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"

namespace rths::report {
namespace {

using rths::test::error_of;

constexpr double kInterval = 0.001, kLength = 10;  // [s]

// A motion of several sines that no delay or factor turns into another one.
double motion(double t, int number = 0) {
  double sum = 0;
  for (int i = 1; i <= 6; ++i)
    sum +=
        std::sin(2 * std::numbers::pi * (0.37 + 0.21 * number) * i * t + i * i * (1 + number)) / i;
  return 0.05 * sum;
}

class Compared : public testing::Test {
 protected:
  using Law = std::function<double(double)>;

  [[nodiscard]] std::filesystem::path table(const char* name, const Law& law,
                                            const char* heading = "displ [m]",
                                            double step = kInterval, double begin = 0) const {
    std::string text = fmt::format("time [s],{}\n", heading);
    for (double t = begin; t < begin + kLength; t += step)
      text += fmt::format("{:.6f},{:.12g}\n", t, law(t));
    return folder_.write(name, text);
  }
  [[nodiscard]] ComparedRuns with(const Law& law, const ComparisonSettings& settings = {}) const {
    return compare(table("a.csv", [](double t) { return motion(t); }), table("b.csv", law),
                   settings);
  }
  [[nodiscard]] ComparedSignal signal_with(const Law& law) const { return with(law).signals.at(0); }

  rths::test::TemporaryFolder folder_;
};

TEST_F(Compared, AreEqualToTheLastBit) {
  const auto signal = signal_with([](double t) { return motion(t); });

  EXPECT_TRUE(signal.is_equal);
  EXPECT_EQ(signal.rms, 0);
  EXPECT_EQ(signal.resemblance, Resemblance::None);
}

TEST_F(Compared, DifferByTheDefinitionOfEachFigure) {
  const auto signal = signal_with([](double t) { return motion(t) + (t > 5 ? 0.003 : 0); });

  EXPECT_NEAR(signal.rms, 0.003 / std::sqrt(2), 2e-6);
  EXPECT_NEAR(signal.largest, 0.003, 1e-12);
  EXPECT_EQ(signal.unit, "m");
}

TEST_F(Compared, AreShiftedByThreeMilliseconds) {
  const auto signal = signal_with([](double t) {
    return motion(t - 0.003) + 1e-4 * std::sin(7919 * t * t);  // beside noise
  });

  ASSERT_TRUE(signal.delay);
  EXPECT_NEAR(*signal.delay, 0.003, 0.0001);
  EXPECT_EQ(signal.resemblance, Resemblance::Delay);
  EXPECT_NE(signal.explanation.find(" ms behind the baseline"), std::string::npos);
}

TEST_F(Compared, HaveTheMistakeOfTheirUnit) {
  const auto signal = signal_with([](double t) { return 1000 * motion(t); });

  EXPECT_EQ(signal.resemblance, Resemblance::Unit);
  EXPECT_EQ(signal.explanation, "is 1000 times the baseline, as if mm had been read as m");
}

TEST_F(Compared, HaveTheOppositeSign) {
  const auto signal = signal_with([](double t) { return -motion(t); });

  EXPECT_EQ(signal.resemblance, Resemblance::Sign);
}

TEST_F(Compared, HaveAnotherScale) {
  const auto signal = signal_with([](double t) { return 1.07 * motion(t); });

  EXPECT_EQ(signal.resemblance, Resemblance::Scale);
  EXPECT_EQ(signal.explanation, "is 1.07 times the baseline");
}

TEST_F(Compared, HaveAnOffset) {
  const auto signal = signal_with([](double t) { return motion(t) - 0.01; });

  EXPECT_EQ(signal.resemblance, Resemblance::Offset);
  EXPECT_EQ(signal.explanation, "is the baseline − 0.01");
}

TEST_F(Compared, AreOfAnotherMotion) {
  const auto signal = signal_with([](double t) { return motion(t, 1); });

  EXPECT_EQ(signal.resemblance, Resemblance::Other);
}

// A law that none of the simple changes describes.
TEST_F(Compared, HaveNoSimpleCauseWhereThereIsNone) {
  const auto signal = signal_with([](double t) { return motion(t) + 30 * std::pow(motion(t), 3); });

  EXPECT_FALSE(signal.is_equal);
  EXPECT_EQ(signal.explanation, "");
}

TEST_F(Compared, MeetTheirToleranceInValueAndInTime) {
  const auto broken = [&](const Tolerance& tolerance, double delay, double offset) {
    ComparisonSettings settings;
    settings.tolerance = tolerance;
    return with([=](double t) { return motion(t - delay) + offset; }, settings).broken();
  };

  EXPECT_EQ(broken({0, 0, 0}, 0, 0), 0U);
  EXPECT_EQ(broken({0.001, 0, 0}, 0, 0.0009), 0U);
  EXPECT_EQ(broken({0.001, 0, 0}, 0, 0.0011), 1U);
  EXPECT_EQ(broken({0, 0.01, 0}, 0, 0.0001), 1U);  // the baseline passes zero
  EXPECT_EQ(broken({2e-3, 0, 0.0041}, 0.004, 0), 0U);
  EXPECT_EQ(broken({1e-5, 0, 0.0021}, 0.004, 0), 1U);
}

TEST_F(Compared, AreNotEqualIfOnlyOneHasANumber) {
  const auto a = folder_.write("a.csv", "time,x\n0,1\n1,2\n2,NaN\n3,4\n"),
             b = folder_.write("b.csv", "time,x\n0,1\n1,NaN\n2,NaN\n3,4\n");
  ComparisonSettings judged;
  judged.tolerance = Tolerance{1, 0, 0};

  EXPECT_TRUE(compare(a, a, judged).signals.at(0).is_equal);
  EXPECT_EQ(compare(a, a, judged).broken(), 0U);
  const auto found = compare(a, b, judged);
  EXPECT_FALSE(found.signals.at(0).is_equal);
  EXPECT_EQ(found.signals.at(0).unmatched, 1U);
  EXPECT_EQ(found.broken(), 1U);
}

TEST_F(Compared, SayWhichTimesTheyShare) {
  const auto a = table("a.csv", [](double t) { return motion(t); }),
             b = table(
                 "b.csv", [](double t) { return motion(t); }, "displ [m]", kInterval, 4);
  const auto found = compare(a, b, {});

  EXPECT_NEAR(found.from, 4, kInterval);
  EXPECT_NEAR(found.to, kLength, 2 * kInterval);
  EXPECT_NE(text_of(found, 5).find("compared from 4 to 10 s, of 0 to 10 s and 4 to 14 s"),
            std::string::npos)
      << text_of(found, 5);
}

TEST_F(Compared, AreAlignedByASignal) {
  ComparisonSettings settings;
  settings.aligned = "displ";
  const auto found = with([](double t) { return motion(t - 0.012); }, settings);

  EXPECT_NEAR(found.shift, 0.012, 1e-4);
  EXPECT_LT(found.signals.at(0).relative_rms, 0.01);
}

TEST_F(Compared, HaveTheirUnitsConverted) {
  const auto a = table("a.csv", [](double t) { return motion(t); }),
             b = table(
                 "b.csv", [](double t) { return 1000 * motion(t); }, "displ [mm]");

  EXPECT_LT(compare(a, b, {}).signals.at(0).relative_rms, 1e-9);
}

TEST_F(Compared, MayHaveOtherTimesAndNames) {
  const auto a = table("a.csv", [](double t) { return motion(t); }),
             b = table(
                 "b.csv", [](double t) { return motion(t); }, "x_mm", 0.0007, 0.0003);
  ComparisonSettings settings;
  settings.pairs = {{"displ", "x"}};
  const auto found = compare(a, b, settings).signals.at(0);

  EXPECT_EQ(found.explanation, "is 0.001 times the baseline, as if m had been read as mm");
}

TEST_F(Compared, RefuseWhatCannotBeCompared) {
  const auto a = table("a.csv", [](double t) { return motion(t); });
  const auto error_with = [&](const char* name, const char* heading, double begin = 0) {
    const auto b = table(
        name, [](double t) { return motion(t); }, heading, kInterval, begin);
    return error_of([&] { static_cast<void>(compare(a, b, {})); });
  };

  EXPECT_NE(error_with("b.csv", "force [kN]").find("have no common signal"), std::string::npos);
  EXPECT_NE(error_with("c.csv", "displ [kN]").find("'displ' is in m in "), std::string::npos);
  EXPECT_NE(error_with("d.csv", "displ [m]", 20).find("found no common time"), std::string::npos);
  const auto without = folder_.write("e.csv", "x [m],displ [m]\n1,2\n2,3\n");
  EXPECT_NE(
      error_of([&] { static_cast<void>(compare(a, without, {})); }).find("found no column of time"),
      std::string::npos);
  const auto back = folder_.write("f.csv", "time [s],displ [m]\n1,2\n2,3\n1.5,3\n");
  EXPECT_NE(error_of([&] {
              static_cast<void>(compare(a, back, {}));
            }).find("time row 3 is 1.5 s after 2 s, expected rising times"),
            std::string::npos);
  ComparisonSettings settings;
  settings.pairs = {{"disp", "displ"}};
  EXPECT_NE(
      error_of([&] { static_cast<void>(compare(a, a, settings)); }).find("there is no signal"),
      std::string::npos);
}

TEST_F(Compared, RefuseAPatternThatMatchesNothingBesideOneThatDoes) {
  const auto a = table("a.csv", [](double t) { return motion(t); });
  ComparisonSettings settings;
  settings.patterns = {"disp*", "dipsl"};

  EXPECT_EQ(error_of([&] { static_cast<void>(compare(a, a, settings)); }),
            "no common signal matches 'dipsl' (did you mean 'displ'?)");
}

}  // namespace
}  // namespace rths::report
