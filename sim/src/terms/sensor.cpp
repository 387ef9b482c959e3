// SPDX-License-Identifier: Apache-2.0
#include <rths/core/constants.hpp>

#include "delay_line.hpp"
#include "kinds.hpp"
#include "lag.hpp"

namespace rths::sim {
namespace {

// The readings of a sensor term's channel, one per axis; nullptr for the axial load.
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

// Calls `change(index, reading)` for each reading that the term acts on, index 0 or 1.
template <class Real, class Change>
void change_readings(const TermView<Real>& term, Quantities<Real>& q, Change change) {
  Horizontal<Real>* readings = horizontal_channel(term, q);
  if (readings == nullptr) return change(std::size_t{0}, q.axial_load);
  for_each_active_axis(term, [&](std::size_t axis) { change(axis, (*readings)[axis]); });
}

constexpr unsigned kSensorTraits = kPerAxis | kPerChannel;

// A sensor with `Law::change(parameters, reading)`, the same for each reading.
template <class Law, unsigned traits = kPlain>
struct ChangesReadings : Acts<Stage::Sensor, kSensorTraits | traits> {
  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    change_readings(term, q, [&](std::size_t, Real& x) { Law::change(term.parameters, x); });
  }
};

struct CrosstalkHorizontal : Acts<Stage::Sensor, kPerChannel> {
  static constexpr Text kName = "crosstalk_horizontal";
  static constexpr Text kTitle = "crosstalk between the horizontal axes";
  static constexpr Text kEquation = "y_long = x_long + c_1 x_lat,  y_lat = x_lat + c_2 x_long";
  enum { kLatIntoLong, kLongIntoLat };
  static constexpr Parameter kParameters[] = {{"lat_into_long", "-", -1, 1, 0, 0.01},
                                              {"long_into_lat", "-", -1, 1, 0, 0.01}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    Horizontal<Real>* x = horizontal_channel(term, q);
    if (x == nullptr) return;
    const Real along = (*x)[0];
    (*x)[0] += term.parameters[kLatIntoLong] * (*x)[1];
    (*x)[1] += term.parameters[kLongIntoLat] * along;
  }
};

struct CrosstalkVertical : Acts<Stage::Sensor, kPerAxis> {
  static constexpr Text kName = "crosstalk_vertical";
  static constexpr Text kTitle = "vertical crosstalk into the horizontal load cells";
  static constexpr Text kEquation = "y = F + c (N - N_0)";
  enum { kShare, kReference };
  static constexpr Parameter kParameters[] = {{"share", "-", -1, 1, 0, 5e-3},
                                              {"reference_load", "N", -1e9, 1e9, 0, 9.7e6}};

  static auto force(const auto& term, const auto& q, std::size_t) {
    return term.parameters[kShare] * (q.axial_load - term.parameters[kReference]);
  }
};

struct AccelerometerTilt : Acts<Stage::Sensor, kPerAxis> {
  static constexpr Text kName = "accelerometer_tilt";
  static constexpr Text kTitle = "tilted accelerometer";
  static constexpr Text kEquation = "y = a + g (theta_0 + theta_u u),  g = 9.80665";
  static constexpr Text kSource = "textbook, sin(theta) = theta";
  enum { kTilt, kPerDisplacement };
  static constexpr Parameter kParameters[] = {
      {"tilt", "rad", -0.5, 0.5, 0, 0.02}, {"tilt_per_displacement", "rad/m", -1e5, 1e5, 0, 0.1}};

  static void step(const auto& term, auto& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      q.acceleration[axis] +=
          kStandardGravity *
          (term.parameters[kTilt] + term.parameters[kPerDisplacement] * q.displacement[axis]);
    });
  }
};

struct SensorGain : ChangesReadings<SensorGain> {
  static constexpr Text kName = "gain";
  static constexpr Text kTitle = "gain error of a sensor";
  static constexpr Text kEquation = "y = g x";
  enum { kFactor };
  static constexpr Parameter kParameters[] = {{"factor", "-", -10, 10, 1, 1.02}};

  static void change(const auto* p, auto& x) { x *= p[kFactor]; }
};

struct CubicDistortion : ChangesReadings<CubicDistortion> {
  static constexpr Text kName = "cubic_distortion";
  static constexpr Text kTitle = "cubic distortion of a sensor";
  static constexpr Text kEquation = "y = x (1 + c (x/x_r)^2)";
  enum { kShare, kRange };
  static constexpr Parameter kParameters[] = {{"share", "-", -1, 1, 0, 0.02},
                                              {"range", kChannelUnit, 1e-9, 1e12, 1e6, 1e6}};

  static void change(const auto* p, auto& x) {
    const auto ratio = x / p[kRange];
    x *= 1 + p[kShare] * ratio * ratio;
  }
};

struct AbsoluteValueSensor : ChangesReadings<AbsoluteValueSensor> {
  static constexpr Text kName = "absolute_value_sensor";
  static constexpr Text kTitle = "sensor that loses the sign";
  static constexpr Text kEquation = "y = (1 - a) x + a |x|";
  static constexpr Text kSource = "ours; a = 1: the sign is lost completely";
  enum { kShare };
  static constexpr Parameter kParameters[] = {{"share", "-", 0, 1, 0, 1}};

  static void change(const auto* p, auto& x) { x += p[kShare] * (abs(x) - x); }
};

struct Offset : ChangesReadings<Offset, kConstant> {
  static constexpr Text kName = "offset";
  static constexpr Text kTitle = "offset of a sensor";
  static constexpr Text kEquation = "y = x + d_0";
  enum { kOffset };
  static constexpr Parameter kParameters[] = {{"offset", kChannelUnit, -1e9, 1e9, 0, 2e4}};

  static void change(const auto* p, auto& x) { x += p[kOffset]; }
};

struct Drift : Acts<Stage::Sensor, kSensorTraits> {
  static constexpr Text kName = "drift";
  static constexpr Text kTitle = "drift of a sensor";
  static constexpr Text kEquation = "y = x + d_1 (t - t_0),  t_0: the first step";
  enum { kRate };
  static constexpr Parameter kParameters[] = {{"rate", "channel/s", -1e9, 1e9, 0, 1e4}};
  static constexpr std::size_t kStates = 2;  // started, t_0

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    if (term.state[0] == 0) term.state[0] = 1.0, term.state[1] = q.time;
    const double elapsed = q.time - value_of(term.state[1]);
    change_readings(term, q, [&](std::size_t, Real& x) { x += term.parameters[kRate] * elapsed; });
  }
};

constexpr double kLongestSkew = 0.2;  // [s]

TermSize skew_size(const TermSetup& setup, std::size_t more) {
  using Line = DelayLine<double>;
  const std::size_t capacity = Line::capacity(kLongestSkew, setup.time_step);
  return {Line::states(capacity, kHorizontalAxes) + more, 0};
}

template <class Real>
void skew(const TermView<Real>& term, Quantities<Real>& q, Real* state, const Real& age) {
  DelayLine<Real> line{state, DelayLine<Real>::capacity(kLongestSkew, term.time_step)};
  line.advance(within(age, 0, kLongestSkew) * (1 / term.time_step));
  change_readings(term, q, [&](std::size_t index, Real& x) { x = line.exchange(index, x); });
}

struct TimeSkew : Acts<Stage::Sensor, kSensorTraits> {
  static constexpr Text kName = "time_skew";
  static constexpr Text kTitle = "time skew of a sensor";
  static constexpr Text kEquation = "y(t) = x(t - tau)";
  static constexpr Text kSource = "textbook; cubic interpolation";
  enum { kSkew };
  static constexpr Parameter kParameters[] = {{"skew", "s", 0, kLongestSkew, 0, 3e-3}};

  static TermSize size(const TermSetup& setup) { return skew_size(setup, 0); }

  static void step(const auto& term, auto& q) { skew(term, q, term.state, term.parameters[kSkew]); }
};

struct ClockDrift : Acts<Stage::Sensor, kSensorTraits> {
  static constexpr Text kName = "clock_drift";
  static constexpr Text kTitle = "clock drift of a sensor";
  static constexpr Text kEquation =
      "y(t) = x(t - tau - epsilon (t - t_0)),  t_0: the first step,  0 <= age <= 0.2 s";
  static constexpr Text kSource = "textbook; cubic interpolation";
  enum { kSkew, kRate };
  static constexpr Parameter kParameters[] = {{"skew", "s", 0, kLongestSkew, 0, 3e-3},
                                              {"rate", "-", -0.01, 0.01, 0, 1e-4}};

  static TermSize size(const TermSetup& setup) { return skew_size(setup, 2); }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    if (term.state[0] == 0) term.state[0] = 1.0, term.state[1] = q.time;
    const double elapsed = q.time - value_of(term.state[1]);
    skew<Real>(term, q, term.state + 2, term.parameters[kSkew] + term.parameters[kRate] * elapsed);
  }
};

struct FilterLag : Acts<Stage::Sensor, kSensorTraits> {
  static constexpr Text kName = "filter_lag";
  static constexpr Text kTitle = "first-order filter of a sensor";
  static constexpr Text kEquation = "T y' + y = x";
  static constexpr Text kSource = "textbook, exact for x cubic through the last four samples";
  enum { kTimeConstant };
  static constexpr Parameter kParameters[] = {{"time_constant", "s", 0, 10, 0, 5e-3}};
  static constexpr std::size_t kStates = kHorizontalAxes * SmoothLag<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const SmoothLag<Real> lag{term.parameters[kTimeConstant], term.time_step};
    change_readings(term, q, [&](std::size_t index, Real& x) {
      x = lag(term.state + index * SmoothLag<Real>::kStates, x);
    });
  }
};

struct SensorSaturation : ChangesReadings<SensorSaturation> {
  static constexpr Text kName = "saturation";
  static constexpr Text kTitle = "saturation of a sensor";
  static constexpr Text kEquation = "y = clip(x, x_max)";
  enum { kLimit };
  static constexpr Parameter kParameters[] = {{"limit", kChannelUnit, 1e-9, 1e15, 1e15, 1.2e6}};

  static void change(const auto* p, auto& x) { x = clipped(x, p[kLimit]); }
};

struct Overflow : ChangesReadings<Overflow, kOverflows> {
  static constexpr Text kName = "overflow";
  static constexpr Text kTitle = "overflow of a sensor (wrap-around)";
  static constexpr Text kEquation = "y = x - 2 x_max round(x / (2 x_max))";
  static constexpr Text kSource = "two's complement";
  enum { kLimit };
  static constexpr Parameter kParameters[] = {{"limit", kChannelUnit, 1e-9, 1e15, 1e15, 1.2e6}};

  static void change(const auto* p, auto& x) {
    const auto span = 2 * p[kLimit];
    x -= span * std::round(value_of(x) / value_of(span));
  }
};

struct Quantisation : ChangesReadings<Quantisation, kRounds> {
  static constexpr Text kName = "quantisation";
  static constexpr Text kTitle = "quantisation of a sensor";
  static constexpr Text kEquation = "y = q round(x/q)";
  enum { kStep };
  static constexpr Parameter kParameters[] = {{"step", kChannelUnit, 0, 1e12, 0, 5e5}};

  static void change(const auto* p, auto& x) {
    if (p[kStep] > 0) x = p[kStep] * std::round(value_of(x) / value_of(p[kStep]));
  }
};

}  // namespace

// In the order of a signal's path: crosstalk, scaling, timing, range and resolution.
std::span<const TermKind> sensor_kinds() {
  return kinds_of<CrosstalkHorizontal, CrosstalkVertical, AccelerometerTilt, SensorGain,
                  CubicDistortion, AbsoluteValueSensor, Offset, Drift, TimeSkew, ClockDrift,
                  FilterLag, SensorSaturation, Overflow, Quantisation>();
}

}  // namespace rths::sim
