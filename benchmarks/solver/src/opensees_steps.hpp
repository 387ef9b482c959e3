// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/plant/large_plant.hpp>
#include <rths/sim/ground_motion.hpp>

namespace rths::bench {

/// Files that running OpenSees needs.
struct SolidPlantScript {
  std::string python;            ///< a Python with OpenSees; empty: none
  std::filesystem::path script;  ///< solid_plant.py
};

/// Steps of a plant in OpenSees.
struct OpenSeesSteps {
  std::vector<double> wall, processor;  ///< time of each step [s]
  double memory = 0;                    ///< of the process [B]
  std::string version;
  std::string missing;  ///< reason if it was not measured
};

/// Times steps of the same mesh in OpenSees, with its fastest settings: MUMPS, α-OS without
/// iteration, one factor. Its bearings are bilinear along each axis, with the stiffnesses of ours.
[[nodiscard]] OpenSeesSteps opensees_steps(const SolidPlantScript& opensees,
                                           const plant::AntDesign& design,
                                           const plant::PlantDescription& description,
                                           const sim::GroundMotion& motion, double time_step,
                                           int steps);

}  // namespace rths::bench
