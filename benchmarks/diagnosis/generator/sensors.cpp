// SPDX-License-Identifier: Apache-2.0
#include "sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trial {
namespace {

constexpr double kLongestAge = 0.08;  ///< of a force that is recorded [s]

// An ordinary recording's standard deviations.
constexpr double kUsualDisplacement = 0.05;  ///< [m]
constexpr double kUsualAcceleration = 1.5;   ///< [m/s²]
constexpr double kUsualForce = 5e5;          ///< [N]
constexpr double kUsualAxialLoad = 8e5;      ///< [N]

NoiseColour draw_colour(double deviation, Random& random) {
  NoiseColour colour{.deviation = deviation};
  colour.share[1] = random.uniform(0.1, 0.3);
  colour.share[2] = random.uniform(0.02, 0.1);
  colour.share[0] = 1 - colour.share[1] - colour.share[2];
  colour.corner_Hz = {random.uniform(100, 200), random.uniform(5, 12), random.uniform(0.5, 1.5)};
  return colour;
}

}  // namespace

double NoiseColour::density(double frequency_Hz) const {
  double sum = 0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    const double corner = corner_Hz[i];
    sum += share[i] * corner / (corner * corner + frequency_Hz * frequency_Hz);
  }
  return deviation * deviation * sum / std::numbers::pi;
}

Noise::Noise(const NoiseColour& colour, double sample_time, Random& random) {
  for (std::size_t i = 0; i < value_.size(); ++i) {
    const double deviation = colour.deviation * std::sqrt(colour.share[i]);
    keep_[i] = std::exp(-2 * std::numbers::pi * colour.corner_Hz[i] * sample_time);
    kick_[i] = deviation * std::sqrt(1 - keep_[i] * keep_[i]);
    value_[i] = deviation * random.gaussian();
  }
}

double Noise::next(Random& random) {
  double sum = 0;
  for (std::size_t i = 0; i < value_.size(); ++i) {
    value_[i] = keep_[i] * value_[i] + kick_[i] * random.gaussian();
    sum += value_[i];
  }
  return sum;
}

ChannelNoise draw_noise(double level, Random& random) {
  return {draw_colour(level * kUsualDisplacement, random),
          draw_colour(level * kUsualAcceleration, random), draw_colour(level * kUsualForce, random),
          draw_colour(level * kUsualAxialLoad, random)};
}

double quantised(double value, double step) {
  return step > 0 ? step * std::nearbyint(value / step) : value;
}

LoadCell::LoadCell(const Physics& physics, double step)
    : physics_(physics), step_(step), history_(static_cast<std::size_t>(kLongestAge / step) + 3) {}

void LoadCell::advance(const Plane& force, const Boundary& platen) {
  const Physics& p = physics_;
  time_ = platen.time;
  const Plane crossed{force[0] + p[kCrossXY] * force[1], force[1] + p[kCrossYX] * force[0]};
  newest_ = (newest_ + 1) % history_.size();
  for (std::size_t i = 0; i < 2; ++i) {
    double output = crossed[i] + p[kVerticalX + i] * (platen.axial_load - kReferenceLoad);
    output *= 1 + p[kGainX + i];
    output += p[kDriftX + i] * platen.time / kRecordLength;
    output = std::clamp(output, -p[kClipLimit], p[kClipLimit]);
    undelayed_[i] = output + p[kAbsolute] * (std::abs(output) - output);
    const double share = p[kLag] > 0 ? -std::expm1(-step_ / p[kLag]) : 1;
    lagged_[i] += share * (undelayed_[i] - lagged_[i]);
    history_[newest_][i] = lagged_[i];
  }
}

Plane LoadCell::recorded() const {
  const double age =
      std::min((physics_[kSkew] + physics_[kClock] * time_) / step_, kLongestAge / step_);
  const double whole = std::floor(age);
  const std::size_t back = history_.size() - static_cast<std::size_t>(whole);
  const Plane& later = history_[(newest_ + back) % history_.size()];
  const Plane& earlier = history_[(newest_ + back - 1) % history_.size()];
  Plane recorded{};
  for (std::size_t i = 0; i < 2; ++i)
    recorded[i] = later[i] + (age - whole) * (earlier[i] - later[i]) + physics_[kOffsetX + i];
  return recorded;
}

Plane accelerometer(const Physics& p, const Boundary& platen) {
  Plane output{};
  for (std::size_t i = 0; i < 2; ++i)
    output[i] = (1 + p[kAccelerationGainX + i]) * platen.acceleration[i] +
                kStandardGravity * p[kTiltX + i] * platen.displacement[i] +
                p[kAccelerationDriftX + i] * platen.time / kRecordLength +
                p[kAccelerationOffsetX + i];
  return output;
}

}  // namespace trial
