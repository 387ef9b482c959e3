// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <rths/sim/term.hpp>

#include "kinds.hpp"

namespace rths::sim {

std::span<const TermKind> sensor_cross_kinds();
std::span<const TermKind> sensor_range_kinds();
std::span<const TermKind> sensor_scale_kinds();
std::span<const TermKind> sensor_time_kinds();

/// The readings of a sensor term's channel, one per axis; nullptr for the axial load.
template <class Real>
Horizontal<Real>* horizontal_channel(const TermView<Real>& term, Quantities<Real>& q) {
  switch (term.channel) {
    case SensorChannel::Force:
      return &q.force;
    case SensorChannel::Displacement:
      return &q.displacement;
    case SensorChannel::Acceleration:
      return &q.acceleration;
    case SensorChannel::AxialLoad:
      break;
  }
  return nullptr;
}

/// Calls `change(index, reading)` for each reading that the term acts on, index 0 or 1.
template <class Real, class Change>
void change_readings(const TermView<Real>& term, Quantities<Real>& q, Change change) {
  Horizontal<Real>* readings = horizontal_channel(term, q);
  if (readings == nullptr) return change(std::size_t{0}, q.axial_load);
  for_each_active_axis(term, [&](std::size_t axis) { change(axis, (*readings)[axis]); });
}

inline constexpr unsigned kSensorTraits = kPerAxis | kPerChannel;

}  // namespace rths::sim
