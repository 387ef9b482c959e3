// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/closed_loop.hpp>

#include <algorithm>
#include <cmath>

#include <rths/core/interrupted.hpp>
#include <rths/loop/closed_loop.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "modelled_transfer.hpp"

namespace rths::budget {
namespace {

using Eigen::Vector2d;

constexpr double kRounding = 1e-9;  // of a count of steps times their length [s]

// As identified: a target per integration step.
sim::PlantAnalysis analysis_of(const HybridTest& test) {
  return {test.plant,
          test.motion,
          test.implicit_stiffness,
          test.integration_step,
          test.alpha,
          sim::VerticalFeedback::Model,
          test.substeps};
}

// A host that is as simulated is never late.
loop::ClosedLoopSettings settings_of(const HybridTest& test, Parts identified) {
  loop::ClosedLoopSettings settings;
  settings.period = test.period;
  settings.rate = test.rate;
  settings.tested.assign(test.tested.begin(), test.tested.end());
  settings.host = test.host;
  settings.targets_act_early = true;
  if (has(identified, Part::Host)) return settings;
  settings.host.order = {};
  settings.host.arrivals.clear();
  return settings;
}

void append(const Eigen::VectorXd& target, Response& response) {
  response[0].push_back(target[0]);
  response[1].push_back(target[1]);
}

// As simulated: a target per controller period, which is its command.
Response run_with_fine_steps(const HybridTest& test, Parts identified) {
  const double step = test.period / test.rate;  // model time
  sim::PlantAnalysis analysis{test.plant, test.motion, test.implicit_stiffness, step, test.alpha};
  const auto settings = settings_of(test, identified);
  ModelledTransfer transfer{test, identified,
                            settings.host.order.machine_ticks(test.host.first_target + 1)};
  loop::ClosedLoop loop{analysis, transfer, settings};
  Response response;
  const auto steps = static_cast<std::size_t>(std::llround(test.duration / step));
  const auto per_sample = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::llround(test.integration_step / step)));
  while (loop.targets() < steps) {
    loop.tick();
    if (loop.targets() % per_sample == 0) append(loop.target(), response);
  }
  return response;
}

// The numerical side as it ran: targets once per integration step, after the time of computing.
Response run_with_its_steps(const HybridTest& test, Parts identified) {
  auto settings = settings_of(test, identified);
  settings.path = {test.command,
                   {test.sampling_delay.begin(), test.sampling_delay.end()},
                   test.target_force && test.target_force->lead_time > 0};
  auto& command = settings.path->settings;
  command.axes = 2;
  command.integration_step = test.integration_step;
  command.simulation_step = test.rate * test.integration_step;
  sim::PlantAnalysis analysis = analysis_of(test);
  ModelledTransfer transfer{test, identified, 0};
  loop::ClosedLoop loop{analysis, transfer, settings};
  Response response;
  const auto steps =
      static_cast<std::size_t>(std::ceil(test.duration / test.integration_step - kRounding));
  while (response[0].size() < steps) {
    loop.tick();
    if (loop.targets() > response[0].size()) append(loop.target(), response);
  }
  return response;
}

}  // namespace

std::vector<double> noise_of(const std::vector<double>& signal, std::size_t reach) {
  std::vector<double> noise(signal.size(), 0.0);
  const auto m = static_cast<double>(reach);
  // Weights of the smoothing parabola at its middle.
  const double divisor = (2 * m - 1) * (2 * m + 1) * (2 * m + 3) / 3;
  for (std::size_t i = reach; i + reach < signal.size(); ++i) {
    double smooth = 0;
    for (std::size_t j = 0; j <= 2 * reach; ++j) {
      const double x = static_cast<double>(j) - m;
      smooth += (3 * m * m + 3 * m - 1 - 5 * x * x) / divisor * signal[i + j - reach];
    }
    noise[i] = signal[i] - smooth;
  }
  return noise;
}

Response closed_loop(const HybridTest& test, Parts identified) {
  stop_if_interrupted();
  return has(identified, Part::Numerical) ? run_with_its_steps(test, identified)
                                          : run_with_fine_steps(test, identified);
}

Response replayed(const HybridTest& test, const std::array<std::vector<double>, 2>& force) {
  sim::PlantAnalysis analysis = analysis_of(test);
  Response response;
  const std::size_t steps = std::min(force[0].size(), force[1].size());
  for (std::size_t k = 0; k < steps; ++k) {
    const Vector2d target = analysis.predict();
    for (std::size_t i = 0; i < 2; ++i)
      response[i].push_back(test.tested[i] ? target[static_cast<Eigen::Index>(i)] : 0);
    analysis.correct({force[0][k], force[1][k]});
  }
  return response;
}

}  // namespace rths::budget
