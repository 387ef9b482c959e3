// SPDX-License-Identifier: Apache-2.0
#include "opensees_steps.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/program.hpp>
#include <rths/bench/temporary_folder.hpp>
#include <rths/core/error.hpp>
#include <rths/plant/bearings.hpp>

#include "mesh_files.hpp"

namespace rths::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kTimeout{900};

// Characteristic, of a lead-rubber bearing [N].
double strength_of(const sim::Bearing& bearing) {
  for (const auto& term : bearing.terms)
    for (const auto& [name, value] : term.parameters)
      if (name == "characteristic_strength") return value;
  throw Error{"the bearing of this comparison has no characteristic strength"};
}

void write_plant(const fs::path& folder, const plant::AntDesign& design,
                 const plant::PlantDescription& description) {
  const auto mesh = plant::mesh_of(design);
  const auto structure = plant::assemble(mesh);
  const auto stiffnesses = plant::stiffness_of(description.bearings);
  std::vector<std::array<double, plant::kDirections>> springs;
  for (const auto& stiffness : stiffnesses) springs.push_back(stiffness.initial);
  write_mesh(folder, mesh, structure, springs);
  Rows{folder / "bearings.csv"}.add(stiffnesses.front().post_yield[0],
                                    strength_of(description.bearings.kinds.front()));
  plant::PlantSettings settings;
  settings.damping_ratio = description.damping_ratio;
  settings.damping_frequency = description.damping_frequency;
  Rows{folder / "damping.csv"}.add(settings.damping_time());
}

void write_motion(const fs::path& folder, const sim::GroundMotion& motion) {
  Rows rows{folder / "motion.csv"};
  for (std::size_t i = 0; i < motion.long_acceleration.size(); ++i)
    rows.add(motion.time_step * static_cast<double>(i), motion.long_acceleration[i],
             motion.lat_acceleration[i], motion.vert_acceleration[i]);
}

}  // namespace

OpenSeesSteps opensees_steps(const SolidPlantScript& opensees, const plant::AntDesign& design,
                             const plant::PlantDescription& description,
                             const sim::GroundMotion& motion, double time_step, int steps) {
  OpenSeesSteps result;
  if (opensees.python.empty()) {
    result.missing = "no Python with OpenSees found, set one by --opensees";
    return result;
  }
  try {
    const TemporaryFolder folder{"solids"};
    write_plant(folder.path(), design, description);
    write_motion(folder.path(), motion);
    const std::string output =
        output_of({opensees.python, opensees.script.string(), folder.path().string(), "steps",
                   fmt::format("{}", steps), fmt::format("{}", time_step)},
                  kTimeout);
    const auto last = output.rfind('{');
    if (last == std::string::npos)
      throw Error{fmt::format("{}: the analysis failed", opensees.python)};
    const auto measured = nlohmann::json::parse(output.substr(last));
    measured["wall"].get_to(result.wall);
    measured["processor"].get_to(result.processor);
    measured["memory"].get_to(result.memory);
    measured["version"].get_to(result.version);
  } catch (const std::exception& error) {
    result.missing = error.what();
  }
  return result;
}

}  // namespace rths::bench
