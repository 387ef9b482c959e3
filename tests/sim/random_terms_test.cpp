// SPDX-License-Identifier: Apache-2.0
// Properties of every term with random parameters.
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/core/error.hpp>
#include <rths/sim/composition.hpp>

#include "sim/term_cases.hpp"

namespace rths::sim {
namespace {

constexpr unsigned kSets = 10;  // of parameters, per kind
constexpr int kRandomSteps = 1000;

class AnyTerm : public testing::TestWithParam<TermKind> {
 protected:
  // Log-uniform within a decade of the typical value and within the bounds. If the typical value is
  // zero or negative, or the range is narrow: uniform between the bounds.
  static double drawn(const Parameter& p, std::mt19937& random) {
    std::uniform_real_distribution<double> even;
    if (p.unit == "-" && p.high - p.low <= 20) return p.low + (p.high - p.low) * even(random);
    if (!(p.typical > 0)) return p.typical;
    return std::clamp(p.typical * std::pow(10, 2 * even(random) - 1), p.low, p.high);
  }
  // Invalid bearings (radii in the wrong order) are refused and drawn again.
  static test_support::TermCase drawn_case(unsigned seed) {
    std::mt19937 random{seed};
    for (int attempt = 0; attempt < 1000; ++attempt) {
      auto c = test_support::case_of(GetParam());
      c.term.parameters.clear();
      for (const auto& p : GetParam().parameters)
        c.term.parameters.emplace_back(p.name, drawn(p, random));
      try {
        static_cast<void>(test_support::composition_of(c));
        return c;
      } catch (const Error&) {
      }
    }
    throw std::logic_error{"no valid parameters found"};
  }
  static std::string described(const test_support::TermCase& c, unsigned seed) {
    std::string text = fmt::format("seed {}:", seed);
    for (const auto& [name, value] : c.term.parameters) text += fmt::format(" {} {}", name, value);
    return text;
  }
};

// Steps of up to 40 of the bearing's yield displacements in random directions.
Quantities<double> violent(std::mt19937& random, const test_support::Motion& motion, int i,
                           const Horizontal<double>& before) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even;
  constexpr double kYieldDisplacement = 2.855e-3;
  Quantities<double> q;
  q.time = i * motion.time_step;
  const double step = kYieldDisplacement * 40 * std::pow(even(random), 3);
  for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
    q.displacement[axis] = 0.9 * before[axis] + step * std::clamp(normal(random), -2.0, 2.0);
    q.velocity[axis] = (q.displacement[axis] - before[axis]) / motion.time_step;
  }
  q.axial_load = motion.axial_load * (1 + 0.5 * normal(random));
  q.vertical_displacement = motion.vertical_amplitude * normal(random);
  return q;
}

TEST_P(AnyTerm, StaysFiniteUnderViolentMotion) {
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    const auto c = drawn_case(seed);
    SCOPED_TRACE(described(c, seed));
    const Composition composition = test_support::composition_of(c);
    std::vector<double> state(composition.states());
    std::mt19937 random{seed};
    Horizontal<double> u{};
    for (int i = 0; i < kRandomSteps; ++i) {
      auto q = violent(random, c.motion, i, u);
      u = q.displacement;
      composition.advance(state, q);
      for (const auto& pair : {q.displacement, q.acceleration, q.force})
        for (const double value : pair) ASSERT_TRUE(std::isfinite(value)) << "step " << i;
      ASSERT_TRUE(std::isfinite(q.axial_load)) << "step " << i;
    }
  }
}

TEST_P(AnyTerm, IsPassiveIfItDissipates) {
  if ((GetParam().traits & kDissipative) == 0) return;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    auto c = drawn_case(seed);
    SCOPED_TRACE(described(c, seed));
    c.companions.clear();
    c.motion.time_step = 1e-3;
    const Composition composition = test_support::composition_of(c);
    std::vector<double> state(composition.states());
    double work = 0, turnover = 0;
    Horizontal<double> f{}, u{};
    for (int i = 0; i < 4 * kRandomSteps; ++i) {
      auto q = test_support::motion_at(c.motion, i);
      // At constant load, because a pendulum's spring exchanges work with a varying load.
      q.axial_load = c.motion.axial_load;
      q.vertical_displacement = c.motion.vertical_offset;
      const auto now = q.displacement;
      composition.advance(state, q);
      for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
        const double increment = 0.5 * (f[axis] + q.force[axis]) * (now[axis] - u[axis]);
        work += increment;
        turnover += std::abs(increment);
        f[axis] = q.force[axis];
        u[axis] = now[axis];
      }
      // Error of the trapezoidal rule at corners of the force.
      ASSERT_GE(work, -1e-3 * turnover) << "step " << i;
    }
  }
}

TEST_P(AnyTerm, RotatesWithTheMotionIfItIsFrameIndifferent) {
  if ((GetParam().traits & kFrameIndifferent) == 0) return;
  const double cosine = std::cos(0.7), sine = std::sin(0.7);
  const auto turned = [&](const Horizontal<double>& x) {
    return Horizontal<double>{cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]};
  };
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    auto c = drawn_case(seed);
    // A coupling below 1 is not frame-indifferent.
    for (auto& [name, value] : c.term.parameters)
      if (name == "coupling") value = 1;
    SCOPED_TRACE(described(c, seed));
    const Composition composition = test_support::composition_of(c);
    std::vector<double> state(composition.states()), turned_state(composition.states());
    double largest = 0;
    for (int i = 0; i < c.motion.steps; ++i) {
      auto q = test_support::motion_at(c.motion, i);
      auto r = q;
      r.displacement = turned(q.displacement);
      r.velocity = turned(q.velocity);
      r.acceleration = turned(q.acceleration);
      composition.advance(state, q);
      composition.advance(turned_state, r);
      const auto expected = turned(q.force);
      largest = std::max({largest, std::abs(expected[0]), std::abs(expected[1])});
      ASSERT_NEAR(r.force[0], expected[0], 1e-6 * largest) << "step " << i;
      ASSERT_NEAR(r.force[1], expected[1], 1e-6 * largest) << "step " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, AnyTerm,
                         testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto& instance) { return std::string{instance.param.name}; });

}  // namespace
}  // namespace rths::sim
