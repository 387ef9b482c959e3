// SPDX-License-Identifier: Apache-2.0
#include "accelerometer_correction.hpp"

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/sim/composition.hpp>

namespace rths::diagnosis {
namespace {

using PerAxis = std::array<double, sim::kHorizontalAxes>;

// The channels of one record that the correction of accelerometers uses, by axis; null: none.
struct AccelerometerChannels {
  std::array<Channel*, sim::kHorizontalAxes> acceleration{};
  std::array<const Channel*, sim::kHorizontalAxes> displacement{};

  explicit AccelerometerChannels(Record& record) {
    for (auto& channel : record.channels)
      for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
        const char* name = name_of(kHorizontal[axis]);
        if (channel.role == fmt::format("acceleration.{}", name)) acceleration[axis] = &channel;
        if (channel.role == fmt::format("displacement.{}", name)) displacement[axis] = &channel;
      }
  }
  [[nodiscard]] std::vector<PerAxis> measured(std::size_t samples) const {
    std::vector<PerAxis> values(samples);
    for (std::size_t k = 0; k < samples; ++k)
      for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
        values[k][axis] = acceleration[axis] != nullptr ? acceleration[axis]->values[k] : 0;
    return values;
  }
  void set(const std::vector<PerAxis>& corrected) const {
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
      if (acceleration[axis] != nullptr)
        for (std::size_t k = 0; k < corrected.size(); ++k)
          acceleration[axis]->values[k] = corrected[k][axis];
  }
};

// Parameters of a composition of a hypothesis' terms at its values.
std::vector<double> parameters_at(const Hypothesis& hypothesis,
                                  const sim::Composition& composition) {
  std::vector<double> parameters(composition.parameters().begin(), composition.parameters().end());
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const std::string& name = hypothesis.free[i].name;
    const auto dot = name.rfind('.');
    const std::string prefix = name.substr(0, dot);
    for (const auto& term : composition.terms())
      if (term.name == prefix || term.name.starts_with(prefix + "."))
        parameters[composition.parameter_index(term.name, name.substr(dot + 1))] =
            hypothesis.values[static_cast<Index>(i)];
  }
  return parameters;
}

// One iteration of a = T⁻¹(y): adds the difference between y and T(a) to a.
void improve(std::vector<PerAxis>& a, const std::vector<PerAxis>& y, const Record& record,
             const AccelerometerChannels& channels, const sim::Composition& composition,
             const std::vector<double>& parameters) {
  std::vector<double> state(composition.states());
  for (std::size_t k = 0; k < a.size(); ++k) {
    sim::Quantities<double> q;
    q.time = record.start + static_cast<double>(k) * record.time_step;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      q.acceleration[axis] = a[k][axis];
      if (channels.displacement[axis] != nullptr)
        q.displacement[axis] = channels.displacement[axis]->values[k];
    }
    composition.advance(parameters, state, q);
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
      a[k][axis] += y[k][axis] - q.acceleration[axis];
  }
}

}  // namespace

void correct_accelerometers(const Hypothesis& named, Case& c) {
  constexpr int kRounds = 3;
  if (named.terms.empty()) return;
  std::vector<sim::TermSettings> terms;
  for (const auto& term : named.terms) terms.push_back(term.settings);
  for (auto& record : c.records) {
    const AccelerometerChannels channels{record};
    const sim::Composition composition{terms, record.time_step};
    const auto parameters = parameters_at(named, composition);
    const auto measured = channels.measured(record.samples());
    auto corrected = measured;
    for (int round = 0; round < kRounds; ++round)
      improve(corrected, measured, record, channels, composition, parameters);
    channels.set(corrected);
  }
}

}  // namespace rths::diagnosis
