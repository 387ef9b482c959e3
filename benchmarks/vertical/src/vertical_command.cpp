// SPDX-License-Identifier: Apache-2.0
#include "vertical_command.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace rths::bench {
namespace {

constexpr double kStep = 1e-4;     // of the reaction [s]
constexpr double kMode = 9.5;      // [Hz]
constexpr double kDamping = 0.05;  // ratio
constexpr double kSofter = 0.85;   // stiffness in decompression over that in compression
constexpr double kFadeIn = 2.0;    // [s]
constexpr double kLowest = 0.5, kHighest = 20;  // of the ground motion [Hz]
constexpr int kSines = 60;

double fade(double time) { return std::clamp(time / kFadeIn, 0.0, 1.0); }

}  // namespace

VerticalCommand::VerticalCommand(double duration) : duration_{duration} {
  std::mt19937_64 random{5};
  std::uniform_real_distribution<double> uniform{0, 1};
  struct Sine {
    double omega, phase;
  };
  std::vector<Sine> sines;
  for (int i = 0; i < kSines; ++i)
    sines.push_back(
        {2 * std::numbers::pi * (kLowest + (kHighest - kLowest) * (i + uniform(random)) / kSines),
         2 * std::numbers::pi * uniform(random)});
  // ẍ + 2ζω ẋ + ω² k(x) x = −a, by semi-implicit steps; the reaction is the spring's and dashpot's.
  const double omega = 2 * std::numbers::pi * kMode;
  double x = 0, v = 0, peak = 0;
  const long steps = std::lround(duration / kStep) + 20;
  for (long i = 0; i < steps; ++i) {
    const double time = static_cast<double>(i) * kStep;
    double ground = 0;
    for (const auto& sine : sines) ground += std::sin(sine.omega * time + sine.phase);
    const double reaction = omega * omega * (x < 0 ? x : kSofter * x) + 2 * kDamping * omega * v;
    v += kStep * (-fade(time) * ground - reaction);
    x += kStep * v;
    reaction_.push_back(-reaction);
    peak = std::max(peak, std::abs(reaction));
  }
  for (double& value : reaction_) value *= kForcePeak / peak;
}

double VerticalCommand::force(double time) const {
  const double at = time / kStep;
  const auto i = std::min(static_cast<std::size_t>(at), reaction_.size() - 2);
  const double part = at - static_cast<double>(i);
  return kPreload + (1 - part) * reaction_[i] + part * reaction_[i + 1];
}

double VerticalCommand::horizontal(double time) const {
  return fade(time) * kHorizontalPeak *
         std::sin(2 * std::numbers::pi * kHorizontalFrequency * time);
}

}  // namespace rths::bench
