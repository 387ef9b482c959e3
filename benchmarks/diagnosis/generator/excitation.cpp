// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ground_motion.hpp"
#include "structure.hpp"

namespace trial {
namespace {

constexpr double kTaper = 1;        ///< at both ends [s]
constexpr double kLongestLull = 1;  ///< before the shaking is strong [s]
constexpr double kVerticalFrequency = 2 * std::numbers::pi * 8;  ///< of the structure [rad/s]
constexpr double kVerticalDamping = 0.1;

double at(const std::vector<double>& signal, double step, double time) {
  const double position = time / step;
  if (position < 0 || position >= static_cast<double>(signal.size() - 1)) return 0;
  const std::size_t index = static_cast<std::size_t>(position);
  const double share = position - static_cast<double>(index);
  return signal[index] + share * (signal[index + 1] - signal[index]);
}

double taper(double time, double length) {
  const double edge = std::clamp(std::min(time, length - time) / kTaper, 0.0, 1.0);
  return 0.5 - 0.5 * std::cos(std::numbers::pi * edge);
}

// Start of the strongest section of that length; 0 if the whole motion fits [s].
double strongest_start(const GroundMotion& motion, double length) {
  const std::size_t window = static_cast<std::size_t>(length / motion.step);
  if (window >= motion.first.size()) return 0;
  double energy = 0, most = 0;
  std::size_t best = 0;
  for (std::size_t i = 0; i < motion.first.size(); ++i) {
    const auto square = [&](std::size_t k) {
      return motion.first[k] * motion.first[k] + motion.second[k] * motion.second[k];
    };
    energy += square(i);
    if (i >= window) energy -= square(i - window);
    if (i + 1 >= window && energy > most * 1.0001) {
      most = energy;
      best = i + 1 - window;
    }
  }
  return std::max(0.0, static_cast<double>(best) * motion.step - kLongestLull);
}

double mean(const std::vector<double>& signal) {
  double sum = 0;
  for (const double value : signal) sum += value;
  return sum / static_cast<double>(signal.size());
}

void fill_ground(const GroundMotion& motion, Excitation& excitation) {
  const double length = kRecordLength - kQuietTime;
  const double start = strongest_start(motion, length);
  const Plane means{mean(motion.first), mean(motion.second)};
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double time = static_cast<double>(k) * kSampleTime - kQuietTime;
    const double scale = time < 0 ? 0 : kStandardGravity * taper(time, length);
    const Plane components{at(motion.first, motion.step, start + time) - means[0],
                           at(motion.second, motion.step, start + time) - means[1]};
    const std::size_t x = excitation.swapped ? 1 : 0;
    excitation.ground.push_back({scale * components[x], scale * components[1 - x]});
  }
}

// The vertical mode of the structure varies the axial load of the bearing.
void fill_axial_load(const GroundMotion& motion, double largest, Excitation& excitation) {
  const double length = kRecordLength - kQuietTime;
  const double start = strongest_start(motion, length);
  const std::vector<double>& component = motion.has_vertical ? motion.vertical : motion.first;
  const double pace = motion.has_vertical ? 1 : 1.6;
  double value = 0, rate = 0, peak = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double time = static_cast<double>(k) * kSampleTime - kQuietTime;
    const double ground =
        time < 0 ? 0 : taper(time, length) * at(component, motion.step, pace * (start + time));
    const double restoring = kVerticalFrequency * kVerticalFrequency * value +
                             2 * kVerticalDamping * kVerticalFrequency * rate;
    rate += kSampleTime * (-ground - restoring);
    value += kSampleTime * rate;
    excitation.axial_load.push_back(restoring);
    peak = std::max(peak, std::abs(restoring));
  }
  for (double& load : excitation.axial_load)
    load = kReferenceLoad * (1 + (peak > 0 ? largest * load / peak : 0));
}

double reach_of(const Excitation& excitation, double scale) {
  Structure structure;
  Bearing bearing{absent(), kSampleTime};
  double reach = 0;
  for (const Plane& ground : excitation.ground) {
    Boundary boundary;
    boundary.displacement = structure.displacement();
    const Plane force = bearing.advance(boundary);
    structure.advance(force, {scale * ground[0], scale * ground[1]}, kSampleTime);
    reach = std::max(reach, std::hypot(structure.displacement()[0], structure.displacement()[1]));
  }
  return reach;
}

// By bisection: the reach grows with the scale, but not linearly and sometimes by a jump.
double scale_for(const Excitation& excitation, double reach) {
  constexpr int kMaxTries = 12;
  constexpr double kCloseEnough = 0.03;
  double low = 0.05, high = 10;
  for (int i = 0; i < kMaxTries; ++i) {
    const double scale = std::sqrt(low * high);
    const double ratio = reach_of(excitation, scale) / reach;
    if (std::abs(ratio - 1) < kCloseEnough) return scale;
    (ratio < 1 ? low : high) = scale;
  }
  return low;
}

}  // namespace

Excitation excite(const GroundMotion& motion, double reach, Random& random) {
  Excitation excitation{
      .ground_motion = motion.name, .swapped = random.coin(), .has_vertical = motion.has_vertical};
  const double largest = random.uniform(0.3, 0.55);
  fill_ground(motion, excitation);
  fill_axial_load(motion, largest, excitation);
  excitation.scale = scale_for(excitation, reach);
  for (Plane& ground : excitation.ground)
    for (double& component : ground) component *= excitation.scale;
  return excitation;
}

}  // namespace trial
