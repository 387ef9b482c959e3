// SPDX-License-Identifier: Apache-2.0
//
// Bearings of several kinds below one plant: lead rubber, flat sliders and triple pendulums.
#include <cmath>

#include <gtest/gtest.h>

#include <rths/core/config.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using test::large_plant;
using test::lead_rubber;

constexpr double kMixedLength = 2;  // [s]

// From the strong motion on.
sim::GroundMotion strong_motion() {
  sim::GroundMotion motion = test::petrolia();
  const auto first = static_cast<std::ptrdiff_t>(std::lround(3.8 / motion.time_step));
  for (auto* each :
       {&motion.long_acceleration, &motion.lat_acceleration, &motion.vert_acceleration})
    each->erase(each->begin(), each->begin() + first);
  return motion;
}

sim::Bearing published(const std::string& name) {
  const auto file = rths::test::source_tree() / "sim/bearings" / (name + ".toml");
  return sim::read_bearing(Config::load(file), lead_rubber().axial_load);
}

// Sliders at the edge, triple pendulums in three rows inside; the tested corner is lead rubber.
BearingSet mixed() {
  BearingSet set = BearingSet::all_of(lead_rubber(), kAntBearings);
  set.kinds = {lead_rubber(), published("eqsb"), published("tpfb")};
  for (std::size_t i = 1; i < kAntBearings; ++i) {
    const std::size_t column = i / kAntBearingsLat, row = i % kAntBearingsLat;
    if (column == 0 || column == kAntBearingsLong - 1 || row == 0 || row == kAntBearingsLat - 1)
      set.kind_of[i] = 1;
    else if (column >= 12 && column <= 14)
      set.kind_of[i] = 2;
  }
  return set;
}

const Basis& mixed_basis() {
  static const Basis basis = make_basis(large_plant().structure, mixed(), {});
  return basis;
}

PlantSettings mixed_settings() {
  PlantSettings settings;
  settings.time_step = test::kTimeStep;
  settings.alpha = 0;
  settings.counts_energy = true;
  return settings;
}

test::Response mixed_response(LargePlantAnalysis& plant) {
  return test::drive(plant, lead_rubber(), test::kTimeStep, kMixedLength);
}

TEST(MixedBearings, HaveTheStiffnessOfTheirKind) {
  const BearingSet set = mixed();

  const auto stiffness = stiffness_of(set);

  for (const std::size_t i : {0U, 1U, 227U})  // of kinds 0, 1 and 2
    EXPECT_EQ(stiffness[i].initial[0], sim::initial_stiffness(set.kinds[set.kind_of[i]])) << i;
  EXPECT_EQ(set.kind_of[227], 2U);
}

TEST(MixedBearings, RespondAsWithAllCoordinates) {
  const Structure& structure = large_plant().structure;
  const auto reduced = make_reduced(mixed_basis(), mixed(), strong_motion(), structure.floors,
                                    mixed_settings()),
             full = make_full(structure, mixed(), strong_motion(), mixed_settings());

  const auto found = mixed_response(*reduced), expected = mixed_response(*full);

  const double tested = test::difference(found.tested, expected.tested),
               spectra = test::spectral_difference(found, expected);
  EXPECT_LE(tested, 0.05);
  EXPECT_LE(spectra, 0.5);
  for (const auto* plant : {reduced.get(), full.get()}) {
    const EnergyBalance energy = plant->energy();
    EXPECT_GT(energy.absorbed, 0);
    EXPECT_LE(std::abs(energy.error()), 1e-3 * energy.input);
    RecordProperty("energy_percent", std::to_string(100 * energy.error() / energy.input));
  }
  RecordProperty("tested_percent", std::to_string(tested));
  RecordProperty("spectra_percent", std::to_string(spectra));
}

TEST(MixedBearings, ChangeTheResponse) {
  const auto& [mesh, structure, all] = large_plant();

  const auto found = mixed_response(*make_reduced(mixed_basis(), mixed(), strong_motion(),
                                                  structure.floors, mixed_settings())),
             alike = mixed_response(*make_reduced(test::large_basis(), all, strong_motion(),
                                                  structure.floors, mixed_settings()));

  EXPECT_GT(test::difference(found.tested, alike.tested), 5);
}

}  // namespace
}  // namespace rths::plant
