// SPDX-License-Identifier: Apache-2.0
// The catalogue of tests that may be proposed.
#include "diagnosis/experiment_design/src/designs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/identification/signal.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kRows = 4000;
constexpr double kStep = 0.01, kLoad = 1e6;  // [s], [N]

std::vector<Record> loaded_record() {
  Record record = linear_record("fit", Use::Fit, kStep, sine_of(20, kRows), {});
  const VectorXd u = 0.03 * sine_of(20, kRows);
  record.channels.push_back({"displacement.long", "m", {u.begin(), u.end()}});
  record.channels.push_back({"vertical_force", "N", std::vector<double>(kRows, kLoad)});
  return {record};
}

bool is_loaded_by(const Record& record, double load) {
  const auto& values = record.find("vertical_force")->values;
  return std::all_of(values.begin(), values.end(), [&](double value) { return value == load; });
}

TEST(Designs, EmptyTableHasNoLoad) {
  LinearRelation relation;
  relation.driven_by = {"displacement.long"};
  const auto records = loaded_record();

  const auto designs = designs_for(linear_problem(relation, records), true);

  int empty = 0, levels = 0;
  for (const auto& design : designs) {
    const bool has_levels = design.text.find("vertical_force") != std::string::npos;
    levels += has_levels ? 1 : 0;
    empty += design.is_empty ? 1 : 0;
    EXPECT_EQ(design.text.starts_with("empty table, "), design.is_empty) << design.text;
    EXPECT_TRUE(has_levels || is_loaded_by(design.record, design.is_empty ? 0 : kLoad))
        << design.text;
    // Only a specimen holds a load at a level.
    EXPECT_FALSE(has_levels && design.is_empty) << design.text;
  }
  EXPECT_GT(empty, 5);
  EXPECT_EQ(levels, 1);
}

TEST(Designs, KeepASpecimenThatCannotBeRemoved) {
  LinearRelation relation;
  relation.driven_by = {"displacement.long"};
  const auto records = loaded_record();

  const auto designs = designs_for(linear_problem(relation, records), false);

  EXPECT_GT(designs.size(), 5U);
  EXPECT_TRUE(std::none_of(designs.begin(), designs.end(),
                           [](const Design& design) { return design.is_empty; }));
}

// Largest value, rate and second rate of a channel.
Eigen::Array3d largest(const Record& record, const std::string& role) {
  const VectorXd x = values_of(*record.find(role));
  const VectorXd rate = rate_of(x, record.time_step);
  return {x.cwiseAbs().maxCoeff(), rate.cwiseAbs().maxCoeff(),
          rate_of(rate, record.time_step).cwiseAbs().maxCoeff()};
}

bool is_any_of(const std::string& text, std::initializer_list<const char*> starts) {
  return std::any_of(starts.begin(), starts.end(),
                     [&](const char* start) { return text.starts_with(start); });
}

// The second axis moves a twentieth of the first, at twice its frequency.
std::vector<Record> two_axes_record(double period) {
  Record record = linear_record("fit", Use::Fit, kStep, sine_of(20, kRows), {});
  VectorXd u(kRows), w(kRows);
  for (Index k = 0; k < kRows; ++k) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(k) * kStep / period;
    u[k] = 0.1 * std::sin(phase);
    w[k] = 0.005 * std::sin(2 * phase);
  }
  record.channels.push_back({"displacement.long", "m", {u.begin(), u.end()}});
  record.channels.push_back({"displacement.lat", "m", {w.begin(), w.end()}});
  return {record};
}

TEST(Designs, StayWithinTheReachOfTheMachine) {
  LinearRelation relation;
  relation.driven_by = {"displacement.long", "displacement.lat"};
  for (const double period : {0.2, 2.0, 10.0, 60.0, 500.0}) {
    const auto records = two_axes_record(period);

    const auto designs = designs_for(linear_problem(relation, records), false);

    // The filter of the comparison takes a little of the recorded motion.
    constexpr double kFiltered = 1.001;
    EXPECT_GT(designs.size(), 10U) << period;
    int both = 0;
    for (const auto& design : designs) {
      both += design.text.find("in both axes") != std::string::npos ? 1 : 0;
      for (const auto& driver : relation.driven_by) {
        const Eigen::Array3d share = largest(design.record, driver) / largest(records[0], driver);
        const std::string text =
            fmt::format("{}, {} of a period of {} s", design.text, driver, period);
        EXPECT_LE(share[0], kFiltered * kReach) << text;
        EXPECT_LE(share[1], kFiltered * kReach) << text;
        // The velocity of these jumps.
        if (!is_any_of(design.text, {"triangle", "quasi-static", "ramps"})) {
          EXPECT_LE(share[2], kFiltered * kReach) << text;
        }
      }
    }
    EXPECT_EQ(both, 2) << period;
  }
}

TEST(Designs, MoveNoAxisThatWasAtRest) {
  LinearRelation relation;
  relation.driven_by = {"displacement.long", "displacement.lat"};
  auto records = two_axes_record(2);
  for (double& value : records[0].channels.back().values) value *= 1e-3;

  for (const auto& design : designs_for(linear_problem(relation, records), false))
    EXPECT_EQ(design.text.find("in both axes"), std::string::npos) << design.text;
}

}  // namespace
}  // namespace rths::diagnosis
