// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/roles.hpp>
#include <rths/session/plant.hpp>

#include "large_plant_of.hpp"

namespace rths::session {
namespace {

using plant::Basis;
using plant::Index;
using plant::MatrixXd;
using plant::VectorXd;
using recording::Reader;

// Of the largest target. Recorded words have 24 bits, and the largest coordinates are those of the
// isolation modes.
constexpr double kSamePlant = 1e-4;

experiment::Experiment experiment_of(const Reader& run) {
  const std::string file = recording::experiment_path(run);
  if (file.empty()) throw Error{"names no experiment, expected the recording of a run"};
  return app::load_experiment(file, recording::overrides_of(run));
}

// Coordinate × target: column n−1 belongs to step n.
MatrixXd coordinates_of(const Reader& run, const std::string& monitor, const Basis& basis) {
  const auto name = [&](Index i) { return monitor + plant::coordinate_name(i); };
  const Index count = basis.coordinates();
  if (!run.has(name(1)))
    throw Error{
        "has no coordinates of a plant, expected a test with record = [\"coordinates\"] in "
        "[plant]"};
  if (!run.has(name(count)) || run.has(name(count + 1)))
    throw Error{fmt::format("has the coordinates of another plant, expected {} of them", count)};
  const auto steps = run.signal(monitor + "step");
  MatrixXd coordinates;
  for (Index i = 1; i <= count; ++i) {
    const auto values = recording::at_each_count(steps, run.signal(name(i)));
    if (i == 1) coordinates.resize(count, std::ssize(values));
    coordinates.row(i - 1) = Eigen::RowVectorXd::Map(values.data(), std::ssize(values));
  }
  return coordinates;
}

/// The recorded motion of a plant.
struct PlantMotion {
  experiment::Experiment experiment;
  MatrixXd coordinates;  ///< coordinate × target

  [[nodiscard]] const plant::LargePlant& large() const { return large_plant_of(experiment); }
  [[nodiscard]] double time_of(Index target) const {
    return static_cast<double>(target + 1) * experiment.time.integration_step;
  }
  [[nodiscard]] MatrixXd at_bearing(const Basis& basis, Index bearing) const {
    return basis.displacement(basis.bearings.middleRows<3>(3 * bearing), coordinates);
  }
};

// The motion of the tested bearing is known twice: as targets, and by the coordinates.
void check_targets(const Reader& run, const PlantMotion& motion, const Basis& basis) {
  const auto roles = recording::roles_of(run);
  const auto tested = static_cast<Index>(motion.large().description().tested_bearing);
  const MatrixXd found = motion.at_bearing(basis, tested);
  const auto times = run.signal(roles.time);
  double difference = 0, largest = 0;
  for (const auto& axis : roles.axes) {
    if (!run.has(axis.target)) continue;
    // A test may have one of the two axes.
    const Index along = axis.axis == name_of(Axis::Long) ? 0 : 1;
    const auto targets = run.signal(axis.target);
    for (std::size_t row = 0; row < times.size(); ++row) {
      const auto step =
          static_cast<Index>(std::lround(times[row] / motion.experiment.time.integration_step));
      if (step < 1 || step > found.cols()) continue;
      largest = std::max(largest, std::abs(targets[row]));
      difference = std::max(difference, std::abs(targets[row] - found(along, step - 1)));
    }
  }
  if (!(difference <= kSamePlant * largest))
    throw Error{fmt::format(
        "the coordinates move the tested bearing {:.3g} mm away from its targets: the plant of {} "
        "is another one by now, or its modes are of another machine",
        1e3 * difference, motion.experiment.file.string())};
}

// Nodes of a rigid mat have no degrees of freedom of their own.
bool moves(const plant::MeshNode& node) {
  return std::any_of(node.dofs.begin(), node.dofs.end(),
                     [](Index dof) { return dof != plant::kNoDof; });
}

PlantMotion motion_of(const Reader& run) {
  PlantMotion motion{experiment_of(run), {}};
  const auto roles = recording::roles_of(run);
  const Basis& basis = motion.large().basis();
  motion.coordinates = coordinates_of(run, "monitor." + roles.solver + ".", basis);
  check_targets(run, motion, basis);
  return motion;
}

}  // namespace

std::string motion_of_bearing(const std::filesystem::path& recording, int bearing) {
  return recording::of_file(recording, [&] {
    const PlantMotion motion = motion_of(Reader{recording});
    const Basis& basis = motion.large().basis();
    const Index bearings = basis.bearings.rows() / 3;
    if (bearing < 1 || bearing > bearings)
      throw Error{fmt::format("there is no bearing {}, expected 1 to {}", bearing, bearings)};
    const MatrixXd moved = motion.at_bearing(basis, bearing - 1);
    std::string text = "time_s,displ.long_m,displ.lat_m,displ.up_m\n";
    for (Index i = 0; i < moved.cols(); ++i)
      fmt::format_to(std::back_inserter(text), "{:.9g},{:.7g},{:.7g},{:.7g}\n", motion.time_of(i),
                     moved(0, i), moved(1, i), moved(2, i));
    return text;
  });
}

std::string displacement_field(const std::filesystem::path& recording, double time) {
  return recording::of_file(recording, [&] {
    const Reader run{recording};
    const PlantMotion motion = motion_of(run);
    const Index steps = motion.coordinates.cols();
    const double last = motion.time_of(steps - 1);
    const auto step =
        static_cast<Index>(std::lround(time / motion.experiment.time.integration_step));
    if (step < 1 || step > steps)
      throw Error{fmt::format("there is no target at {:g} s, expected {:g} to {:g} s", time,
                              motion.time_of(0), last)};
    const plant::Structure structure = motion.large().description().structure();
    const Basis basis = motion.large().basis_of(structure);
    check_targets(run, motion, basis);
    const VectorXd moved = basis.displacement(basis.all_shapes, motion.coordinates.col(step - 1));
    std::string text = "long_m,lat_m,up_m,displ.long_m,displ.lat_m,displ.up_m\n";
    for (const auto& node : structure.nodes) {
      if (!moves(node)) continue;
      const auto along = [&](std::size_t k) {
        return node.dofs[k] == plant::kNoDof ? 0 : moved[node.dofs[k]];
      };
      fmt::format_to(std::back_inserter(text), "{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g}\n",
                     node.place[0], node.place[1], node.place[2], along(0), along(1), along(2));
    }
    return text;
  });
}

}  // namespace rths::session
