// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/simulink_like.hpp>

#include <cmath>

#include <rths/core/file.hpp>
#include <rths/experiment/block_settings.hpp>
#include <rths/experiment/experiment.hpp>

#include "diagram.hpp"

namespace rths::adapters {
namespace {

class SimulinkLike final : public Adapter {
 public:
  SimulinkLike(const Config& file, const DiagramContext& context)
      : diagram_{file, context}, retreat_{context.retreat} {
    held_.resize(diagram_.ramped_outputs().size());
  }

  [[nodiscard]] std::vector<Port> ports() const override { return diagram_.ports(); }
  // The diagram continues to run during the stop, so monitors and handshake stay valid. Only the
  // ramped outputs, which move the machine, are overridden.
  [[nodiscard]] Status step(StepData& step) noexcept override {
    const auto& ramped = diagram_.ramped_outputs();
    if (stopped_at_ < 0) {
      for (std::size_t i = 0; i < ramped.size(); ++i)
        if (std::isfinite(step.outputs[ramped[i]])) held_[i] = step.outputs[ramped[i]];
      if (step.stopping) stopped_at_ = step.time;
    }
    diagram_.step(step.time, step.is_missed, step.inputs, step.outputs);
    if (stopped_at_ < 0 && diagram_.stop_requested()) stopped_at_ = step.time;
    if (stopped_at_ < 0) return Status::Ok;
    const double since = step.time - stopped_at_;
    for (std::size_t i = 0; i < ramped.size(); ++i)
      step.outputs[ramped[i]] = retreat_.fraction(since) * held_[i];
    return retreat_.finished(since) ? Status::Done : Status::Ok;
  }

 private:
  Diagram diagram_;
  experiment::Retreat retreat_;
  std::vector<double> held_;  ///< last finite values of the ramped outputs before the stop
  double stopped_at_ = -1;
};

}  // namespace

std::unique_ptr<Adapter> make_simulink_like(const std::filesystem::path& diagram,
                                            const DiagramContext& context) {
  return std::make_unique<SimulinkLike>(Config::load(diagram), context);
}

std::unique_ptr<Adapter> make_simulink_like_from_text(const std::string& text,
                                                      const std::string& name,
                                                      const DiagramContext& context) {
  return std::make_unique<SimulinkLike>(Config::parse(text, name), context);
}

double diagram_period(const std::filesystem::path& diagram) {
  return 1 / Config::load(diagram).number_in("base_rate_Hz", 1, 100'000);
}

using namespace experiment;

namespace {

constexpr double kPhase = 0.3e-3;  // after the machine has sampled [s]

std::map<std::string, std::string> units_of(const memmap::Map& map) {
  std::map<std::string, std::string> units;
  for (const auto& entry : map.signals()) units[entry.name] = entry.signal->unit;
  return units;
}

}  // namespace

NodeSettings read_simulink_like(const std::string& /*node*/, const Config& table,
                                const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Controller;
  const auto choice = read_diagram_choice(table);
  settings.schedule = schedule_of(diagram_period(choice.diagram), kPhase, MissedSteps::Wait);
  settings.priority = 50;
  settings.keeps_times = true;
  settings.texts = [choice] {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const auto& used : {choice.diagram, choice.constants})
      if (!used.empty())
        texts.emplace_back(used.filename().string(), read_file(used, kMostTextBytes));
    return texts;
  };
  settings.make = [choice](const Experiment& test, const NodeContext& context) {
    return make_simulink_like(
        choice.diagram,
        {test.axes, test.time.integration_step, test.time.simulation_step(), test.stop.retreat,
         units_of(context.map), std::make_shared<const sim::Bearing>(test.model.bearing),
         choice.constants, choice.blocks});
  };
  return settings;
}

}  // namespace rths::adapters
