// SPDX-License-Identifier: Apache-2.0
//
// The reduced plant against the full one, and what the comparison finds.
#include <gtest/gtest.h>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/realtime_guard.hpp"

namespace rths::plant {
namespace {

using test::difference;
using test::drive;
using test::kTimeStep;
using test::large_basis;
using test::large_plant;
using test::lead_rubber;
using test::Response;

constexpr double kDuration = 6;                              // [s]
constexpr double kTestedBound = 0.05, kSpectrumBound = 0.5;  // of a reduced plant [%]

Response response_of(LargePlantAnalysis& plant) {
  return drive(plant, lead_rubber(), kTimeStep, kDuration);
}

PlantSettings settings() {
  PlantSettings settings;
  settings.time_step = kTimeStep;
  return settings;
}

Response reduced_response(const Basis& basis, const PlantSettings& settings) {
  const auto& [mesh, structure, bearings] = large_plant();
  return response_of(*make_reduced(basis, bearings, test::petrolia(), structure.floors, settings));
}

// Made once, for all tests of a process.
const Response& full_response() {
  static const Response response = response_of(
      *make_full(large_plant().structure, large_plant().bearings, test::petrolia(), settings()));
  return response;
}

TEST(ReducedPlant, EqualsTheFullPlantAtTheTestedBearingAndInFloorSpectra) {
  const Response reduced = reduced_response(large_basis(), settings());

  const double tested = difference(reduced.tested, full_response().tested),
               spectra = test::spectral_difference(reduced, full_response());
  EXPECT_LE(tested, kTestedBound);
  EXPECT_LE(spectra, kSpectrumBound);
  EXPECT_GT(reduced.tested.cwiseAbs().maxCoeff(), 0.01) << "the bearings do not yield";
  RecordProperty("tested_percent", std::to_string(tested));
  RecordProperty("spectra_percent", std::to_string(spectra));
}

TEST(ReducedPlant, DiffersFromTheFullPlantWithoutStaticVectors) {
  const auto& [mesh, structure, bearings] = large_plant();
  BasisSettings modes_alone;
  modes_alone.has_static_vectors = false;
  const Basis basis = make_basis(structure, bearings, modes_alone);
  EXPECT_EQ(basis.static_vectors(), 0);

  const Response reduced = reduced_response(basis, settings());

  const double tested = difference(reduced.tested, full_response().tested);
  EXPECT_GT(tested, 2 * kTestedBound);
  RecordProperty("tested_percent", std::to_string(tested));
}

TEST(ReducedPlant, DiffersFromTheFullPlantIfItDampsItsBearings) {
  PlantSettings leaking = settings();
  leaking.damps_bearings = true;

  const Response reduced = reduced_response(large_basis(), leaking);

  const double tested = difference(reduced.tested, full_response().tested),
               spectra = test::spectral_difference(reduced, full_response());
  EXPECT_GT(tested, 2 * kTestedBound);
  EXPECT_GT(spectra, 2 * kSpectrumBound);
  RecordProperty("tested_percent", std::to_string(tested));
  RecordProperty("spectra_percent", std::to_string(spectra));
}

// It does not matter which bearing is outside: its force is that of the others.
TEST(FullPlant, HasTheSameResponseWithAnotherTestedBearing) {
  constexpr double kLongStep = 0.01, kShort = 2;  // [s]
  const auto& large = large_plant();
  const auto floors_with = [&](std::size_t tested) {
    PlantSettings settings;
    settings.time_step = kLongStep;
    settings.tested_bearing = tested;
    const auto plant = make_full(large.structure, large.bearings, test::petrolia(), settings);
    return drive(*plant, lead_rubber(), kLongStep, kShort).floors;
  };

  const MatrixXd corner = floors_with(0), inner = floors_with(243), other_corner = floors_with(485);

  EXPECT_LT(difference(inner, corner), 1e-9 * 100);
  EXPECT_LT(difference(other_corner, corner), 1e-9 * 100);
  EXPECT_GT(corner.cwiseAbs().maxCoeff(), 0.1) << "the plant hardly moves";
}

PlantSettings counting_settings() {
  PlantSettings counting = settings();
  counting.counts_energy = true;
  return counting;
}

void expect_real_time(LargePlantAnalysis& plant) {
  std::array<double, 3> target{}, rate{};
  const std::array<double, 3> force{1e5, 2e5, 0};
  std::vector<double> monitored(plant.monitors().size());

  // Each needs the one before.
  const auto step = [&] {
    plant.predict(target, rate);
    plant.work_ahead();
    plant.correct(force);
  };
  EXPECT_REALTIME(step());
  EXPECT_REALTIME(plant.monitor(monitored));
}

TEST(ReducedPlant, IsRealTime) {
  const auto& [mesh, structure, bearings] = large_plant();
  expect_real_time(*make_reduced(large_basis(), bearings, test::petrolia(), structure.floors,
                                 counting_settings()));
}

TEST(FullPlant, IsRealTime) {
  const auto& [mesh, structure, bearings] = large_plant();
  expect_real_time(*make_full(structure, bearings, test::petrolia(), counting_settings()));
}

// The state of a plant with substeps is ahead of the target.
TEST(ReducedPlant, MonitorsCoordinatesThatMoveItsTestedBearingToTheTarget) {
  const auto& [mesh, structure, bearings] = large_plant();
  const Basis& basis = large_basis();
  for (const int substeps : {1, 10}) {
    PlantSettings plant_settings = settings();
    plant_settings.time_step = 0.01;
    plant_settings.substeps = substeps;
    plant_settings.monitors_coordinates = true;
    const auto plant =
        make_reduced(basis, bearings, test::petrolia(), structure.floors, plant_settings);
    const auto monitors = plant->monitors();
    ASSERT_EQ(std::ssize(monitors), 15 + basis.coordinates());
    EXPECT_EQ(monitors[15].name, "coordinate.1");
    EXPECT_EQ(monitors[15].unit, "m");
    std::vector<double> target(3), rate(3), values(monitors.size());
    double largest = 0;

    for (int step = 0; step < 400; ++step) {
      plant->predict(target, rate);
      plant->correct(std::vector<double>{1e5, -5e4, 0});
      plant->monitor(values);
      const VectorXd moved = basis.displacement(
          basis.bearings.topRows<3>(), VectorXd::Map(values.data() + 15, basis.coordinates()));
      for (Index k = 0; k < 2; ++k) {
        largest = std::max(largest, std::abs(target[static_cast<std::size_t>(k)]));
        EXPECT_NEAR(moved[k], target[static_cast<std::size_t>(k)], 1e-12 + 1e-9 * largest)
            << step << " of " << substeps;
      }
    }
    EXPECT_GT(largest, 1e-4);
  }
}

TEST(ReducedPlant, MonitorsTheGroundEachFloorAndTheLoads) {
  const auto& [mesh, structure, bearings] = large_plant();
  const auto plant =
      make_reduced(large_basis(), bearings, test::petrolia(), structure.floors, settings());

  const auto monitors = plant->monitors();

  ASSERT_EQ(monitors.size(), 15U);
  EXPECT_EQ(monitors[0].name, "ground.accel.long");
  EXPECT_EQ(monitors[11].name, "floor.3.accel.vert");
  EXPECT_EQ(monitors[11].unit, "m/s2");
  EXPECT_EQ(monitors[12].name, "bearings.least_load");
}

TEST(Basis, KnowsTheWeightsOfTheBearingsAndTheMass) {
  const Basis& basis = large_basis();

  const double weight = 480e6 * 9.80665;
  EXPECT_NEAR(basis.weights.sum(), weight, 1e-9 * weight);
  EXPECT_NEAR(basis.mass[0], 480e6, 1);
  EXPECT_EQ(basis.dofs, 5'676);
  EXPECT_EQ(basis.static_vectors(), 24);
}

}  // namespace
}  // namespace rths::plant
