// SPDX-License-Identifier: Apache-2.0
// Records that give no sound verdict.
#include <rths/verdict/diagnose.hpp>
#include <rths/verdict/plan.hpp>

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "one_axis.hpp"
#include "support/files.hpp"
#include "support/record_values.hpp"

namespace rths::diagnosis {
namespace {

using test_support::values_in;

Record record_of_guide(const std::string& name, Use use, unsigned seed) {
  constexpr double kSpring = 2e5, kDamper = 3e3;  // [N/m], [N·s/m]
  const auto guide = [](double, double x, double v) { return kSpring * x + kDamper * v; };
  return test_support::record_of(name, use, seed, guide, {.length = test_support::kShortLength});
}

Case guide() {
  Case c;
  c.name = "guide";
  c.records = {record_of_guide("fit.csv", Use::Fit, 1),
               record_of_guide("unseen.csv", Use::HeldOut, 2)};
  c.model.kind = ModelKind::Platen;
  c.model.table = Config::parse(
      "[polynomial_stiffness]\nlinear_N_per_m = 200_000\n"
      "[viscous_friction]\ncoefficient_N_s_per_m = 3_000\n",
      "model");
  c.model.fitted.push_back({"polynomial_stiffness.linear", std::nullopt});
  return c;
}

void fill(Record& record, const std::string& role, double value) {
  auto& values = values_in(record, role);
  std::fill(values.begin(), values.end(), value);
}

void shorten(Record& record, std::size_t samples) {
  for (auto& channel : record.channels) channel.values.resize(samples);
  record.quiet.reset();
}

// The error of the diagnosis; the plan has the same.
std::string error_of(const Case& c) {
  const std::string message = test::error_of([&] { static_cast<void>(diagnose(c)); });
  EXPECT_EQ(test::error_of([&] { static_cast<void>(plan(c, {})); }), message);
  return message;
}

// A channel that is constant in one record is refused for the reason.
void expect_refused(const std::string& role, double constant, const std::string& reason) {
  for (const std::size_t record : {0U, 1U}) {
    Case c = guide();
    fill(c.records[record], role, constant);

    EXPECT_EQ(error_of(c), c.records[record].name + ": " + role +
                               " is constant, expected a channel that varies: " + reason);
  }
}

TEST(CheckedRecords, HaveAnOutputThatVaries) {
  expect_refused("force.long", 5, "its standard deviation scales the error");
}

TEST(CheckedRecords, HaveAMotionThatVaries) {
  expect_refused("displacement.long", 0.02, "it drives the model");
}

// The errors of both axes are divided by the standard deviation of both.
TEST(CheckedRecords, MayHaveOneAxisAtRest) {
  Case c = guide();
  for (auto& record : c.records) {
    record.channels.push_back({"displacement.lat", "m", std::vector<double>(record.samples())});
    record.channels.push_back({"force.lat", "N", std::vector<double>(record.samples(), 7)});
  }

  EXPECT_EQ(plan(c, {}).relations[0].outputs.size(), 2U);

  fill(c.records[0], "force.long", 5);
  EXPECT_EQ(error_of(c),
            "fit.csv: force.long and force.lat are constant, expected a channel that varies: its "
            "standard deviation scales the error");
}

Case two_outputs(const std::string& second_unit) {
  Case c = guide();
  for (auto& record : c.records) {
    record.channels[0].role = "input.u";
    record.channels[1].role = "output.f";
    record.channels.push_back(
        {"output.second", second_unit, std::vector<double>(record.samples(), 7)});
  }
  c.model = {};
  c.model.kind = ModelKind::Linear;
  c.model.table = Config::parse(
      "inputs = [\"input.u\"]\noutputs = [\"output.f\", \"output.second\"]\n"
      "A = [[-10]]\nB = [[1]]\nC = [[1e6], [0]]\n",
      "model");
  return c;
}

// The error of each output is divided by its own standard deviation.
TEST(CheckedRecords, HaveEachOutputOfAnotherUnitVary) {
  EXPECT_EQ(plan(two_outputs("N"), {}).relations.size(), 1U);
  EXPECT_EQ(error_of(two_outputs("m")),
            "fit.csv: output.second is constant, expected a channel that varies: its standard "
            "deviation scales the error");
}

// Fifteen tonnes on a specimen, and an empty table.
TEST(CheckedRecords, HaveCompressionAsPositive) {
  constexpr double kLoad = -1.5e5;
  const std::string tension =
      "vertical_force is negative in the mean (-1.5e+05 N), expected compression as positive "
      "(\"-column [unit]\" in [channels] reverses the sign)";
  Case c = guide();
  for (auto& record : c.records)
    record.channels.push_back(
        {"vertical_force", "N", std::vector<double>(record.samples(), -kLoad)});
  const auto limits = [&] { return plan(c, {}).limits; };
  const auto count = [&](const std::string& line) {
    const auto all = limits();
    return std::count(all.begin(), all.end(), line);
  };

  EXPECT_EQ(count("unseen.csv: " + tension + "."), 0);
  fill(c.records[1], "vertical_force", kLoad);
  EXPECT_EQ(count("unseen.csv: " + tension + "."), 1);
  c.model.kind = ModelKind::Bearing;
  EXPECT_EQ(error_of(c), "unseen.csv: " + tension);
  // Noise of an empty load cell.
  fill(c.records[1], "vertical_force", -1);
  values_in(c.records[1], "vertical_force")[5] = 3;
  EXPECT_EQ(test::error_of([&] { static_cast<void>(plan(c, {})); }), "");
}

TEST(CheckedRecords, HaveEnoughSamples) {
  Case c = guide();
  shorten(c.records[1], 4);
  EXPECT_EQ(error_of(c), "unseen.csv: the record has 4 samples, expected at least 32");

  // 0.2 s are 13 rows of the comparison, each of 16 ms; its filter spoils 0.08 s at the start.
  c = guide();
  shorten(c.records[0], static_cast<std::size_t>(0.2 / test_support::kStep));
  EXPECT_EQ(error_of(c).find("fit.csv: motion to force compares 8 rows of 0.016 s, expected at "
                             "least 32: use a longer record, or a shorter settle_s"),
            0U)
      << error_of(c);
}

TEST(CheckedRecords, HaveMoreValuesThanParameters) {
  Case c = two_outputs("N");
  for (auto& record : c.records) {
    shorten(record, 40);
    record.channels.back().values[3] = 8;
  }
  std::string row = "[", zeros = "[";
  for (int i = 0; i < 10; ++i) row += "-1,", zeros += "[1],";
  std::string square = "[";
  for (int i = 0; i < 10; ++i) square += row + "],";
  c.model.table = Config::parse(
      "inputs = [\"input.u\"]\noutputs = [\"output.f\", \"output.second\"]\nA = " + square +
          "]\nB = " + zeros + "]\nC = [" + row + "]," + row + "]]\n",
      "model");
  for (int i = 1; i <= 10; ++i)
    for (int j = 1; j <= 10; ++j)
      c.model.fitted.push_back({"A." + std::to_string(i) + "." + std::to_string(j), std::nullopt});

  EXPECT_EQ(error_of(c),
            "input to output: the fitted records have 80 values for 100 parameters, expected 200");
}

TEST(CheckedRecords, HaveValuesWhoseSquaresAreFinite) {
  const auto message = [](double factor) {
    Case c = guide();
    for (auto& value : values_in(c.records[0], "force.long")) value *= factor;
    return error_of(c);
  };
  EXPECT_EQ(message(1e300).find("fit.csv: force.long is "), 0U);
  EXPECT_NE(message(1e300).find("N in sample 1, at 0 s, expected -1e+50 to 1e+50"),
            std::string::npos);
  EXPECT_EQ(message(1e-300).find("fit.csv: the largest value of force.long is "), 0U);
  EXPECT_NE(message(1e-300).find("N, expected 0 or at least 1e-50"), std::string::npos);

  Case c = guide();
  values_in(c.records[1], "displacement.long")[9] = -1e308;
  EXPECT_EQ(error_of(c),
            "unseen.csv: displacement.long is -1e+308 m in sample 10, at 0.036 s, expected "
            "-1e+50 to 1e+50");
}

}  // namespace
}  // namespace rths::diagnosis
