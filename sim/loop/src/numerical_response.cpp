// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/numerical_response.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/loop/closed_loop.hpp>
#include <rths/loop/perfect_machine.hpp>

namespace rths::loop {
namespace {

constexpr double kReferenceAlpha = 0;  // no numerical damping in the purely numerical result

/// Of a plant without bearings.
class NoSpecimen final : public TransferSystem {
 public:
  void send(std::size_t /*controller_tick*/, const Command& command) override {
    displacement_ = command.displacement;
  }
  void move(std::size_t /*found*/, const Eigen::VectorXd& /*forces*/) override {}
  void measure(const Eigen::VectorXd& /*target*/, const Command& /*last*/) override {}
  [[nodiscard]] const Eigen::VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const override { return force_; }

 private:
  Eigen::VectorXd displacement_ = Eigen::VectorXd::Zero(2), force_ = displacement_;
};

/// A specimen with a force beside its own.
class DisturbedSpecimen final : public TransferSystem {
 public:
  DisturbedSpecimen(TransferSystem& specimen, const AddedForce& added)
      : specimen_{specimen}, added_{added} {}
  void send(std::size_t controller_tick, const Command& command) override {
    specimen_.send(controller_tick, command);
  }
  void move(std::size_t found, const Eigen::VectorXd& forces) override {
    specimen_.move(found, forces);
    force_ = specimen_.force();
    if (moves_ < added_.size()) force_.head<2>() += added_[moves_];
    ++moves_;
  }
  void measure(const Eigen::VectorXd& target, const Command& last) override {
    specimen_.measure(target, last);
  }
  [[nodiscard]] const Eigen::VectorXd& displacement() const override {
    return specimen_.displacement();
  }
  [[nodiscard]] const Eigen::VectorXd& force() const override { return force_; }

 private:
  TransferSystem& specimen_;
  const AddedForce& added_;
  std::size_t moves_ = 0;
  Eigen::VectorXd force_ = Eigen::VectorXd::Zero(2);
};

ResponseHistory response_of(sim::Substructure& analysis, TransferSystem& specimen,
                            const std::vector<std::string>& floors, double time_step,
                            double duration) {
  ClosedLoop loop{analysis, specimen, {.period = time_step}};
  ResponseHistory history{floors, time_step};
  FloorMonitor monitor{analysis, history};
  const auto steps = std::lround(duration / time_step);
  for (long step = 0; step < steps; ++step) {
    loop.tick();
    history.append_displacement(loop.target());
    history.force_long.push_back(specimen.force()[0]);
    history.force_lat.push_back(specimen.force()[1]);
    monitor.append(analysis, history);
  }
  return history;
}

}  // namespace

ResponseHistory::ResponseHistory(const std::vector<std::string>& names, double step)
    : time_step{step} {
  for (const auto& name : names) floors.push_back({name, {}, {}, {}});
}

void ResponseHistory::append_displacement(const Eigen::Vector2d& displacement) {
  displacement_long.push_back(displacement[0]);
  displacement_lat.push_back(displacement[1]);
}

FloorMonitor::FloorMonitor(const sim::Substructure& substructure, const ResponseHistory& history) {
  const auto monitors = substructure.monitors();
  values_.resize(monitors.size());
  const auto name_at = [](std::size_t floor, Axis axis) {
    return fmt::format("floor.{}.accel.{}", floor + 1, name_of(axis));
  };
  const auto place_of = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::find_if(monitors.begin(), monitors.end(),
                     [&](const auto& monitor) { return monitor.name == name; }) -
        monitors.begin());
  };
  for (std::size_t i = 0; i < history.floors.size(); ++i) {
    for (const Axis axis : kHorizontal) {
      places_.push_back(place_of(name_at(i, axis)));
      if (places_.back() == monitors.size())
        throw Error{"the structure does not monitor " + name_at(i, axis)};
    }
    const std::size_t vertical = place_of(name_at(i, Axis::Vert));
    if (vertical < monitors.size()) verticals_.push_back(vertical);
  }
}

void FloorMonitor::append(const sim::Substructure& substructure, ResponseHistory& history) {
  substructure.monitor(values_);
  for (std::size_t i = 0; i < history.floors.size(); ++i) {
    history.floors[i].acceleration_long.push_back(values_[places_[2 * i]]);
    history.floors[i].acceleration_lat.push_back(values_[places_[2 * i + 1]]);
    if (i < verticals_.size())
      history.floors[i].acceleration_vert.push_back(values_[verticals_[i]]);
  }
}

ResponseHistory numerical_response(const sim::StructureModel& structure,
                                   const sim::GroundMotion& motion, const sim::Bearing& bearing,
                                   double time_step, double duration, const AddedForce& added) {
  const auto analysis =
      structure.analysis({motion, sim::initial_stiffness(bearing), time_step, kReferenceAlpha});
  PerfectMachine machine{bearing, time_step};
  DisturbedSpecimen specimen{machine, added};
  return response_of(*analysis, specimen, structure.floors(), time_step, duration);
}

ResponseHistory fixed_base_response(const sim::StructureModel& structure,
                                    const sim::GroundMotion& motion, double time_step,
                                    double duration) {
  const auto analysis = structure.analysis_on_fixed_base({motion, 0, time_step, kReferenceAlpha});
  NoSpecimen specimen;
  return response_of(*analysis, specimen, structure.floors(), time_step, duration);
}

}  // namespace rths::loop
