// SPDX-License-Identifier: Apache-2.0
#include "delay_line.hpp"
#include "kinds.hpp"
#include "lag.hpp"
#include "sensor_kinds.hpp"

namespace rths::sim {
namespace {

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

struct TimeSkew {
  static constexpr std::string_view kName = "time_skew";
  static constexpr std::string_view kTitle = "time skew of a sensor";
  static constexpr std::string_view kEquation = "y(t) = x(t - tau)";
  static constexpr std::string_view kSource = "textbook; cubic interpolation";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
  enum { kSkew };
  static constexpr Parameter kParameters[] = {{"skew", "s", 0, kLongestSkew, 0, 3e-3}};

  static TermSize size(const TermSetup& setup) { return skew_size(setup, 0); }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    skew(term, q, term.state, term.parameters[kSkew]);
  }
};

struct ClockDrift {
  static constexpr std::string_view kName = "clock_drift";
  static constexpr std::string_view kTitle = "clock drift of a sensor";
  static constexpr std::string_view kEquation =
      "y(t) = x(t - tau - epsilon (t - t_0)),  t_0: the first step,  0 <= age <= 0.2 s";
  static constexpr std::string_view kSource = "textbook; cubic interpolation";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
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

struct FilterLag {
  static constexpr std::string_view kName = "filter_lag";
  static constexpr std::string_view kTitle = "first-order filter of a sensor";
  static constexpr std::string_view kEquation = "T y' + y = x";
  static constexpr std::string_view kSource =
      "textbook, exact for x cubic through the last four samples";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kSensorTraits;
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

constexpr TermKind kSensorTimeKinds[] = {kind_of<TimeSkew>(), kind_of<ClockDrift>(),
                                         kind_of<FilterLag>()};

}  // namespace

std::span<const TermKind> sensor_time_kinds() { return kSensorTimeKinds; }

}  // namespace rths::sim
