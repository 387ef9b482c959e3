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
using Eigen::VectorXd;

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

/// In place of a transfer system: the force that a test fed to its integrator, by step.
class RecordedForce final : public loop::TransferSystem {
 public:
  explicit RecordedForce(const std::array<std::vector<double>, 2>& force) : recorded_{force} {}
  void send(std::size_t /*controller_tick*/, const loop::Command& command) override {
    displacement_ = command.displacement;
  }
  void move(std::size_t found, const VectorXd& /*forces*/) override {
    force_ = Vector2d{recorded_[0][found - 1], recorded_[1][found - 1]};
  }
  void measure(const VectorXd& /*target*/, const loop::Command& /*last*/) override {}
  [[nodiscard]] const VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const VectorXd& force() const override { return force_; }

 private:
  const std::array<std::vector<double>, 2>& recorded_;
  VectorXd displacement_ = VectorXd::Zero(2), force_ = displacement_;
};

void append(const VectorXd& target, Response& response) {
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

Response closed_loop(const HybridTest& test, Parts identified) {
  stop_if_interrupted();
  return has(identified, Part::Numerical) ? run_with_its_steps(test, identified)
                                          : run_with_fine_steps(test, identified);
}

Response replayed(const HybridTest& test, const std::array<std::vector<double>, 2>& force) {
  sim::PlantAnalysis analysis = analysis_of(test);
  RecordedForce recorded{force};
  loop::ClosedLoop loop{analysis, recorded, settings_of(test, kNone)};
  Response response;
  const std::size_t steps = std::min(force[0].size(), force[1].size());
  while (loop.targets() < steps) {
    loop.tick();
    append(loop.target(), response);
  }
  return response;
}

}  // namespace rths::budget
