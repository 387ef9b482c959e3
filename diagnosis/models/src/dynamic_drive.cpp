// SPDX-License-Identifier: Apache-2.0
#include "dynamic_drive.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/identification/signal.hpp>

#include "dynamic_simulator.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kStartShare = 0.1;      // of a record: determines its first state
constexpr double kDiverged = 1e6;        // of the largest measurement
constexpr double kForgotten = 1e-3;      // of the largest measurement
constexpr double kRateTolerance = 1e-3;  // of a sampled system's time step

// Measured outputs of the settling time, or if there is none the beginning of the record.
MatrixXd beginning_of(const DynamicDrive& drive) {
  const auto most = static_cast<Index>(kStartShare * static_cast<double>(drive.rows()));
  const Index rows = drive.first_row > 0 ? drive.first_row : most;
  return drive.measured.topRows(std::clamp<Index>(rows, 1, drive.rows()));
}

// Signals whose inputs are larger in a gap, each by its largest value.
DynamicSignals with_change(DynamicSignals signals, std::pair<std::size_t, std::size_t> gap) {
  for (auto& input : signals.inputs) {
    const double size = VectorXd::Map(input.data(), std::ssize(input)).cwiseAbs().maxCoeff();
    for (std::size_t row = gap.first + 1; row < gap.second; ++row) input[row] += size;
  }
  return signals;
}

// By row: 0 in the gaps of a record and behind them until the model as stated has forgotten the
// lost inputs.
ArrayXd present_rows(const DynamicModel& model, const Hypothesis& base, const Record& record,
                     const DynamicDrive& drive) {
  const auto run = [&](const DynamicSignals& signals, MatrixXd& prediction) {
    std::vector<MatrixXd> none;
    return DynamicSimulator{model, base, nullptr, drive.time_step, signals}.run(base.values, {},
                                                                                prediction, none);
  };
  MatrixXd with, without;
  const bool is_predicted = run(drive.signals, without);
  const ArrayXXd least = kForgotten * drive.measured.cwiseAbs().colwise().maxCoeff();
  // The last row that a change of the inputs in a gap still changes.
  const auto last_remembered = [&](const std::pair<std::size_t, std::size_t>& gap) {
    Index row = drive.rows() - 1;
    const DynamicSignals changed = with_change(drive.signals, gap);
    if (!is_predicted || !run(changed, with)) return row;
    while (row > static_cast<Index>(gap.second) &&
           ((with - without).row(row).cwiseAbs().array() <= least).all())
      --row;
    return row;
  };
  ArrayXd present = ArrayXd::Ones(drive.rows());
  for (const auto& gap : record.gaps) {
    const auto first = static_cast<Index>(gap.first);
    present.segment(first, last_remembered(gap) - first + 1).setZero();
  }
  return present;
}

}  // namespace

const Channel& channel_of(const Record& record, const std::string& role) {
  const Channel* channel = record.find(role);
  if (channel == nullptr)
    throw Error{fmt::format("{}: the model needs the channel {}, which was not recorded",
                            record.name, role)};
  return *channel;
}

std::unique_ptr<DynamicDrive> dynamic_drive(const DynamicModel& model, const Hypothesis& base,
                                            const Record& record) {
  if (model.sampled_every > 0 &&
      std::abs(record.time_step / model.sampled_every - 1) > kRateTolerance)
    throw Error{fmt::format("{}: sampled every {} s, but the model has a time step of {} s",
                            record.name, record.time_step, model.sampled_every)};
  auto drive = std::make_unique<DynamicDrive>();
  drive->start = drive->signals.start = record.start;
  drive->time_step = record.time_step;
  drive->has_time = record.has_time;
  drive->first_row = static_cast<Index>(std::lround(record.settle / record.time_step));
  drive->measured.resize(static_cast<Index>(record.samples()),
                         static_cast<Index>(model.outputs.size()));
  drive->velocity = drive->measured;
  for (Index i = 0; i < drive->measured.cols(); ++i) {
    const Channel& output = channel_of(record, model.outputs[static_cast<std::size_t>(i)]);
    drive->measured.col(i) = values_of(output);
    drive->state_names.push_back({output.role, output.unit});
    drive->velocity.col(i) = rate_of(drive->measured.col(i), record.time_step);
  }
  drive->displacement = drive->measured;
  for (const auto& role : model.inputs) {
    const Channel& channel = channel_of(record, role);
    drive->signals.inputs.push_back(channel.values);
    drive->states.emplace_back(fmt::format("{} [{}]", role, channel.unit), values_of(channel));
  }
  const double largest = drive->measured.cwiseAbs().maxCoeff();
  drive->signals.limit = kDiverged * (largest > 0 ? largest : 1);
  if (model.has_free_start) {
    drive->signals.beginning = beginning_of(*drive);
    const DynamicSimulator stated{model, base, nullptr, drive->time_step, drive->signals};
    drive->signals.start_state = stated.start(base.values);
  }
  if (!record.gaps.empty()) drive->present = present_rows(model, base, record, *drive);
  return drive;
}

std::unique_ptr<DynamicDrive> with_noise(const DynamicModel& model, const DynamicDrive& drive,
                                         const Record& noise) {
  auto result = std::make_unique<DynamicDrive>(drive);
  for (Index i = 0; i < result->measured.cols(); ++i)
    if (const Channel* channel = noise.find(model.outputs[static_cast<std::size_t>(i)]))
      result->measured.col(i) += values_of(*channel);
  result->signals.beginning = result->measured.topRows(result->signals.beginning.rows());
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    if (const Channel* channel = noise.find(model.inputs[i])) {
      auto& values = result->signals.inputs[i];
      std::transform(values.begin(), values.end(), channel->values.begin(), values.begin(),
                     std::plus<>{});
    }
  return result;
}

}  // namespace rths::diagnosis
