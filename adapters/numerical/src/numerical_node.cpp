// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/numerical.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {

using namespace experiment;

namespace {

constexpr double kPeriod = 0.25e-3, kPhase = 0.1e-3;  // [s]

sim::VerticalFeedback read_vertical_feedback(const Config& table) {
  const std::string source = table.text("vertical_feedback", "model");
  if (source == "model") return sim::VerticalFeedback::Model;
  if (source != "measured")
    table.fail("vertical_feedback",
               "vertical_feedback is '" + source + "', expected model or measured");
  return sim::VerticalFeedback::Measured;
}

}  // namespace

std::unique_ptr<Adapter> make_numerical_node(const Experiment& setup, const NodeContext& context,
                                             Handshake handshake, sim::VerticalFeedback vertical) {
  NumericalSettings settings;
  settings.handshake = handshake;
  settings.axes = setup.axes;
  settings.plant = setup.plant.structure;
  settings.motion = setup.earthquake.motion;
  settings.bearing_initial_stiffness = sim::initial_stiffness(setup.model.bearing);
  settings.integration_step = setup.time.integration_step;
  settings.alpha = setup.solver.alpha;
  settings.substeps = setup.solver.substeps;
  settings.duration = setup.time.duration;
  settings.rest = setup.time.rest;
  settings.wait_deadline = setup.solver.wait_deadline * setup.time.rate;
  if (context.is_virtual || setup.solver.models_computing_time)
    settings.computing_time = setup.solver.computing_time;
  settings.history = setup.history;
  settings.vertical_feedback = vertical;
  return make_numerical(settings);
}

// Polls its flags four times per millisecond.
NodeSettings read_numerical(const std::string& /*node*/, const Config& table,
                            const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Solver;
  settings.schedule = schedule_of(kPeriod, kPhase, MissedSteps::Skip);
  settings.priority = 40;
  settings.solver.integrates_plant = true;
  settings.solver.has_computing_time = settings.solver.waits_for_flags = true;
  settings.make = [handshake = read_handshake(table), vertical = read_vertical_feedback(table)](
                      const Experiment& setup, const NodeContext& context) {
    return make_numerical_node(setup, context, handshake, vertical);
  };
  return settings;
}

}  // namespace rths::adapters
