// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"
#include "sensor_kinds.hpp"

namespace rths::sim {
namespace {

struct SensorGain {
  static constexpr std::string_view kName = "gain";
  static constexpr std::string_view kTitle = "gain error of a sensor";
  static constexpr std::string_view kEquation = "y = g x";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
  enum { kFactor };
  static constexpr Parameter kParameters[] = {{"factor", "-", -10, 10, 1, 1.02}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    change_readings(term, q, [&](std::size_t, Real& x) { x *= term.parameters[kFactor]; });
  }
};

struct CubicDistortion {
  static constexpr std::string_view kName = "cubic_distortion";
  static constexpr std::string_view kTitle = "cubic distortion of a sensor";
  static constexpr std::string_view kEquation = "y = x (1 + c (x/x_r)^2)";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
  enum { kShare, kRange };
  static constexpr Parameter kParameters[] = {{"share", "-", -1, 1, 0, 0.02},
                                              {"range", kChannelUnit, 1e-9, 1e12, 1e6, 1e6}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    change_readings(term, q, [&](std::size_t, Real& x) {
      const Real ratio = x / term.parameters[kRange];
      x *= 1 + term.parameters[kShare] * ratio * ratio;
    });
  }
};

struct AbsoluteValueSensor {
  static constexpr std::string_view kName = "absolute_value_sensor";
  static constexpr std::string_view kTitle = "sensor that loses the sign";
  static constexpr std::string_view kEquation = "y = (1 - a) x + a |x|";
  static constexpr std::string_view kSource = "ours; a = 1: the sign is lost completely";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
  enum { kShare };
  static constexpr Parameter kParameters[] = {{"share", "-", 0, 1, 0, 1}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    using std::abs;
    change_readings(term, q,
                    [&](std::size_t, Real& x) { x += term.parameters[kShare] * (abs(x) - x); });
  }
};

struct Offset {
  static constexpr std::string_view kName = "offset";
  static constexpr std::string_view kTitle = "offset of a sensor";
  static constexpr std::string_view kEquation = "y = x + d_0";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits | kConstant;
  enum { kOffset };
  static constexpr Parameter kParameters[] = {{"offset", kChannelUnit, -1e9, 1e9, 0, 2e4}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    change_readings(term, q, [&](std::size_t, Real& x) { x += term.parameters[kOffset]; });
  }
};

struct Drift {
  static constexpr std::string_view kName = "drift";
  static constexpr std::string_view kTitle = "drift of a sensor";
  static constexpr std::string_view kEquation = "y = x + d_1 (t - t_0),  t_0: the first step";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
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

constexpr TermKind kSensorScaleKinds[] = {kind_of<SensorGain>(), kind_of<CubicDistortion>(),
                                          kind_of<AbsoluteValueSensor>(), kind_of<Offset>(),
                                          kind_of<Drift>()};

}  // namespace

std::span<const TermKind> sensor_scale_kinds() { return kSensorScaleKinds; }

}  // namespace rths::sim
