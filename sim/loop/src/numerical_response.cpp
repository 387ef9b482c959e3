// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/numerical_response.hpp>

#include <cmath>
#include <memory>

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

std::unique_ptr<TransferSystem> specimen_of(const sim::PlantMatrices& plant,
                                            const sim::Bearing& bearing, double time_step) {
  if (plant.bearings == 0) return std::make_unique<NoSpecimen>();
  return std::make_unique<PerfectMachine>(bearing, time_step);
}

}  // namespace

ResponseHistory::ResponseHistory(const sim::PlantMatrices& plant, double step) : time_step{step} {
  for (const auto& name : plant.floor_names) floors.push_back({name, {}, {}});
}

void ResponseHistory::append_displacement(const Eigen::Vector2d& displacement) {
  displacement_long.push_back(displacement[0]);
  displacement_lat.push_back(displacement[1]);
}

void ResponseHistory::append_floors(const sim::PlantAnalysis& analysis) {
  for (std::size_t i = 0; i < floors.size(); ++i) {
    const Eigen::Vector2d acceleration = analysis.floor_acceleration(i);
    floors[i].acceleration_long.push_back(acceleration[0]);
    floors[i].acceleration_lat.push_back(acceleration[1]);
  }
}

ResponseHistory numerical_response(const sim::PlantMatrices& plant, const sim::GroundMotion& motion,
                                   const sim::Bearing& bearing, double time_step, double duration,
                                   const AddedForce& added) {
  const double stiffness = plant.bearings > 0 ? sim::initial_stiffness(bearing) : 0;
  sim::PlantAnalysis analysis{plant, motion, stiffness, time_step, kReferenceAlpha};
  const auto alone = specimen_of(plant, bearing, time_step);
  DisturbedSpecimen specimen{*alone, added};
  ClosedLoop loop{analysis, specimen, {.period = time_step}};
  ResponseHistory history{plant, time_step};
  const auto steps = std::lround(duration / time_step);
  for (long step = 0; step < steps; ++step) {
    loop.tick();
    history.append_displacement(loop.target());
    history.force_long.push_back(specimen.force()[0]);
    history.force_lat.push_back(specimen.force()[1]);
    history.append_floors(analysis);
  }
  return history;
}

}  // namespace rths::loop
