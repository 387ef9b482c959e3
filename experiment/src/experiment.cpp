// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/experiment.hpp>

#include <algorithm>

#include <rths/core/axis.hpp>

namespace rths::experiment {

bool Experiment::has_own_solver() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const NodePlan& plan) {
    return plan.settings.role == Role::Solver && !plan.settings.program;
  });
}

bool Experiment::integrates_plant() const {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const NodePlan& plan) { return plan.settings.solver.integrates_plant; });
}

const NodePlan* Experiment::repeatable_solver() const {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [](const NodePlan& plan) {
    return plan.settings.solver.ideal_machine != nullptr;
  });
  return found == nodes.end() ? nullptr : &*found;
}

bool Experiment::solves_plant() const {
  return integrates_plant() || (plant.is_stated && repeatable_solver() == nullptr);
}

sim::GroundMotion Experiment::tested_motion() const {
  return earthquake.motion.along(horizontal_among(axes));
}

std::optional<double> Experiment::latest_end() const {
  constexpr double kMargin = 1;  // [s]
  const bool may_not_end = std::any_of(nodes.begin(), nodes.end(), [](const NodePlan& plan) {
    return plan.settings.solver.may_not_end;
  });
  if (!may_not_end) return std::nullopt;
  return time.rest + 2 * time.duration * time.rate + kMargin;
}

bool Experiment::has_user_program() const {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const NodePlan& plan) { return plan.settings.program.has_value(); });
}

const NodePlan* Experiment::node(const std::string& called) const {
  const auto found = std::find_if(nodes.begin(), nodes.end(),
                                  [&](const NodePlan& plan) { return plan.node == called; });
  return found == nodes.end() ? nullptr : &*found;
}

std::string Experiment::leading_host() const {
  for (const auto& plan : nodes)
    if (plan.settings.role == Role::Recorder) return plan.host;
  return network.hosts.empty() ? "" : network.hosts.front().name;
}

std::optional<std::string> Experiment::unguarded_machine() const {
  for (const auto& plan : nodes)
    if (plan.settings.lacks_safety &&
        (plan.settings.role == Role::Machine || plan.node == roles.machine))
      return plan.node;
  return std::nullopt;
}

recording::NamedTexts Experiment::texts() const {
  recording::NamedTexts all = config;
  for (const auto& plan : nodes) {
    if (!plan.settings.texts) continue;
    const auto own = plan.settings.texts();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

}  // namespace rths::experiment
