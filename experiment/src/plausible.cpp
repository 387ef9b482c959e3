// SPDX-License-Identifier: Apache-2.0
//
// What a test is expected to demand, beside what machine and specimen can do. Factors of a wrong
// unit are larger than those of an unusual test.
#include <rths/experiment/check.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/loop/numerical_response.hpp>

#include "tables.hpp"

namespace rths::experiment {
namespace {

constexpr double kStep = 0.005;          // of the analysis [s]
constexpr double kLongestAnalysis = 60;  // [s]
constexpr double kBeyond = 5;            // times the machine's capacity
constexpr double kFirstCommand = 0.005;  // from rest [m]: as the safety layer expects
constexpr double kLongestPeriod = 10;    // of the weight on the specimen's initial stiffness [s]

[[noreturn]] void fail(const Experiment& experiment, const std::string& text) {
  throw Error{fmt::format("{}: {}", experiment.file.string(), text)};
}

double largest_size(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values)
    most = std::isfinite(value) ? std::max(most, std::abs(value)) : HUGE_VAL;
  return most;
}

/// Whether the virtual SRMD, whose limits are known, moves the specimen.
bool has_srmd(const Experiment& experiment) {
  return std::any_of(experiment.nodes.begin(), experiment.nodes.end(), [](const auto& plan) {
    return plan.settings.machine_table >= MachineTable::Carriage;
  });
}

void check_history(const Experiment& experiment, std::vector<std::string>& remarks) {
  const auto& history = *experiment.history;
  const auto limits = sim::srmd_machine().axes;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& x = axis == 0 ? history.displacement_long : history.displacement_lat;
    if (x.empty()) continue;
    const double most = largest_size(x), stroke = limits[axis].limits.stroke;
    const std::string is_large = fmt::format(
        "commanded displacements of {} are up to {:.4g} m, the "
        "machine's stroke is {:g} m",
        name_of(kHorizontal[axis]), most, stroke);
    if (has_srmd(experiment) && most > kBeyond * stroke)
      fail(experiment, is_large + ": are they in mm?");
    if (has_srmd(experiment) && most > stroke) remarks.push_back(is_large);
    if (has_srmd(experiment) && std::abs(x.front()) > kFirstCommand)
      fail(experiment,
           fmt::format("the first command of {} is {:.4g} m, expected at most {:g} m from rest",
                       name_of(kHorizontal[axis]), x.front(), kFirstCommand));
  }
}

// The period of the weight on the specimen tells a stiffness in kN/m.
void check_specimen(const Experiment& experiment) {
  const double stiffness = sim::initial_stiffness(experiment.model.bearing);
  const double mass = experiment.model.bearing.axial_load / kStandardGravity;
  if (!(stiffness > 0) || !(mass > 0)) return;
  const double period = 2 * std::numbers::pi * std::sqrt(mass / stiffness);
  if (period > kLongestPeriod)
    fail(
        experiment,
        fmt::format("the specimen's initial stiffness is {:.4g} N/m under {:.4g} MN, a period of "
                    "{:.3g} s, expected at most {:g} s: is the stiffness in kN/m?",
                    stiffness, experiment.model.bearing.axial_load * 1e-6, period, kLongestPeriod));
}

void check_response(const Experiment& experiment, std::vector<std::string>& remarks) {
  const auto response = loop::numerical_response(
      *experiment.plant.structure, experiment.tested_motion(), experiment.model.bearing, kStep,
      std::min(experiment.time.duration, kLongestAnalysis));
  const double weight = experiment.model.bearing.axial_load;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double motion =
        largest_size(axis == 0 ? response.displacement_long : response.displacement_lat);
    const double force = largest_size(axis == 0 ? response.force_long : response.force_lat);
    const auto limits = sim::srmd_machine().axes[axis].limits;
    const auto expected = fmt::format("along {}, the simulation expects {:.4g} m and {:.4g} kN",
                                      name_of(kHorizontal[axis]), motion, force * 1e-3);
    if (weight > 0 && force > 2 * weight)
      fail(experiment,
           fmt::format("{} of a specimen that carries {:.4g} kN: are its parameters, the "
                       "masses or the motion in other units than SI?",
                       expected, weight * 1e-3));
    if (!has_srmd(experiment)) continue;
    const auto within = fmt::format("{}, and the machine reaches {:g} m and {:g} kN", expected,
                                    limits.stroke, limits.force * 1e-3);
    if (motion > kBeyond * limits.stroke || force > kBeyond * limits.force)
      fail(experiment, within + ": is a mass, a stiffness or the motion in another unit?");
    if (motion > limits.stroke || force > limits.force) remarks.push_back(within);
  }
}

}  // namespace

std::string describe_motion(const Experiment& experiment) {
  std::string text = fmt::format("ground motion: {} samples of {:g} s",
                                 experiment.earthquake.motion.long_acceleration.size(),
                                 experiment.earthquake.motion.time_step);
  const auto add = [&](Axis axis, const std::vector<double>& acceleration) {
    const auto sizes = sizes_of(acceleration, experiment.earthquake.motion.time_step);
    if (sizes.acceleration > 0)
      text +=
          fmt::format("; {} {:.3g} g, {:.3g} m/s, {:.3g} m", name_of(axis),
                      sizes.acceleration / kStandardGravity, sizes.velocity, sizes.displacement);
  };
  const auto motion = experiment.tested_motion();
  add(Axis::Long, motion.long_acceleration);
  add(Axis::Lat, motion.lat_acceleration);
  add(Axis::Vert, motion.vert_acceleration);
  return text;
}

std::vector<std::string> check_plausible(const Experiment& experiment) {
  std::vector<std::string> remarks;
  if (experiment.history) {
    check_history(experiment, remarks);
    return remarks;
  }
  if (!experiment.integrates_plant()) return remarks;
  check_specimen(experiment);
  check_response(experiment, remarks);
  return remarks;
}

}  // namespace rths::experiment
