// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"
#include "machine_kinds.hpp"
#include "sensor_kinds.hpp"

namespace rths::sim {
namespace {

struct SensorSaturation {
  static constexpr std::string_view kName = "saturation";
  static constexpr std::string_view kTitle = "saturation of a sensor";
  static constexpr std::string_view kEquation = "y = clip(x, x_max)";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
  enum { kLimit };
  static constexpr Parameter kParameters[] = {{"limit", kChannelUnit, 1e-9, 1e15, 1e15, 1.2e6}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    change_readings(term, q,
                    [&](std::size_t, Real& x) { x = clipped(x, term.parameters[kLimit]); });
  }
};

struct Overflow {
  static constexpr std::string_view kName = "overflow";
  static constexpr std::string_view kTitle = "overflow of a sensor (wrap-around)";
  static constexpr std::string_view kEquation = "y = x - 2 x_max round(x / (2 x_max))";
  static constexpr std::string_view kSource = "two's complement";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits | kOverflows;
  enum { kLimit };
  static constexpr Parameter kParameters[] = {{"limit", kChannelUnit, 1e-9, 1e15, 1e15, 1.2e6}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real span = 2 * term.parameters[kLimit];
    change_readings(term, q, [&](std::size_t, Real& x) {
      x -= span * std::round(value_of(x) / value_of(span));
    });
  }
};

struct Quantisation {
  static constexpr std::string_view kName = "quantisation";
  static constexpr std::string_view kTitle = "quantisation of a sensor";
  static constexpr std::string_view kEquation = "y = q round(x/q)";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits | kRounds;
  enum { kStep };
  static constexpr Parameter kParameters[] = {{"step", kChannelUnit, 0, 1e12, 0, 5e5}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real& lattice = term.parameters[kStep];
    if (!(lattice > 0)) return;
    change_readings(term, q, [&](std::size_t, Real& x) {
      x = lattice * std::round(value_of(x) / value_of(lattice));
    });
  }
};

constexpr TermKind kSensorRangeKinds[] = {kind_of<SensorSaturation>(), kind_of<Overflow>(),
                                          kind_of<Quantisation>()};

}  // namespace

std::span<const TermKind> sensor_range_kinds() { return kSensorRangeKinds; }

}  // namespace rths::sim
