// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd.hpp>

#include <algorithm>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

class IdealMachine final : public Adapter {
 public:
  explicit IdealMachine(const IdealMachineSettings& settings)
      : settings_{settings}, specimen_{settings.specimen, settings.integration_step} {
    for (const auto& axis : settings.axes) {
      const auto known = horizontal_axis_named(axis);
      if (!known)
        throw Error{"ideal_machine: axis '" + axis + "' is not driven, expected long or lat"};
      directions_.push_back(static_cast<Eigen::Index>(index_of(*known)));
    }
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports{{"opf.newTarget", Direction::Input, "1", 0, false}};
    const auto add = [&](const std::string& name, Direction direction, const char* unit) {
      ports.push_back({name, direction, unit, 0, false});
    };
    for (const auto& axis : settings_.axes) {
      add("opf." + axis + ".displ.target", Direction::Input, "m");
      add("opf." + axis + ".veloc.target", Direction::Input, "m/s");
    }
    for (const auto& axis : settings_.axes) {
      add("daq." + axis + ".displ.fbk", Direction::Output, "m");
      add("daq." + axis + ".force.fbk", Direction::Output, "N");
    }
    add("daq.switchPC", Direction::Output, "1");
    add("daq.atTarget", Direction::Output, "1");
    return ports;
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const bool has_target = step.inputs[0] > 0;
    if (has_target && !had_target_) {
      is_moving_ = true;
      arrival_ = std::max(step.time, arrival_ + settings_.simulation_step);
    }
    had_target_ = has_target;
    if (is_moving_ && !has_target && step.time >= arrival_) {
      move(step);
      is_moving_ = false;
    }
    step.outputs[step.outputs.size() - 2] = has_target ? 1 : 0;
    step.outputs[step.outputs.size() - 1] = is_moving_ ? 0 : 1;
    return step.stopping ? Status::Done : Status::Ok;
  }

 private:
  void move(const StepData& step) noexcept {
    Eigen::Vector2d displacement = Eigen::Vector2d::Zero(), velocity = displacement;
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      displacement[directions_[i]] = step.inputs[1 + 2 * i];
      velocity[directions_[i]] = step.inputs[2 + 2 * i];
    }
    const Eigen::Vector2d force =
        specimen_.advance(displacement, velocity, settings_.specimen.axial_load);
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      step.outputs[2 * i] = displacement[directions_[i]];
      step.outputs[2 * i + 1] = force[directions_[i]];
    }
  }

  IdealMachineSettings settings_;
  sim::BearingRun specimen_;
  std::vector<Eigen::Index> directions_;  ///< of each axis: 0 long, 1 lat
  bool had_target_ = false, is_moving_ = false;
  double arrival_ = 0;  ///< last or next arrival of the specimen [s]
};

}  // namespace

std::unique_ptr<Adapter> make_ideal_machine(const IdealMachineSettings& settings) {
  return std::make_unique<IdealMachine>(settings);
}

}  // namespace rths::adapters
