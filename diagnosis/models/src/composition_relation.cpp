// SPDX-License-Identifier: Apache-2.0
#include "composition_relation.hpp"

#include <algorithm>

#include <rths/identification/signal.hpp>

#include "composition_simulator.hpp"

namespace rths::diagnosis {
namespace {

Predicted predicted_by(const MotionChannels& channels) {
  if (channels.predicted == "force") return Predicted::Force;
  return channels.predicted == "displacement" ? Predicted::Displacement : Predicted::Acceleration;
}

Place place_of(Predicted predicted) {
  if (predicted == Predicted::Force) return kOnForce;
  return predicted == Predicted::Displacement ? kOnActuator : kOnAccelerometer;
}

double peak(const VectorXd& signal) { return signal.size() > 0 ? signal.cwiseAbs().maxCoeff() : 0; }

// By the motion and the measurement of one axis.
void widen(NaturalScale& scale, const MotionDrive& drive, std::size_t axis, Index output,
           Predicted predicted) {
  const VectorXd measured = drive.measured.col(output);
  scale.displacement = std::max(scale.displacement, peak(drive.motion[axis]));
  // Of the measured motion, not of the command: only the measurement shows a limit.
  scale.velocity = std::max(
      scale.velocity, peak(predicted == Predicted::Displacement ? rate_of(measured, drive.time_step)
                                                                : drive.rate[axis]));
  scale.acceleration = std::max(scale.acceleration, peak(drive.second_rate[axis]));
  scale.force = std::max(scale.force, peak(drive.specimen_force[axis]));
  scale.output = std::max(scale.output, peak(measured));
  scale.duration = std::max(scale.duration, static_cast<double>(drive.rows()) * drive.time_step);
  scale.auxiliary = std::max(scale.auxiliary, peak(drive.auxiliary));
  scale.has_time = drive.has_time;
  scale.has_temperature = scale.has_temperature || drive.temperature.size() > 0;
}

// A signal rotated in time. The end, which filters distort, stays in place.
VectorXd rotated(const VectorXd& signal, Index valid, Index offset) {
  VectorXd result = signal;
  valid = std::min(valid, signal.size());
  result.head(valid - offset) = signal.segment(offset, valid - offset);
  result.segment(valid - offset, offset) = signal.head(offset);
  return result;
}

// Adds noise to a drive. Rotating the noise by some rows makes several realisations of one draw. As
// in every drive, motions have zero mean while at rest.
class Disturbance {
 public:
  Disturbance(const Record& record, const MotionDrive& noise)
      : noise_{noise}, valid_{noise.all_rows * noise.thinning} {
    if (!record.quiet) return;
    const double steps = record.time_step / noise.model_step;
    from_ = static_cast<Index>(static_cast<double>(record.quiet->first) * steps);
    quiet_ = static_cast<Index>(static_cast<double>(record.quiet->second) * steps) - from_;
  }

  [[nodiscard]] std::unique_ptr<Drive> of(const MotionDrive& drive, Index rows) const {
    auto sum = std::make_unique<MotionDrive>(drive);
    const Index offset = rows * noise_.thinning;
    const auto add = [&](VectorXd& to, const VectorXd& from, bool is_motion) {
      if (to.size() == 0 || to.size() != from.size()) return;
      VectorXd noise = rotated(from, valid_, offset);
      if (is_motion && quiet_ > 0) noise.array() -= noise.segment(from_, quiet_).mean();
      to += noise;
    };
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      add(sum->motion[axis], noise_.motion[axis], true);
      add(sum->rate[axis], noise_.rate[axis], false);
      add(sum->second_rate[axis], noise_.second_rate[axis], true);
      add(sum->specimen_force[axis], noise_.specimen_force[axis], false);
    }
    add(sum->axial_load, noise_.axial_load, false);
    for (Index output = 0; output < sum->measured.cols(); ++output)
      sum->measured.col(output) += rotated(noise_.measured.col(output), noise_.all_rows, rows);
    return sum;
  }

 private:
  const MotionDrive& noise_;
  Index valid_;
  Index from_ = 0, quiet_ = 0;  // steps at rest
};

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
  if (predicted == Predicted::Force)
    setup_.pace.motion_cutoff = motion_cutoff(records, setup_.channels, setup_.axes);
  constexpr double kNothing = 1e-12;
  scale_ = {kNothing, kNothing, kNothing, 0, 0, kNothing, kNothing, 0, false, 1};
  axis_scales_.assign(setup_.axes.size(), scale_);
  double load = 0;
  const auto& channels = records[0]->channels;
  const auto control = std::find_if(channels.begin(), channels.end(), [](const Channel& channel) {
    return channel.role.starts_with("auxiliary.");
  });
  if (control != channels.end()) {
    const std::string name = control->role.substr(control->role.find('.') + 1);
    const auto name_control = [&](NaturalScale& scale) {
      scale.auxiliary_unit = control->unit;
      scale.auxiliary_name = name;
    };
    name_control(scale_);
    for (auto& scale : axis_scales_) name_control(scale);
  }
  for (const Record* record : records) {
    const auto drive = motion_drive(*record, setup_.channels, setup_.axes, setup_.pace);
    for (std::size_t i = 0; i < setup_.axes.size(); ++i)
      for (NaturalScale* scale : {&scale_, &axis_scales_[i]})
        widen(*scale, *drive, setup_.axes[i], static_cast<Index>(i), predicted);
    if (drive->axial_load.size() > 0)
      load += drive->axial_load.mean() / static_cast<double>(records.size());
  }
  scale_.axial_load = load;
  for (auto& scale : axis_scales_) scale.axial_load = load;
}

std::vector<Candidate> CompositionRelation::candidates(const Hypothesis& model) const {
  auto candidates = candidates_of(place_of(predicted_by(setup_.channels)), model, scale_,
                                  setup_.axes, axis_scales_, setup_.without);
  // A term that differs forwards and backwards has a mean. Where no offset is free, it would be
  // named instead of one. Beside a friction, the mean is its own in rows without time: they have no
  // rest, which would show an offset, and the zero of a published loop lies in its middle.
  if (!setup_.has_free_offsets)
    for (auto& candidate : candidates) {
      if (candidate.name == "asymmetric_friction") {
        candidate.after = {"coulomb_friction"};
        if (!scale_.has_time) candidate.sum_of = {"coulomb_friction", "force_offset"};
      }
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

int CompositionRelation::rotations() const {
  // The acceleration follows from a displacement by differences: a cut in its noise is not allowed.
  return predicted_by(setup_.channels) == Predicted::Acceleration ? 1 : 4;
}

std::vector<std::unique_ptr<Drive>> CompositionRelation::disturbed(const Drive& drive,
                                                                   const Record& noise) const {
  const auto more = motion_drive(noise, setup_.channels, setup_.axes, setup_.pace);
  const Disturbance disturbance{noise, *more};
  std::vector<std::unique_ptr<Drive>> all;
  for (int i = 0; i < rotations(); ++i)
    all.push_back(
        disturbance.of(dynamic_cast<const MotionDrive&>(drive), i * more->all_rows / rotations()));
  return all;
}

std::unique_ptr<Simulator> CompositionRelation::simulator(const Hypothesis& hypothesis,
                                                          const Drive& drive) const {
  return std::make_unique<CompositionSimulator>(hypothesis, dynamic_cast<const MotionDrive&>(drive),
                                                predicted_by(setup_.channels), setup_.axes);
}

}  // namespace rths::diagnosis
