// SPDX-License-Identifier: Apache-2.0
//
// The command as a script uses it. No test depends on times, since the machine may be busy.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths {
namespace {

using nlohmann::json;
using test::run_rths;

json solver_with(const std::string& python) {
  const auto run = run_rths({"bench", "solver", "--dof", "5676", "--steps", "100", "--json",
                             "--opensees-steps", "3", "--opensees", python},
                            300);
  EXPECT_EQ(run.exit_code, 1) << run.err;  // nothing is judged
  return json::parse(run.out);
}

using BenchSolver = test::WithOpenSees<>;

TEST_F(BenchSolver, ComparesItsRowsWithOpenSeesOfTheSameRun) {
  const json document = solver_with(python_);

  ASSERT_EQ(document["rows"].size(), 5U);
  const json& theirs = document["rows"][4];
  EXPECT_EQ(theirs["name"], "opensees_5676_10ms");
  EXPECT_EQ(theirs["steps"], 3);
  EXPECT_GT(theirs["memory_MB"], 10);
  EXPECT_FALSE(document["opensees"]["version"].get<std::string>().empty());
  for (std::size_t i = 0; i < 4; ++i) {
    const json& row = document["rows"][i];
    const double expected = theirs["processor_p50_ms"].get<double>() / row["p50_ms"].get<double>();
    EXPECT_NEAR(row["ratio_to_opensees"], expected, 1e-9 * expected) << row["name"];
  }
}

TEST(BenchSolverAlone, SaysWhyOpenSeesIsNotMeasured) {
  const json document = solver_with("/no/such/python");

  EXPECT_EQ(document["rows"].size(), 4U);
  EXPECT_FALSE(document["rows"][0].contains("ratio_to_opensees"));
  EXPECT_NE(document["opensees"]["missing"].get<std::string>().find("/no/such/python"),
            std::string::npos);
}

}  // namespace
}  // namespace rths
