// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/against.hpp>

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

/// Eleven samples from 0 to 1 s, and a second motion.
Case measured() {
  Record record;
  record.name = "run.csv";
  record.time_step = 0.1;
  record.channels = {{"command.long", "m", std::vector<double>(11, 0.5)},
                     {"displacement.long", "m", std::vector<double>(11, 1)},
                     {"force.long", "N", std::vector<double>(11, 2)}};
  record.quiet = {0, 4};
  Record other = record;
  other.use = Use::HeldOut;
  Record rest = record;
  rest.use = Use::Reference;
  Case c;
  c.name = "table";
  c.records = {record, other, rest};
  c.model.kind = ModelKind::Bearing;
  return c;
}

class AgainstTest : public ::testing::Test {
 protected:
  std::filesystem::path simulation(const std::string& csv) { return folder_.write("sim.csv", csv); }
  std::string error_with(const std::string& csv) {
    const auto file = simulation(csv);
    const auto message =
        test::error_of([&] { static_cast<void>(with_prediction(measured(), file)); });
    const std::string start = file.string() + ": ";
    return message.rfind(start, 0) == 0 ? message.substr(start.size()) : "no file: " + message;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(AgainstTest, PredictsAtTheTimesOfTheRecord) {
  const Case c =
      with_prediction(measured(), simulation("time,force.long\n0,0\n0.25,25\n0.5,50\n1,60\n"));

  const auto* force = c.records[0].find("predicted.force.long");
  ASSERT_NE(force, nullptr);
  EXPECT_EQ(force->unit, "N");
  ASSERT_EQ(force->values.size(), 11U);
  for (std::size_t i = 0; i <= 10; ++i)
    EXPECT_NEAR(force->values[i], i <= 5 ? 10.0 * double(i) : 40 + 2.0 * double(i), 1e-9) << i;
  EXPECT_EQ(c.records[0].find("predicted.displacement.long"), nullptr);
  EXPECT_EQ(c.model.kind, ModelKind::Data);
}

TEST_F(AgainstTest, KeepsAModelThatItAnchors) {
  Case c = measured();
  c.model.table = Config::parse("anchor = \"predicted\"", "model");

  EXPECT_EQ(with_prediction(c, simulation("time,force.long\n0,0\n1,1\n")).model.kind,
            ModelKind::Bearing);
}

TEST_F(AgainstTest, DropsRecordsOfOtherMotions) {
  const Case c = with_prediction(measured(), simulation("time,force.long\n0,0\n1,1\n"));

  ASSERT_EQ(c.records.size(), 2U);
  EXPECT_EQ(c.records[0].use, Use::Fit);
  EXPECT_EQ(c.records[1].use, Use::Reference);
}

TEST_F(AgainstTest, AcceptsTheNamesInRecordingsOfRuns) {
  const Case c = with_prediction(measured(),
                                 simulation("time,displ.long,srmd.long.force.fbk\n0,3,5\n1,3,5\n"));

  EXPECT_EQ(c.records[0].find("predicted.displacement.long")->values[3], 3);
  EXPECT_EQ(c.records[0].find("predicted.force.long")->values[3], 5);
}

TEST_F(AgainstTest, CutsTheRecordToThePredictedSpan) {
  const Case c = with_prediction(measured(), simulation("time,force.long\n0.2,2\n0.7,7\n"));

  const Record& record = c.records[0];
  EXPECT_EQ(record.samples(), 6U);
  EXPECT_NEAR(record.start, 0.2, 1e-12);
  EXPECT_EQ(record.quiet, (std::pair<std::size_t, std::size_t>{0, 2}));
  EXPECT_NEAR(record.find("predicted.force.long")->values.back(), 7, 1e-9);
}

TEST_F(AgainstTest, ReportsErrorsInTheSimulation) {
  EXPECT_EQ(error_with("t,force.long\n0,0\n1,1\n"),
            "has no column 'time', expected the time of each row in seconds");
  EXPECT_EQ(error_with("time,force.long\n0,0\n0,1\n"), "'time' does not increase from row to row");
  EXPECT_EQ(error_with("time,F\n0,0\n1,1\n"),
            "predicts no measured channel, expected columns named command.long, "
            "displacement.long, force.long");
  EXPECT_EQ(error_with("time,force.long\n5,0\n6,1\n"),
            "covers 5 to 6 s, expected an overlap with 0 to 1 s");
}

TEST_F(AgainstTest, NamesTheLineOfAMissingNumber) {
  const auto error = [&](const std::string& csv) {
    const auto file = simulation(csv);
    const auto message =
        test::error_of([&] { static_cast<void>(with_prediction(measured(), file)); });
    return message.substr(message.find("sim.csv"));
  };

  EXPECT_EQ(error("time,force.long\n0,0\n0.5,nan\n1,1\n"),
            "sim.csv:3: found 'nan' in column 'force.long', expected a finite number");
  EXPECT_EQ(error("time,force.long\n0,0\n,1\n1,1\n"),
            "sim.csv:3: found '' in column 'time', expected a finite number");
  // After the end of the record.
  EXPECT_EQ(with_prediction(measured(), simulation("time,force.long\n0,0\n1,1\n2,1\n3,nan\n"))
                .records[0]
                .samples(),
            11U);
}

}  // namespace
}  // namespace rths::diagnosis
