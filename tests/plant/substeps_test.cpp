// SPDX-License-Identifier: Apache-2.0
//
// A plant that is integrated several times between two targets.
#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::plant {
namespace {

using test::large_plant;
using test::lead_rubber;

constexpr double kLongStep = 0.01;  // between targets [s]
constexpr int kSubsteps = 10;
constexpr double kLength = 6;  // [s]

/// A plant on 1, 5 or 486 bearings.
struct Plant {
  Structure structure;
  BearingSet bearings;
  Basis basis;
};
Plant plant_on(std::size_t count, std::size_t tested = 0) {
  const auto& [mesh, structure, all] = large_plant();
  if (count == kAntBearings) return {structure, all, test::large_basis()};
  Plant plant{assemble_on_rigid_mat(mesh, count), BearingSet::all_of(lead_rubber(), count), {}};
  plant.bearings.stands_for = 486. / static_cast<double>(count);
  plant.basis = make_basis(plant.structure, plant.bearings, {.tested_bearing = tested});
  return plant;
}

std::unique_ptr<LargePlantAnalysis> analysis(const Plant& plant, double time_step, int substeps,
                                             bool is_full = false) {
  PlantSettings settings;
  settings.time_step = time_step;
  settings.alpha = 0;
  settings.substeps = substeps;
  return is_full ? make_full(plant.structure, plant.bearings, test::petrolia(), settings)
                 : make_reduced(plant.basis, plant.bearings, test::petrolia(),
                                plant.structure.floors, settings);
}

test::Response response(LargePlantAnalysis& plant, double time_step) {
  return test::drive(plant, lead_rubber(), time_step, kLength);
}

// Of steps of 1 ms, at the targets of long ones.
MatrixXd at_targets(const MatrixXd& fine) {
  return fine(Eigen::seq(kSubsteps - 1, Eigen::last, kSubsteps), Eigen::all);
}

struct Differences {
  double tested = 0, floors = 0;  ///< [%]
};
Differences from_fine(const Plant& plant, int substeps) {
  const auto fine = response(*analysis(plant, kLongStep / kSubsteps, 1), kLongStep / kSubsteps),
             found = response(*analysis(plant, kLongStep, substeps), kLongStep);
  return {test::difference(found.tested, at_targets(fine.tested)),
          test::difference(found.floors, at_targets(fine.floors))};
}

// The force of the tested bearing is known at the targets alone. With one bearing it is the whole
// force: the plant of sticks differs by 0.52 % under the same motion. Without substeps, floors
// differ by half.
TEST(Substeps, GiveTheResponseOfShortSteps) {
  struct Bound {
    std::size_t bearings;
    double tested, floors;  // measured: 0.52 and 0.87, 0.12 and 0.25, 0.016 and 0.010 %
  };
  for (const auto& [count, tested, floors] :
       {Bound{1, 0.6, 1}, Bound{5, 0.2, 0.4}, Bound{kAntBearings, 0.03, 0.03}}) {
    const Plant plant = plant_on(count);

    const Differences ten = from_fine(plant, kSubsteps), none = from_fine(plant, 1);

    EXPECT_LT(ten.tested, tested) << count;
    EXPECT_LT(ten.floors, floors) << count;
    EXPECT_GT(none.tested, 2 * ten.tested) << count;
    EXPECT_GT(none.floors, 50 * ten.floors) << count;
    RecordProperty("tested_percent_" + std::to_string(count), std::to_string(ten.tested));
    RecordProperty("floors_percent_" + std::to_string(count), std::to_string(ten.floors));
  }
}

TEST(Substeps, AreTheSameInTheReducedAndTheFullPlant) {
  const Plant plant = plant_on(5);

  const auto reduced = response(*analysis(plant, kLongStep, kSubsteps), kLongStep),
             full = response(*analysis(plant, kLongStep, kSubsteps, true), kLongStep);

  EXPECT_LT(test::difference(reduced.tested, full.tested), 0.05);
  EXPECT_LT(test::difference(reduced.floors, full.floors), 0.5);
}

// A change of the force moves this target and the next ones as in a plant that knew it before.
TEST(Substeps, TakeTheForceInWhereverItIsComputed) {
  const Plant plant = plant_on(5);
  const auto one = analysis(plant, kLongStep, kSubsteps),
             other = analysis(plant, kLongStep, kSubsteps);
  std::array<double, 3> target{}, rate{}, same{};

  for (int step = 0; step < 50; ++step) {
    const std::array<double, 3> force{1e5 * step, -5e4, 0};
    one->predict(target, rate);
    other->predict(same, rate);
    EXPECT_EQ(target, same);
    for (int i = 0; i < step % 20; ++i) one->work_ahead();  // none, some, all, and more than all
    one->correct(force);
    other->correct(force);
  }
}

TEST(Substeps, BeginAtRestWithTheFirstTarget) {
  const Plant plant = plant_on(1);
  for (const int substeps : {1, kSubsteps}) {
    const auto early = analysis(plant, kLongStep, substeps),
               other = analysis(plant, kLongStep, substeps);
    std::array<double, 3> target{}, rate{}, same{};
    std::vector<double> monitored(early->monitors().size(), 1);

    early->work_ahead();  // a solver that waits for the loop to close
    early->monitor(monitored);

    monitored.resize(monitored.size() - 3);  // loads of the bearings
    EXPECT_EQ(monitored, std::vector<double>(monitored.size(), 0));
    for (int step = 0; step < 10; ++step) {
      for (auto* each : {early.get(), other.get()}) {
        each->predict(each == early.get() ? target : same, rate);
        each->correct(std::array{1e4 * step, 0.0, 0.0});
      }
      EXPECT_EQ(target, same);
    }
  }
}

// A specimen softer than its initial stiffness adds no energy: the bearing's initial spring is
// implicit in the extrapolation, too. The largest motion of undamped modes varies.
TEST(Substeps, AreStableOnStiffBearings) {
  const Plant plant = plant_on(1);
  sim::GroundMotion pulse;
  pulse.time_step = 0.01;
  pulse.long_acceleration = {1, -0.7, 1, -0.7, 1, 0};
  pulse.lat_acceleration.assign(6, 0.0);
  const double stiffness = stiffness_of(plant.bearings)[0].initial[0];
  for (const double step : {0.01, 0.048})  // 0.35 and 1.7 rad of the mat alone on its bearings
    for (const int substeps : {2, 10})
      for (const double softening : {0.02, 0.1, 0.3, 0.6, 1.0}) {
        PlantSettings settings;
        settings.time_step = step;
        settings.alpha = 0;
        settings.damping_ratio = 0;
        settings.substeps = substeps;
        const auto run =
            make_reduced(plant.basis, plant.bearings, pulse, plant.structure.floors, settings);
        std::array<double, 3> target{}, rate{};
        double first = 0, last = 0;
        constexpr int kSteps = 3000;
        for (int i = 0; i < kSteps; ++i) {
          run->predict(target, rate);
          const double force = softening * stiffness * target[0];
          run->correct(std::array{force, 0.0, 0.0});
          double& largest = i < kSteps / 3 ? first : last;
          if (i < kSteps / 3 || i >= 2 * kSteps / 3)
            largest = std::max(largest, std::abs(target[0]));
        }
        EXPECT_LE(last, 1.05 * first)
            << step << " s, " << substeps << " substeps, softening " << softening;
      }
}

TEST(Substeps, AreRefusedWhereTheyCannotBeUsed) {
  const Plant plant = plant_on(1);
  const auto error = [&](const PlantSettings& settings) {
    return rths::test::error_of([&] {
      static_cast<void>(make_reduced(plant.basis, plant.bearings, test::petrolia(),
                                     plant.structure.floors, settings));
    });
  };

  EXPECT_EQ(error({.substeps = 0}), "integrator: 0 substeps, expected at least 1");
  EXPECT_EQ(error({.counts_energy = true, .substeps = 2}),
            "plant: energy is counted with 1 substep, not with 2");
  EXPECT_EQ(error({.time_step = 0.05, .substeps = 2}),
            "integrator: substeps need a step of at most 0.0492 s with a bearing of 3.58e+08 N/m, "
            "not 0.05 s; shorten the step or set substeps to 1");
}

TEST(Substeps, AreRealTime) {
  for (const bool is_full : {false, true}) {
    const auto plant = analysis(plant_on(5), kLongStep, kSubsteps, is_full);
    std::array<double, 3> target{}, rate{};
    const std::array<double, 3> force{1e5, 2e5, 0};
    std::vector<double> monitored(plant->monitors().size());

    const auto step = [&] {
      plant->predict(target, rate);
      plant->work_ahead();
      plant->correct(force);
    };
    EXPECT_REALTIME(step());
    EXPECT_REALTIME(plant->monitor(monitored));
  }
}

}  // namespace
}  // namespace rths::plant
