// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/structure_model.hpp>

#include <rths/core/constants.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::sim {

StickModel::StickModel(const IsolatedPlant& plant) : plant_{assemble(plant)} {}
StickModel::StickModel(PlantMatrices plant) : plant_{std::move(plant)} {}

std::unique_ptr<Substructure> StickModel::analysis(const AnalysisSettings& settings) const {
  return std::make_unique<PlantAnalysis>(plant_, settings.motion,
                                         settings.bearing_initial_stiffness, settings.time_step,
                                         settings.alpha, settings.vertical, settings.substeps);
}

std::unique_ptr<Substructure> StickModel::analysis_on_fixed_base(
    const AnalysisSettings& settings) const {
  return std::make_unique<PlantAnalysis>(plant_.fixed_base(), settings.motion, 0,
                                         settings.time_step, settings.alpha);
}

double StickModel::weight() const { return plant_.mass_per_bearing * kStandardGravity; }

bool StickModel::overturns() const { return (plant_.overturning.array() != 0).any(); }

}  // namespace rths::sim
