// SPDX-License-Identifier: Apache-2.0
#include <rths/core/constants.hpp>

#include "kinds.hpp"
#include "sensor_kinds.hpp"

namespace rths::sim {
namespace {

struct CrosstalkHorizontal {
  static constexpr std::string_view kName = "crosstalk_horizontal";
  static constexpr std::string_view kTitle = "crosstalk between the horizontal axes";
  static constexpr std::string_view kEquation =
      "y_long = x_long + c_1 x_lat,  y_lat = x_lat + c_2 x_long";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kPerChannel;
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

struct CrosstalkVertical {
  static constexpr std::string_view kName = "crosstalk_vertical";
  static constexpr std::string_view kTitle = "vertical crosstalk into the horizontal load cells";
  static constexpr std::string_view kEquation = "y = F + c (N - N_0)";
  static constexpr std::string_view kSource = "textbook";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kPerAxis;
  enum { kShare, kReference };
  static constexpr Parameter kParameters[] = {{"share", "-", -1, 1, 0, 5e-3},
                                              {"reference_load", "N", -1e9, 1e9, 0, 9.7e6}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real seen = term.parameters[kShare] * (q.axial_load - term.parameters[kReference]);
    for_each_active_axis(term, [&](std::size_t axis) { q.force[axis] += seen; });
  }
};

struct AccelerometerTilt {
  static constexpr std::string_view kName = "accelerometer_tilt";
  static constexpr std::string_view kTitle = "tilted accelerometer";
  static constexpr std::string_view kEquation = "y = a + g (theta_0 + theta_u u),  g = 9.80665";
  static constexpr std::string_view kSource = "textbook, sin(theta) = theta";
  static constexpr Stage kStage = Stage::Sensor;
  static constexpr unsigned kTraits = kPerAxis;
  enum { kTilt, kPerDisplacement };
  static constexpr Parameter kParameters[] = {
      {"tilt", "rad", -0.5, 0.5, 0, 0.02}, {"tilt_per_displacement", "rad/m", -1e5, 1e5, 0, 0.1}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      q.acceleration[axis] +=
          kStandardGravity *
          (term.parameters[kTilt] + term.parameters[kPerDisplacement] * q.displacement[axis]);
    });
  }
};

constexpr TermKind kSensorCrossKinds[] = {
    kind_of<CrosstalkHorizontal>(), kind_of<CrosstalkVertical>(), kind_of<AccelerometerTilt>()};

}  // namespace

std::span<const TermKind> sensor_cross_kinds() { return kSensorCrossKinds; }

}  // namespace rths::sim
