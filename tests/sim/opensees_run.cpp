// SPDX-License-Identifier: Apache-2.0
#include "opensees_run.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "support/files.hpp"
#include "support/opensees.hpp"
#include "support/process.hpp"

namespace rths::sim::test_support {
namespace {

constexpr double kTimeout = 100;  // of one analysis [s]

double vertical_displacement(const TwoBearings& bearing, const PathPoint& point) {
  return -bearing.axial_load * point.load / bearing.vertical_stiffness;
}

double vertical_velocity(const TwoBearings& bearing, const PathPoint& point) {
  return -bearing.axial_load * point.load_rate / bearing.vertical_stiffness;
}

void write_motion(const std::filesystem::path& file, const TwoBearings& bearing, const Path& path) {
  std::ofstream out{file};
  out.precision(17);
  for (const PathPoint& point : path.points)
    out << point.displacement_long << ',' << point.displacement_lat << ','
        << vertical_displacement(bearing, point) << ',' << point.velocity_long << ','
        << point.velocity_lat << ',' << vertical_velocity(bearing, point) << '\n';
}

Forces read_forces(const std::filesystem::path& file) {
  Forces forces;
  std::ifstream in{file};
  char comma = 0;
  for (std::array<double, 3> row{}; in >> row[0] >> comma >> row[1] >> comma >> row[2];)
    forces.push_back({row[0], row[1], -row[2]});
  return forces;
}

double about_mean(const Forces& forces, std::size_t column) {
  double mean = 0, sum = 0;
  for (const auto& row : forces) mean += row[column] / static_cast<double>(forces.size());
  for (const auto& row : forces) sum += (row[column] - mean) * (row[column] - mean);
  return sum;
}

double difference(const Forces& a, const Forces& b, std::size_t column) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i][column] - b[i][column]) * (a[i][column] - b[i][column]);
  return sum;
}

}  // namespace

Forces opensees_forces(const TwoBearings& bearing, const Path& path) {
  const test::TemporaryFolder folder;
  const auto forces = folder.path() / "forces.csv";
  write_motion(folder.path() / "motion.csv", bearing, path);
  const nlohmann::json said = {{"element", bearing.element},
                               {"friction_models", bearing.friction_models},
                               {"materials", bearing.materials},
                               {"time_step_s", path.time_step},
                               {"motion", (folder.path() / "motion.csv").string()},
                               {"forces", forces.string()}};
  const auto file = folder.write("case.json", said.dump());
  const auto script = test::source_tree() / "benchmarks/bearings/opensees/bearing.py";
  test::Running running{{test::opensees_python().value(), script.string(), file.string()}};
  const auto finished = running.wait(kTimeout);
  if (finished.exit_code != 0) throw std::runtime_error{"OpenSees: " + finished.err};
  auto read = read_forces(forces);
  if (read.size() + 1 != path.points.size())
    throw std::runtime_error{"OpenSees did not return a force for every step"};
  return read;
}

Forces our_forces(const TwoBearings& bearing, const Path& path) {
  const Composition composition{bearing.terms, path.time_step};
  std::vector<double> state(composition.states(), 0.0);
  Forces forces;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const PathPoint& point = path.points[i];
    Quantities<double> q;
    q.time = static_cast<double>(i) * path.time_step;
    q.displacement = {point.displacement_long, point.displacement_lat};
    q.velocity = {point.velocity_long, point.velocity_lat};
    q.vertical_displacement = vertical_displacement(bearing, point);
    q.vertical_velocity = vertical_velocity(bearing, point);
    q.axial_load = bearing.axial_load * point.load;
    composition.advance(state, q);
    forces.push_back({q.force[0], q.force[1], q.axial_load});
  }
  return forces;
}

Nrmse nrmse(const Forces& ours, const Forces& reference) {
  const double shear = about_mean(reference, 0) + about_mean(reference, 1);
  double axial = about_mean(reference, 2), whole = 0;
  for (const auto& row : reference) whole += row[2] * row[2];
  // A load that is constant except for rounding is compared with its own size.
  if (axial < 1e-12 * whole) axial = whole;
  Nrmse result;
  result.shear =
      std::sqrt((difference(ours, reference, 0) + difference(ours, reference, 1)) / shear);
  result.axial = std::sqrt(difference(ours, reference, 2) / axial);
  return result;
}

}  // namespace rths::sim::test_support
