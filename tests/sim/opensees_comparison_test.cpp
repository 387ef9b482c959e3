// SPDX-License-Identifier: Apache-2.0
// The same bearing here and in OpenSees, along the same paths. Where both implement the same law,
// their forces must agree; intended differences are measured.
#include <cmath>
#include <cstdio>
#include <ostream>

#include <gtest/gtest.h>

#include "opensees_rows.hpp"
#include "support/with_opensees.hpp"

namespace rths::sim {
namespace test_support {

// Name of the row in a failure message.
void PrintTo(const OpenSeesRow& row, std::ostream* out) { *out << row.name; }

}  // namespace test_support
namespace {

using test_support::OpenSeesRow;

std::vector<OpenSeesRow> all_rows() {
  auto rows = test_support::elastomeric_rows();
  for (auto& row : test_support::sliding_rows()) rows.push_back(std::move(row));
  return rows;
}

void print_line(const std::string& name, const std::string& path, double time_step,
                const test_support::Nrmse& found) {
  std::printf("  %-34s %-11s dt %.2g ms  shear %7.4f %%  axial %7.4f %%\n", name.c_str(),
              path.c_str(), 1e3 * time_step, 100 * found.shear, 100 * found.axial);
}

using Opensees = test::WithOpenSees<>;

class OpenseesBearing : public Opensees, public testing::WithParamInterface<OpenSeesRow> {};

TEST_P(OpenseesBearing, AgreesWithOurs) {
  const OpenSeesRow& row = GetParam();
  auto paths = test_support::all_paths(row.amplitude, row.time_step);
  if (row.swing > 0) paths.push_back(test_support::pulled(row.amplitude, row.time_step, row.swing));
  for (const auto& path : paths) {
    const auto theirs = test_support::opensees_forces(row.bearing, path);
    const auto ours = test_support::our_forces(row.bearing, path);

    const auto found = test_support::nrmse(ours, theirs);

    print_line(row.name, path.name, path.time_step, found);
    RecordProperty(path.name + "_shear_percent", std::to_string(100 * found.shear));
    RecordProperty(path.name + "_axial_percent", std::to_string(100 * found.axial));
    EXPECT_LE(found.shear, row.bound) << path.name;
    EXPECT_LE(found.axial, row.bound) << path.name;
  }
  if (!row.deviation.empty()) std::printf("  intended: %s\n", row.deviation.c_str());
}

// OpenSees integrates the whole step by backward Euler, ours uses Runge-Kutta in substeps. The
// difference is OpenSees' error, which is of first order in the step.
TEST_F(Opensees, ComesNearerToOursAsItsStepGetsShorter) {
  for (const auto& row : test_support::elastomeric_rows()) {
    if (row.name != "LeadRubberX") continue;
    std::vector<double> differences;
    for (const double step : {2e-3, 1e-3, 5e-4}) {
      const auto path = test_support::recorded(row.amplitude, step);
      const auto found = test_support::nrmse(test_support::our_forces(row.bearing, path),
                                             test_support::opensees_forces(row.bearing, path));
      print_line(row.name, path.name, step, found);
      RecordProperty("record_at_" + std::to_string(std::lround(1e6 * step)) + "_us_shear_percent",
                     std::to_string(100 * found.shear));
      differences.push_back(found.shear);
    }
    for (std::size_t i = 1; i < differences.size(); ++i)
      EXPECT_NEAR(differences[i] / differences[i - 1], 0.5, 0.1) << row.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, OpenseesBearing, testing::ValuesIn(all_rows()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace rths::sim
