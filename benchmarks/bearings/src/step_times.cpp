// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/step_times.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>

#include <rths/bench/stamp.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {
namespace {

// Keeps the compiler from removing the computation.
volatile double sink;

template <class Real>
sim::Quantities<Real> converted(const sim::Quantities<double>& from) {
  sim::Quantities<Real> q;
  q.time = from.time;
  for (std::size_t i = 0; i < sim::kHorizontalAxes; ++i) {
    q.displacement[i] = from.displacement[i];
    q.velocity[i] = from.velocity[i];
    q.acceleration[i] = from.acceleration[i];
  }
  q.vertical_displacement = from.vertical_displacement;
  q.vertical_velocity = from.vertical_velocity;
  q.axial_load = from.axial_load;
  return q;
}

template <class Real>
double pass_time(const sim::Composition& composition, const std::vector<Real>& parameters,
                 const Shaking& shaking, double tick) {
  std::vector<Real> state(composition.states());
  const std::uint64_t begun = stamp_between();
  for (const auto& inputs : shaking) {
    auto q = converted<Real>(inputs);
    composition.advance(parameters, state, q);
    sink = sim::value_of(q.force[0]);
  }
  return static_cast<double>(stamp_between() - begun) * tick / static_cast<double>(shaking.size());
}

}  // namespace

StepTimes step_times(const sim::Composition& composition, const Shaking& shaking, int passes,
                     double tick) {
  std::vector<double> all, quickest(shaking.size(), std::numeric_limits<double>::infinity());
  all.reserve(shaking.size() * static_cast<std::size_t>(passes));
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<double> state(composition.states(), 0.0);
    for (std::size_t i = 0; i < shaking.size(); ++i) {
      sim::Quantities<double> q = shaking[i];
      const std::uint64_t before = stamp_between();
      const std::uint64_t begun = stamp_between();
      composition.advance(state, q);
      const std::uint64_t after = stamp_between();
      sink = q.force[0];
      const auto ticks = static_cast<double>(after - begun) - static_cast<double>(begun - before);
      const double time = std::max(1.0, ticks) * tick;
      all.push_back(time);
      quickest[i] = std::min(quickest[i], time);
    }
  }
  std::sort(all.begin(), all.end());
  return {quantile(all, 0.5), quantile(all, 0.99), quantile(all, 0.999), all.back(),
          *std::max_element(quickest.begin(), quickest.end())};
}

double dual_ratio(const sim::Composition& composition, const Shaking& shaking, int passes,
                  double tick) {
  const std::vector<double> plain(composition.parameters().begin(), composition.parameters().end());
  std::vector<sim::Dual> duals(plain.begin(), plain.end());
  for (std::size_t i = 0; i < std::min(duals.size(), sim::Dual::kLanes); ++i)
    duals[i] = sim::Dual::variable(plain[i], i);
  std::vector<double> ratios;
  for (int pass = 0; pass < passes; ++pass)
    ratios.push_back(pass_time(composition, duals, shaking, tick) /
                     pass_time(composition, plain, shaking, tick));
  return median(ratios);
}

double loop_time(const sim::Composition& composition, const Shaking& shaking, int bearings,
                 double tick) {
  const auto count = static_cast<std::size_t>(bearings);
  const std::size_t states = composition.states();
  std::vector<double> state(states * count, 0.0), times;
  for (const auto& inputs : shaking) {
    const std::uint64_t begun = stamp_between();
    for (std::size_t b = 0; b < count; ++b) {
      sim::Quantities<double> q = inputs;
      // Each bearing moves slightly differently, as in a building that rotates.
      const double factor = 1 + 0.1 * static_cast<double>(b) / static_cast<double>(count);
      for (auto* pair : {&q.displacement, &q.velocity})
        for (double& component : *pair) component *= factor;
      composition.advance(std::span{state}.subspan(b * states, states), q);
      sink = q.force[0];
    }
    times.push_back(static_cast<double>(stamp_between() - begun) * tick / bearings);
  }
  return median(times);
}

}  // namespace rths::bench
