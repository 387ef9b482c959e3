// SPDX-License-Identifier: Apache-2.0
//
// The measured vertical force of the tested bearing restores the plant.
#include <functional>

#include <gtest/gtest.h>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/realtime_guard.hpp"

namespace rths::plant {
namespace {

constexpr double kTargetStep = 0.005;  // between targets [s]

PlantSettings settings_with(int substeps, bool measures_vertical) {
  PlantSettings settings;
  settings.time_step = kTargetStep;
  settings.substeps = substeps;
  settings.measures_vertical = measures_vertical;
  return settings;
}

/// Vertical targets of the tested bearing under a ground motion.
/// @param specimen  compression on top of the weight, by target [N]
MatrixXd targets_of(LargePlantAnalysis& plant, int steps,
                    const std::function<double(double target)>& specimen) {
  std::array<double, 3> target{}, rate{};
  MatrixXd found(steps, 3);
  for (int i = 0; i < steps; ++i) {
    plant.predict(target, rate);
    plant.work_ahead();
    const std::array<double, 3> force{4e6 * target[0], 4e6 * target[1], specimen(target[2])};
    plant.correct(force);
    found.row(i) << target[0], target[1], target[2];
  }
  return found;
}

std::unique_ptr<LargePlantAnalysis> reduced_with(const PlantSettings& settings) {
  const auto& large = test::large_plant();
  return make_reduced(test::large_basis(), large.bearings, test::petrolia(), large.structure.floors,
                      settings);
}

// A machine that follows its target exactly is the spring of the model.
TEST(MeasuredVerticalForce, IsTheModelsIfTheMachineIsExact) {
  const auto& large = test::large_plant();
  const auto exact = [](double target) { return target; };
  for (const int substeps : {1, 5}) {
    const auto measured = reduced_with(settings_with(substeps, true)),
               model = reduced_with(settings_with(substeps, false));
    const MatrixXd found = targets_of(*measured, 800, exact),
                   expected = targets_of(*model, 800, exact);
    EXPECT_GT(expected.col(2).cwiseAbs().maxCoeff(), 1e5);
    EXPECT_LT(test::difference(found, expected), 1e-9) << substeps;
  }
  const auto measured = make_full(large.structure, large.bearings, test::petrolia(),
                                  settings_with(1, true)),
             model = make_full(large.structure, large.bearings, test::petrolia(),
                               settings_with(1, false));
  EXPECT_LT(test::difference(targets_of(*measured, 100, exact), targets_of(*model, 100, exact)),
            1e-9);
}

// An error of the force acts on the plant: all coordinates and the reduced ones agree.
TEST(MeasuredVerticalForce, ActsAlikeInTheReducedAndTheFullPlant) {
  const auto& large = test::large_plant();
  const auto weak = [](double target) { return 0.9 * target; };
  const auto full =
      make_full(large.structure, large.bearings, test::petrolia(), settings_with(1, true));

  const MatrixXd found = targets_of(*reduced_with(settings_with(1, true)), 400, weak),
                 expected = targets_of(*full, 400, weak),
                 model = targets_of(*reduced_with(settings_with(1, false)), 400, weak);

  EXPECT_LT(test::difference(found.col(2), expected.col(2)), 1);
  EXPECT_GT(test::difference(model.col(2), expected.col(2)), 3);
}

// A specimen that carries F₀ too much, on the only bearing: the plant rises until it carries the
// weight again, which is the target −F₀.
TEST(MeasuredVerticalForce, LiftsAPlantThatItCarriesTooWell) {
  constexpr double kExcess = 1e5;  // of a real bearing [N]
  const auto& mesh = test::large_plant().mesh;
  const Structure structure = assemble_on_rigid_mat(mesh, 1);
  BearingSet bearings = BearingSet::all_of(test::lead_rubber(), 1);
  bearings.stands_for = kAntBearings;
  const Basis basis = make_basis(structure, bearings, {});
  sim::GroundMotion still;
  still.time_step = 0.01;
  still.long_acceleration = still.lat_acceleration = std::vector<double>(2, 0.0);
  for (const int substeps : {1, 5}) {
    PlantSettings settings = settings_with(substeps, true);
    settings.damping_ratio = 0.5;
    settings.damping_frequency = 5;
    const auto plant = make_reduced(basis, bearings, still, structure.floors, settings);

    const MatrixXd found = targets_of(*plant, 1000, [](double target) { return target + kExcess; });

    EXPECT_NEAR(found(999, 2), -kExcess, 1e-3 * kExcess) << substeps;
  }
}

TEST(MeasuredVerticalForce, IsTakenInRealTime) {
  for (const int substeps : {1, 5}) {
    const auto plant = reduced_with(settings_with(substeps, true));
    std::array<double, 3> target{}, rate{};
    const std::array<double, 3> force{1e5, 2e5, 3e5};
    const auto step = [&] {
      plant->predict(target, rate);
      plant->work_ahead();
      plant->correct(force);
    };
    EXPECT_REALTIME(step());
  }
}

}  // namespace
}  // namespace rths::plant
