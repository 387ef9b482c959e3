// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/polynomials.hpp>

#include <iterator>

namespace rths::controller {
namespace {

// In the order of Polynomial.
constexpr const char* kNames[] = {"P0", "P1", "P2", "P3", "D1", "D2", "D3", "DV", "DVA"};

constexpr Jet kOne{1, 0, 0};

// Lagrange over equally spaced targets, the newest at x = 0.
Weights lagrange(int order, Jet x) {
  Weights w;
  switch (order) {
    case 0:
      w.target[0] = kOne;
      break;
    case 1:
      w.target[0] = 1 + x;
      w.target[1] = -1 * x;
      break;
    case 2:
      w.target[0] = (1 + x) * (2 + x) / 2;
      w.target[1] = -1 * x * (2 + x);
      w.target[2] = x * (1 + x) / 2;
      break;
    default:
      w.target[0] = (1 + x) * (2 + x) * (3 + x) / 6;
      w.target[1] = -1 * x * (2 + x) * (3 + x) / 2;
      w.target[2] = x * (1 + x) * (3 + x) / 2;
      w.target[3] = -1 * x * (1 + x) * (2 + x) / 6;
  }
  return w;
}

// Through the command at −1+ξ, which replaces the newest target, and older targets at −1, −2, −3.
Weights predict_from_command(int order, Jet x, double xi) {
  Weights w;
  switch (order) {
    case 1:
      w.switch_command = (1 + x) / xi;
      w.target[1] = -1 * (1 + x - xi) / xi;
      break;
    case 2:
      w.switch_command = (1 + x) * (2 + x) / (xi * (1 + xi));
      w.target[1] = -1 * (1 + x - xi) * (2 + x) / xi;
      w.target[2] = (1 + x - xi) * (1 + x) / (1 + xi);
      break;
    default:
      w.switch_command = (1 + x) * (2 + x) * (3 + x) / (xi * (1 + xi) * (2 + xi));
      w.target[1] = -1 * (1 + x - xi) * (2 + x) * (3 + x) / (2 * xi);
      w.target[2] = (1 + x - xi) * (1 + x) * (3 + x) / (1 + xi);
      w.target[3] = -1 * (1 + x - xi) * (1 + x) * (2 + x) / (2 * (2 + xi));
  }
  return w;
}

// From the command at ξ to the newest target at 1. The target at 0 is left out on purpose: the
// preceding prediction already passes through it.
Weights correct_from_command(int order, Jet x, double xi) {
  Weights w;
  switch (order) {
    case 1:
      w.target[0] = (x - xi) / (1 - xi);
      w.switch_command = (1 - x) / (1 - xi);
      break;
    case 2:
      w.target[0] = (x - xi) * (1 + x) / (2 * (1 - xi));
      w.switch_command = (1 - x) * (1 + x) / ((1 - xi) * (1 + xi));
      w.target[2] = -1 * (1 - x) * (x - xi) / (2 * (1 + xi));
      break;
    default:
      w.target[0] = (x - xi) * (1 + x) * (2 + x) / (6 * (1 - xi));
      w.switch_command = (1 - x) * (1 + x) * (2 + x) / ((1 - xi) * (1 + xi) * (2 + xi));
      w.target[2] = -1 * (1 - x) * (x - xi) * (2 + x) / (2 * (1 + xi));
      w.target[3] = (1 - x) * (x - xi) * (1 + x) / (3 * (2 + xi));
  }
  return w;
}

// Hermite cubic through the last two targets and their velocities.
Weights predict_with_velocity(Jet x) {
  Weights w;
  w.target[0] = (1 + x) * (1 + x) * (1 - 2 * x);
  w.velocity[0] = x * (1 + x) * (1 + x);
  w.target[1] = x * x * (3 + 2 * x);
  w.velocity[1] = x * x * (1 + x);
  return w;
}

// Quadratic from the command at ξ into the newest target with its velocity.
Weights correct_with_velocity(Jet x, double xi) {
  const double rest = 1 - xi;
  Weights w;
  w.target[0] = (x - xi) * (2 - x - xi) / (rest * rest);
  w.velocity[0] = -1 * (1 - x) * (x - xi) / rest;
  w.switch_command = (1 - x) * (1 - x) / (rest * rest);
  return w;
}

// Taylor from the newest target.
Weights predict_with_acceleration(Jet x) {
  Weights w;
  w.target[0] = kOne;
  w.velocity[0] = x;
  w.acceleration = x * x / 2;
  return w;
}

// Cubic from the command at ξ into the newest target with its velocity and acceleration.
Weights correct_with_acceleration(Jet x, double xi) {
  const double rest = 1 - xi;
  Weights w;
  w.target[0] = (x - xi) * (3 - 3 * x + x * x - 3 * xi + x * xi + xi * xi) / (rest * rest * rest);
  w.velocity[0] = -1 * (1 - x) * (x - xi) * (2 - x - xi) / (rest * rest);
  w.acceleration = (1 - x) * (1 - x) * (x - xi) / (2 * rest);
  w.switch_command = (1 - x) * (1 - x) * (1 - x) / (rest * rest * rest);
  return w;
}

}  // namespace

std::optional<Polynomial> polynomial_from_text(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kNames); ++i)
    if (kNames[i] == name) return static_cast<Polynomial>(i);
  return std::nullopt;
}

const char* to_text(Polynomial polynomial) noexcept {
  return kNames[static_cast<std::size_t>(polynomial)];
}

Weights weights(Polynomial polynomial, Branch branch, double x, double xi) noexcept {
  const Jet jet{x, 1, 0};
  const bool predicting = branch == Branch::Predict;
  // In the corrector's frame the newest target is at 1 instead of 0.
  const Jet from_newest = predicting ? jet : jet - 1;
  const auto number = static_cast<int>(polynomial);
  if (polynomial <= Polynomial::P3) return lagrange(number, from_newest);
  if (polynomial <= Polynomial::D3) {
    const int order = number - static_cast<int>(Polynomial::P3);
    return predicting ? predict_from_command(order, jet, xi) : correct_from_command(order, jet, xi);
  }
  if (polynomial == Polynomial::DV)
    return predicting ? predict_with_velocity(jet) : correct_with_velocity(jet, xi);
  return predicting ? predict_with_acceleration(jet) : correct_with_acceleration(jet, xi);
}

}  // namespace rths::controller
