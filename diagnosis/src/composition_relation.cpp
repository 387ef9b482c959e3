// SPDX-License-Identifier: Apache-2.0
#include "composition_relation.hpp"

#include <algorithm>

#include <rths/diagnosis/signal.hpp>

#include "composition_simulator.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::VectorXd;

Predicted predicted_by(const MotionChannels& channels) {
  if (channels.predicted == "force") return Predicted::Force;
  return channels.predicted == "displacement" ? Predicted::Displacement : Predicted::Acceleration;
}

Place place_of(Predicted predicted) {
  if (predicted == Predicted::Force) return Place::Force;
  return predicted == Predicted::Displacement ? Place::Actuator : Place::Accelerometer;
}

double peak(const VectorXd& signal) { return signal.size() > 0 ? signal.cwiseAbs().maxCoeff() : 0; }

// Of what an actuator did, not of what it was told: a limit is seen in that.
double peak_rate(const MotionDrive& drive) {
  double most = 0;
  for (Eigen::Index output = 0; output < drive.measured.cols(); ++output)
    most = std::max(most, peak(rate_of(drive.measured.col(output), drive.time_step)));
  return most;
}

void widen(NaturalScale& scale, const MotionDrive& drive, const std::vector<std::size_t>& axes,
           Predicted predicted) {
  for (const std::size_t axis : axes) {
    scale.displacement = std::max(scale.displacement, peak(drive.motion[axis]));
    scale.velocity =
        std::max(scale.velocity,
                 predicted == Predicted::Displacement ? peak_rate(drive) : peak(drive.rate[axis]));
    scale.acceleration = std::max(scale.acceleration, peak(drive.second_rate[axis]));
    scale.force = std::max(scale.force, peak(drive.specimen_force[axis]));
  }
  scale.output = std::max(scale.output, drive.measured.cwiseAbs().maxCoeff());
  scale.duration = std::max(scale.duration, static_cast<double>(drive.rows()) * drive.time_step);
  scale.auxiliary = std::max(scale.auxiliary, peak(drive.auxiliary));
  scale.has_temperature = scale.has_temperature || drive.temperature.size() > 0;
}

// Adds a signal that is turned round in time, but for its end, which filters have spoilt.
void add_turned(Eigen::Ref<VectorXd> to, const VectorXd& what, Eigen::Index valid,
                Eigen::Index turn) {
  if (to.size() == 0 || to.size() != what.size()) return;
  valid = std::min(valid, what.size());
  const Eigen::Index after = valid - turn;
  to.head(after) += what.segment(turn, after);
  to.segment(after, turn) += what.head(turn);
  to.tail(to.size() - valid) += what.tail(to.size() - valid);
}

std::unique_ptr<Drive> sum_of(const MotionDrive& drive, const MotionDrive& noise,
                              Eigen::Index rows) {
  auto sum = std::make_unique<MotionDrive>(drive);
  sum->known.reset();
  const auto add = [&](VectorXd& to, const VectorXd& what) {
    add_turned(to, what, noise.all_rows * noise.thinning, rows * noise.thinning);
  };
  for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
    add(sum->motion[axis], noise.motion[axis]);
    add(sum->rate[axis], noise.rate[axis]);
    add(sum->second_rate[axis], noise.second_rate[axis]);
    add(sum->specimen_force[axis], noise.specimen_force[axis]);
  }
  add(sum->axial_load, noise.axial_load);
  for (Eigen::Index output = 0; output < sum->measured.cols(); ++output)
    add_turned(sum->measured.col(output), noise.measured.col(output), noise.all_rows, rows);
  return sum;
}

}  // namespace

CompositionRelation::CompositionRelation(CompositionSetup setup,
                                         const std::vector<const Record*>& records)
    : setup_{std::move(setup)} {
  const Predicted predicted = predicted_by(setup_.channels);
  const char* unit = predicted == Predicted::Force          ? "N"
                     : predicted == Predicted::Displacement ? "m"
                                                            : "m/s2";
  for (const std::size_t axis : setup_.axes)
    outputs_.emplace_back(setup_.channels.predicted + "." + axis_name(axis), unit);
  constexpr double kNothing = 1e-12;
  scale_ = {kNothing, kNothing, kNothing, 0, 0, kNothing, kNothing, 0, false};
  double load = 0;
  for (const Record* record : records) {
    const auto drive = motion_drive(*record, setup_.channels, setup_.axes, setup_.pace);
    widen(scale_, *drive, setup_.axes, predicted);
    if (drive->axial_load.size() > 0)
      load += drive->axial_load.mean() / static_cast<double>(records.size());
  }
  scale_.axial_load = load;
}

std::vector<Candidate> CompositionRelation::candidates() const {
  auto candidates = candidates_of(place_of(predicted_by(setup_.channels)), setup_.base, scale_,
                                  setup_.axes, setup_.without);
  // What differs forwards and backwards has a mean: where no offset is free, it would be taken for
  // one, and named in its place.
  if (!setup_.has_free_offsets)
    for (auto& candidate : candidates) {
      if (candidate.name == "asymmetric_friction") candidate.after = {"coulomb_friction"};
      if (candidate.name.starts_with("asymmetric_")) candidate.after.emplace_back("force_offset");
    }
  return candidates;
}

std::vector<std::string> CompositionRelation::drivers() const {
  std::vector<std::string> roles;
  for (const std::size_t axis : setup_.axes)
    roles.push_back(setup_.channels.motion + "." + axis_name(axis));
  return roles;
}

std::unique_ptr<Drive> CompositionRelation::prepare(const Record& record) const {
  return motion_drive(record, setup_.channels, setup_.axes, setup_.pace);
}

std::vector<std::unique_ptr<Drive>> CompositionRelation::disturbed(const Drive& drive,
                                                                   const Record& noise) const {
  constexpr Eigen::Index kTurns = 4;
  const auto more = motion_drive(noise, setup_.channels, setup_.axes, setup_.pace);
  std::vector<std::unique_ptr<Drive>> all;
  for (Eigen::Index turn = 0; turn < kTurns; ++turn) {
    const Eigen::Index rows = turn * more->all_rows / kTurns;
    all.push_back(sum_of(dynamic_cast<const MotionDrive&>(drive), *more, rows));
  }
  return all;
}

std::unique_ptr<Simulator> CompositionRelation::simulator(const Hypothesis& hypothesis,
                                                          const Drive& drive) const {
  return std::make_unique<CompositionSimulator>(hypothesis, dynamic_cast<const MotionDrive&>(drive),
                                                predicted_by(setup_.channels), setup_.axes);
}

}  // namespace rths::diagnosis
