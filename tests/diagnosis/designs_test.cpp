// SPDX-License-Identifier: Apache-2.0
// The catalogue of tests that may be proposed.
#include "diagnosis/experiment_design/src/designs.hpp"

#include <algorithm>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rths::diagnosis
