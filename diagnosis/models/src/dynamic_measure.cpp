// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "dynamic_drive.hpp"
#include "dynamic_simulator.hpp"

namespace rths::diagnosis {
namespace {

double largest(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

// Largest motions of the connections in a run of the simulation as stated.
void measure_motion(const DynamicModel& model, const Hypothesis& base, const Record& record,
                    DynamicSizes& sizes) {
  const auto drive = dynamic_drive(model, base, record);
  const DynamicSimulator run{model, base, nullptr, record.time_step, drive->signals};
  const auto motion = run.motion(base.values);
  const std::size_t count = model.connections.size();
  if (motion.empty() && count > 0)
    throw Error{fmt::format("{}: the model as stated diverges", record.name)};
  for (std::size_t i = 0; i < count; ++i) {
    ConnectionSize& size = sizes.connections[i];
    size.displacement = std::max(size.displacement, largest(motion[i]));
    size.velocity = std::max(size.velocity, largest(motion[count + i]));
    size.acceleration = std::max(size.acceleration, largest(motion[2 * count + i]));
  }
}

double force_of(const DynamicModel& model, const LinearSystem& linear, Index i,
                const DynamicSizes& sizes) {
  const Connection& connection = model.connections[static_cast<std::size_t>(i)];
  const ConnectionSize& size = sizes.connections[static_cast<std::size_t>(i)];
  if (connection.like_input) return sizes.inputs[*connection.like_input].peak;
  if (connection.like_output) return sizes.outputs[*connection.like_output].peak;
  if (connection.is_of_unit_mass)
    return size.displacement > 0 ? size.velocity * size.velocity / size.displacement : 0;
  const double mobility = std::abs(linear.r.row(i).dot(linear.e.col(i)));
  const double inertia = mobility > 0 && size.displacement > 0
                             ? size.velocity * size.velocity / (mobility * size.displacement)
                             : 0;
  return std::max(
      {linear.stiffness[i] * size.displacement, linear.damping[i] * size.velocity, inertia});
}

}  // namespace

DynamicSizes measured_sizes(const DynamicModel& model, const Hypothesis& base,
                            const std::vector<const Record*>& records) {
  DynamicSizes sizes;
  sizes.inputs.resize(model.inputs.size());
  sizes.outputs.resize(model.outputs.size());
  sizes.connections.resize(model.connections.size());
  sizes.time_step = records.front()->time_step;
  sizes.has_time = records.front()->has_time;
  for (std::size_t i = 0; i < model.inputs.size(); ++i)
    sizes.inputs[i].unit = channel_of(*records.front(), model.inputs[i]).unit;
  for (std::size_t i = 0; i < model.outputs.size(); ++i)
    sizes.outputs[i].unit = channel_of(*records.front(), model.outputs[i]).unit;
  for (const Record* record : records) {
    const double step = record->time_step;
    for (std::size_t i = 0; i < model.inputs.size(); ++i)
      enlarge(sizes.inputs[i], channel_of(*record, model.inputs[i]).values, step);
    for (std::size_t i = 0; i < model.outputs.size(); ++i)
      enlarge(sizes.outputs[i], channel_of(*record, model.outputs[i]).values, step);
    measure_motion(model, base, *record, sizes);
  }
  const LinearSystem linear = model.linear(model.values());
  for (std::size_t i = 0; i < model.connections.size(); ++i) {
    const auto at = static_cast<Index>(i);
    sizes.connections[i].force = force_of(model, linear, at, sizes);
    sizes.connections[i].has_spring = linear.stiffness[at] != 0;
  }
  return sizes;
}

}  // namespace rths::diagnosis
