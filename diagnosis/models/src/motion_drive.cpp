// SPDX-License-Identifier: Apache-2.0
#include "motion_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/identification/signal.hpp>

namespace rths::diagnosis {
namespace {

// Energy dissipated up to each step: the smallest value of the work done from that step on,
// because stored energy is returned later.
// @param power  input power, by step [W]
VectorXd dissipated_energy(const VectorXd& power, double time_step) {
  VectorXd energy(power.size());
  double work = 0;
  for (Index k = 0; k < power.size(); ++k) energy[k] = work += power[k] * time_step;
  for (Index k = power.size() - 2; k >= 0; --k) energy[k] = std::min(energy[k], energy[k + 1]);
  return energy.cwiseMax(0);
}

// Adds the states, besides displacement and velocity, over which a residual of forces is mapped:
// axial load, temperature, control, acceleration of each axis, dissipated energy.
// @param auxiliary  the channel that controls a device; null: none
void add_state_axes(const std::vector<std::size_t>& axes, bool predicts_force,
                    const Channel* auxiliary, MotionDrive& drive) {
  const auto add = [&](const std::string& name, const VectorXd& values) {
    if (values.size() > 0) drive.states.emplace_back(name, drive.compared(values));
  };
  add("axial load [N]", drive.axial_load);
  add("temperature [K]", drive.temperature);
  if (auxiliary != nullptr)
    add(fmt::format("{} [{}]", auxiliary->role, auxiliary->unit), drive.auxiliary);
  if (!predicts_force) return;
  VectorXd power = VectorXd::Zero(drive.motion[axes[0]].size());
  for (const std::size_t axis : axes) {
    add(fmt::format("acceleration.{} [m/s2]", axis_name(axis)), drive.second_rate[axis]);
    power += drive.specimen_force[axis].cwiseProduct(drive.rate[axis]);
  }
  // Unfiltered: the filter overshoots where motion begins.
  const VectorXd energy = thinned(dissipated_energy(power, drive.model_step), drive.thinning);
  drive.states.emplace_back("dissipated energy [J]", energy.head(drive.measured.rows()));
}

constexpr int kOrder = 4;               // of filters, one pass
constexpr double kModelCutoff = 0.36;   // of the model's rate: below half of it
constexpr double kLowestCrossover = 2;  // between displacement and acceleration [Hz]
constexpr double kSpoiltTime = 1;       // at the end, by filters and fusing [s]
constexpr double kSpoiltShare = 0.02;   // of the record, at most
constexpr double kSpoiltPeriods = 2;    // of the comparison's cutoff, where the record has an edge

VectorXd column(const Record& record, const std::string& role) {
  const Channel* channel = record.find(role);
  if (channel == nullptr) return {};
  return Eigen::Map<const VectorXd>(channel->values.data(),
                                    static_cast<Index>(channel->values.size()));
}

const Channel* first_auxiliary(const Record& record) {
  for (const auto& channel : record.channels)
    if (channel.role.starts_with("auxiliary.")) return &channel;
  return nullptr;
}

VectorXd without_rest(VectorXd signal, const Record& record) {
  if (signal.size() == 0 || !record.quiet) return signal;
  const auto [from, to] = *record.quiet;
  const double level =
      signal.segment(static_cast<Index>(from), static_cast<Index>(to - from)).mean();
  return signal.array() - level;
}

// Standard deviation of the white noise, from differences of neighbouring samples.
double jitter(const VectorXd& signal, const Record& record) {
  Index from = 0, count = signal.size();
  if (record.quiet) {
    from = static_cast<Index>(record.quiet->first);
    count = static_cast<Index>(record.quiet->second) - from;
  }
  const VectorXd x = signal.segment(from, count);
  const VectorXd step = x.tail(count - 1) - x.head(count - 1);
  return std::sqrt((step.array() - step.mean()).square().mean() / 2);
}

VectorXd fused_motion(const Record& record, const VectorXd& displacement,
                      const VectorXd& acceleration) {
  const double least = 1e-9;
  const double ratio = std::max(jitter(acceleration, record), least) /
                       std::max(jitter(displacement, record), least * least);
  const double crossover = std::max(kLowestCrossover, std::sqrt(ratio) / (2 * std::numbers::pi));
  return fused(displacement, acceleration, std::min(crossover, 0.2 / record.time_step),
               record.time_step);
}

// Filters and thins samples of the record to steps of the model.
class Thinner {
 public:
  Thinner(const Record& record, const SampleRates& pace)
      : step_{record.time_step},
        factor_{std::max(1, static_cast<int>(std::round(1 / (step_ * pace.model_rate))))},
        cutoff_{kModelCutoff / model_step()} {
    // The record's own rate ends little above the cutoff: no filter.
    constexpr double kEnds = 0.3;
    const bool is_needed = pace.drive_cutoff > 0 && pace.drive_cutoff < kEnds / step_;
    if (is_needed) cutoff_ = std::min(cutoff_, pace.drive_cutoff);
    filters_ = factor_ > 1 || is_needed;
  }
  // Without time, all rows are used as they are.
  explicit Thinner(const Record& record)
      : step_{record.time_step}, factor_{1}, cutoff_{0}, filters_{false} {}
  [[nodiscard]] double model_step() const { return step_ * factor_; }
  [[nodiscard]] VectorXd operator()(const VectorXd& signal) const {
    if (signal.size() == 0 || !filters_) return signal;
    return thinned(low_passed(signal, kOrder, cutoff_, step_), factor_);
  }

 private:
  double step_;
  int factor_;
  double cutoff_;
  bool filters_;
};

struct Filtering {
  Thinner thin;
  double motion_cutoff;
};

void take_motion(const Record& record, const MotionChannels& channels, std::size_t axis,
                 const Filtering& filtering, MotionDrive& drive) {
  const std::string& name = axis_name(axis);
  VectorXd motion = without_rest(column(record, channels.motion + "." + name), record);
  if (motion.size() == 0)
    throw Error{fmt::format("{}: {}.{} is not recorded, but the model is driven by it", record.name,
                            channels.motion, name)};
  const VectorXd acceleration = without_rest(column(record, "acceleration." + name), record);
  const bool fuses = channels.fuses_acceleration && acceleration.size() > 0;
  if (fuses)
    motion = fused_motion(record, motion, acceleration);
  else if (filtering.motion_cutoff > 0)
    motion = low_passed(motion, kOrder, filtering.motion_cutoff, record.time_step);
  // Differences damp high frequencies, so they are taken before thinning.
  drive.motion[axis] = filtering.thin(motion);
  drive.rate[axis] = filtering.thin(rate_of(motion, record.time_step));
  drive.second_rate[axis] =
      filtering.thin(fuses ? acceleration : second_rate_of(motion, record.time_step));
}

VectorXd predicted_channel(const Record& record, const MotionChannels& channels, std::size_t axis) {
  const std::string& name = axis_name(axis);
  VectorXd signal = column(record, channels.predicted + "." + name);
  if (signal.size() == 0)
    throw Error{fmt::format("{}: {}.{} is not recorded, but the model predicts it", record.name,
                            channels.predicted, name)};
  if (channels.predicted != "force") signal = without_rest(signal, record);
  const VectorXd acceleration = without_rest(column(record, "acceleration." + name), record);
  if (channels.fuses_prediction && acceleration.size() > 0)
    signal = fused_motion(record, signal, acceleration);
  return signal;
}

// Time at the start that the filter of the comparison spoils, since it does not know what was
// before [s]: none if the record begins at rest.
double spoilt_start(const Record& record, double cutoff) {
  if (cutoff <= 0) return 0;
  const double spoilt = kSpoiltPeriods / cutoff;
  const bool begins_at_rest =
      record.quiet && static_cast<double>(record.quiet->first) * record.time_step < spoilt;
  return begins_at_rest ? 0 : spoilt;
}

// Rows that the gaps of a record spoil, also through the filter of the comparison.
ArrayXd present_rows(const Record& record, const MotionDrive& drive) {
  constexpr double kLeastSpread = 0.1;  // of filters [s]
  if (record.gaps.empty()) return {};
  const double spread =
      std::max(kLeastSpread, drive.cutoff > 0 ? kSpoiltPeriods / drive.cutoff : 0);
  ArrayXd present = ArrayXd::Ones(drive.all_rows);
  const auto row_at = [&](double time) {
    return std::clamp<Index>(static_cast<Index>(time / drive.time_step), 0, drive.all_rows - 1);
  };
  for (const auto& [last, next] : record.gaps) {
    const Index from = row_at(static_cast<double>(last) * record.time_step - spread);
    const Index to = row_at(static_cast<double>(next) * record.time_step + spread);
    present.segment(from, to - from + 1).setZero();
  }
  return present;
}

}  // namespace

const std::string& axis_name(std::size_t axis) {
  static const auto names = names_of(kHorizontal);
  return names[axis];
}

VectorXd MotionDrive::compared(const VectorXd& signal) const {
  return compared_columns(signal).col(0);
}

MatrixXd MotionDrive::compared_columns(const MatrixXd& signals) const {
  if (cutoff <= 0) return signals.topRows(std::min(signals.rows(), all_rows));
  const MatrixXd smooth = low_passed_columns(signals, kOrder, cutoff, model_step);
  MatrixXd result(std::min((smooth.rows() + thinning - 1) / thinning, all_rows), smooth.cols());
  for (Index i = 0; i < result.cols(); ++i)
    result.col(i) = thinned(smooth.col(i), thinning).head(result.rows());
  return result;
}

std::unique_ptr<MotionDrive> motion_drive(const Record& record, const MotionChannels& channels,
                                          const std::vector<std::size_t>& axes,
                                          const SampleRates& pace) {
  auto drive = std::make_unique<MotionDrive>();
  const Thinner thinner = record.has_time ? Thinner{record, pace} : Thinner{record};
  drive->has_time = record.has_time;
  drive->model_step = thinner.model_step();
  drive->thinning =
      std::max(1, static_cast<int>(std::round(1 / (drive->model_step * pace.compare_rate))));
  // A record sampled no faster than the comparison rate needs no filter.
  drive->cutoff = record.has_time && pace.cutoff < 0.45 / drive->model_step ? pace.cutoff : 0;
  if (drive->cutoff == 0) drive->thinning = 1;
  drive->start = record.start;
  drive->time_step = drive->model_step * drive->thinning;
  for (const std::size_t axis : axes)
    take_motion(record, channels, axis, {thinner, pace.motion_cutoff}, *drive);
  for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
    drive->specimen_force[axis] = thinner(column(record, "force." + axis_name(axis)));
  drive->axial_load = thinner(column(record, "vertical_force"));
  drive->temperature = thinner(column(record, "temperature"));
  const Channel* auxiliary = first_auxiliary(record);
  if (auxiliary != nullptr) drive->auxiliary = thinner(column(record, auxiliary->role));

  const Index steps = drive->motion[axes[0]].size();
  const Index rows = (steps + drive->thinning - 1) / drive->thinning;
  const double length = static_cast<double>(rows) * drive->time_step;
  const double spoilt_time = record.has_time ? std::min(kSpoiltTime, kSpoiltShare * length) : 0;
  const auto spoilt = static_cast<Index>(spoilt_time / drive->time_step);
  drive->all_rows = std::max<Index>(1, rows - spoilt);
  const double settled = std::max(record.settle, spoilt_start(record, drive->cutoff));
  drive->first_row = std::min<Index>(static_cast<Index>(std::ceil(settled / drive->time_step)),
                                     drive->all_rows - 1);
  drive->present = present_rows(record, *drive);
  drive->measured.resize(drive->all_rows, static_cast<Index>(axes.size()));
  drive->displacement.resize(drive->all_rows, static_cast<Index>(axes.size()));
  drive->velocity = drive->displacement;
  drive->state_names.assign(axes.size(), {"displacement", "m"});
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto output = static_cast<Index>(i);
    drive->measured.col(output) =
        drive->compared(thinner(predicted_channel(record, channels, axes[i])));
    // State of the platen; for an actuator, the predicted quantity itself.
    const bool is_actuator = channels.predicted == "displacement";
    drive->displacement.col(output) = is_actuator ? VectorXd{drive->measured.col(output)}
                                                  : drive->compared(drive->motion[axes[i]]);
    drive->velocity.col(output) = is_actuator
                                      ? rate_of(drive->measured.col(output), drive->time_step)
                                      : drive->compared(drive->rate[axes[i]]);
  }
  add_state_axes(axes, channels.predicted == "force", auxiliary, *drive);
  return drive;
}

double motion_cutoff(const std::vector<const Record*>& records, const MotionChannels& channels,
                     const std::vector<std::size_t>& axes) {
  constexpr double kMargin = 1.5;    // the filter keeps what lies just below the noise
  constexpr double kHighest = 0.25;  // of the sampling rate: a higher cutoff removes little
  const double time_step = records[0]->time_step;
  if (!records[0]->has_time) return 0;
  std::vector<VectorXd> motions, at_rest;
  for (const Record* record : records)
    for (const std::size_t axis : axes) {
      motions.push_back(column(*record, channels.motion + "." + axis_name(axis)));
      if (!record->quiet || record->time_step != time_step || motions.back().size() == 0) return 0;
      const auto [from, to] = *record->quiet;
      at_rest.push_back(
          motions.back().segment(static_cast<Index>(from), static_cast<Index>(to - from)));
    }
  const double cutoff = kMargin * noise_begins(motions, at_rest, time_step);
  return cutoff < kHighest / time_step ? cutoff : 0;
}

}  // namespace rths::diagnosis
