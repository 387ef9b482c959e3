// SPDX-License-Identifier: Apache-2.0
// Properties that every term of the catalogue must have.
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include <rths/sim/composition.hpp>

#include "sim/term_cases.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

class EveryTerm : public testing::TestWithParam<TermKind> {};

// Copy of parameters() with one entry changed.
std::vector<double> with(std::span<const double> parameters, std::size_t i, double value) {
  std::vector<double> changed(parameters.begin(), parameters.end());
  changed[i] = value;
  return changed;
}

const Composition::Term& tested(const Composition& composition) {
  for (const auto& term : composition.terms())
    if (term.name == "tested") return term;
  throw std::logic_error{"the composition does not contain the tested term"};
}

double norm(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum);
}

TEST_P(EveryTerm, HasValidParameters) {
  for (const auto& parameter : GetParam().parameters) {
    EXPECT_LE(parameter.low, parameter.absent) << parameter.name;
    EXPECT_LE(parameter.absent, parameter.high) << parameter.name;
    EXPECT_LE(parameter.low, parameter.typical) << parameter.name;
    EXPECT_LE(parameter.typical, parameter.high) << parameter.name;
    EXPECT_FALSE(parameter.unit.empty()) << parameter.name;
  }
}

TEST_P(EveryTerm, HasNoEffectByDefault) {
  auto c = test_support::case_of(GetParam());
  const Composition alone{c.companions, c.motion.time_step};
  c.term.parameters.clear();
  const Composition both = test_support::composition_of(c);

  const auto without = test_support::outputs_of<double>(alone, alone.parameters(), c.motion);
  const auto with_it = test_support::outputs_of<double>(both, both.parameters(), c.motion);

  for (std::size_t i = 0; i < without.size(); ++i)
    ASSERT_NEAR(with_it[i], without[i], 1e-12 * std::abs(without[i])) << "output " << i;
}

// Dual numbers against central differences, by RMS over all steps: at single steps a difference
// across a kink may deviate.
TEST_P(EveryTerm, HasExactDerivatives) {
  const auto c = test_support::case_of(GetParam());
  const Composition composition = test_support::composition_of(c);
  const auto p = composition.parameters();
  const auto& term = tested(composition);
  for (std::size_t k = 0; k < term.kind->parameters.size(); ++k) {
    const std::string name{term.kind->parameters[k].name};
    if (std::find(c.fixed.begin(), c.fixed.end(), name) != c.fixed.end()) continue;
    const std::size_t i = term.first_parameter + k;
    std::vector<Dual> duals(p.begin(), p.end());
    duals[i] = Dual::variable(p[i], 1);
    const auto exact = test_support::outputs_of<Dual>(composition, duals, c.motion);
    const double h = 1e-6 * std::max(std::abs(p[i]), 1e-3 * term.kind->parameters[k].typical);
    const auto up = test_support::outputs_of<double>(composition, with(p, i, p[i] + h), c.motion);
    const auto down = test_support::outputs_of<double>(composition, with(p, i, p[i] - h), c.motion);
    for (std::size_t output = 0; output < test_support::kOutputs; ++output) {
      std::vector<double> slope, error;
      for (std::size_t n = output; n < exact.size(); n += test_support::kOutputs) {
        slope.push_back((up[n] - down[n]) / (2 * h));
        error.push_back(slope.back() - exact[n].derivative[1]);
      }
      double scale = 0;
      for (std::size_t n = output; n < up.size(); n += test_support::kOutputs)
        scale = std::max(scale, std::abs(up[n]));
      // Round-off of the difference: 1e-16 of the output over h.
      const double round_off = 1e-14 * scale / h * std::sqrt(static_cast<double>(slope.size()));
      EXPECT_LE(norm(error), 0.02 * norm(slope) + round_off) << name << ", output " << output;
    }
  }
}

// A random walk with smooth velocity through all regimes of a term.
TEST_P(EveryTerm, IsPassiveIfItDissipates) {
  if ((GetParam().traits & kDissipative) == 0) return;
  auto c = test_support::case_of(GetParam());
  c.companions.clear();
  // A pendulum's spring N u/R is conservative only at constant N.
  const bool load_varies = GetParam().name.find("pendulum") == std::string_view::npos;
  const double dt = 1e-3;
  c.motion.time_step = dt;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Composition composition = test_support::composition_of(c);
    std::vector<double> state(composition.states());
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    Quantities<double> q;
    Horizontal<double> u{}, v{}, f{};
    double work = 0, largest = 0;
    for (int i = 0; i < 20'000; ++i) {
      q = Quantities<double>{};
      q.time = i * dt;
      q.axial_load = c.motion.axial_load;
      if (load_varies) q.axial_load *= 1 + 0.5 * std::sin(40 * q.time);
      q.vertical_displacement = c.motion.vertical_offset;
      for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
        // Velocity with a correlation time of 0.2 s; restoring force with a period of 3 s.
        v[axis] += dt * (-v[axis] / 0.2 - 4.4 * u[axis] +
                         30 * c.motion.amplitude * normal(random) / std::sqrt(dt) * 0.15);
        u[axis] += dt * v[axis];
      }
      q.displacement = u;
      q.velocity = v;
      composition.advance(state, q);
      double force = 0;
      for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis) {
        work += 0.5 * (f[axis] + q.force[axis]) * v[axis] * dt;
        force += q.force[axis] * q.force[axis];
        f[axis] = q.force[axis];
      }
      largest = std::max(largest, std::sqrt(force));
      // Error of the trapezoidal rule when the force reverses within a step. The tolerance is the
      // largest force times 1e-4 of the amplitude.
      ASSERT_GE(work, -1e-4 * largest * c.motion.amplitude) << "seed " << seed << ", step " << i;
    }
    EXPECT_GT(work, 0) << "seed " << seed;
  }
}

TEST_P(EveryTerm, RotatesWithTheMotionIfItIsFrameIndifferent) {
  if ((GetParam().traits & kFrameIndifferent) == 0) return;
  const auto c = test_support::case_of(GetParam());
  const Composition composition = test_support::composition_of(c);
  const double angle = 0.7, cosine = std::cos(angle), sine = std::sin(angle);
  const auto turned = [&](const Horizontal<double>& x) {
    return Horizontal<double>{cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]};
  };
  std::vector<double> state(composition.states()), turned_state(composition.states());
  double largest = 0;
  for (int i = 0; i < c.motion.steps; ++i) {
    Quantities<double> q = test_support::motion_at(c.motion, i);
    Quantities<double> r = q;
    r.displacement = turned(q.displacement);
    r.velocity = turned(q.velocity);
    r.acceleration = turned(q.acceleration);
    composition.advance(state, q);
    composition.advance(turned_state, r);
    const auto expected = turned(q.force);
    largest = std::max({largest, std::abs(expected[0]), std::abs(expected[1])});
    ASSERT_NEAR(r.force[0], expected[0], 1e-7 * largest) << "step " << i;
    ASSERT_NEAR(r.force[1], expected[1], 1e-7 * largest) << "step " << i;
    ASSERT_NEAR(r.axial_load, q.axial_load, 1e-7 * std::abs(q.axial_load)) << "step " << i;
  }
}

TEST_P(EveryTerm, StepsInRealTime) {
  const auto c = test_support::case_of(GetParam());
  const Composition composition = test_support::composition_of(c);
  std::vector<double> state(composition.states());
  const auto run = [&] {
    for (int i = 0; i < 100; ++i) {
      Quantities<double> q = test_support::motion_at(c.motion, 7 * i);
      composition.advance(state, q);
    }
  };
  EXPECT_REALTIME(run());
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryTerm,
                         testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto& instance) { return std::string{instance.param.name}; });

}  // namespace
}  // namespace rths::sim
