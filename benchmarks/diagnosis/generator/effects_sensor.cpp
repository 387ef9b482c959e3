// SPDX-License-Identifier: Apache-2.0
#include "effects.hpp"

namespace trial {
namespace {}  // namespace

std::vector<Effect> force_sensor_effects() {
  const auto load_cell = [](std::string_view name, std::vector<Draw> draws) {
    return Effect{name, "sensor", "force", Relation::Force, std::move(draws)};
  };
  return {
      load_cell("loadcell_drift", {{kDriftX, 8e3, 30e3, kSize, kEitherSign},
                                   {kDriftY, 8e3, 30e3, kSize, kEitherSign}}),
      load_cell("loadcell_gain", {{kGainX, 0.005, 0.03, kSize, kEitherSign},
                                  {kGainY, 0.005, 0.03, kSize, kEitherSign}}),
      load_cell("loadcell_saturation", {{kClipShare, 0.04, 0.14, kSize}}),
      load_cell("crosstalk_horizontal", {{kCrossXY, 0.006, 0.02, kSize, kEitherSign},
                                         {kCrossYX, 0.006, 0.02, kSize, kEitherSign}}),
      load_cell("crosstalk_vertical", {{kVerticalX, 0.002, 0.008, kSize, kEitherSign},
                                       {kVerticalY, 0.002, 0.008, kSize, kEitherSign}}),
      load_cell("force_time_skew", {{kSkew, 1e-3, 5e-3, kSize}}),
      // Terms for a wrong clock rate may have an initial skew; here it is zero.
      load_cell("clock_drift", {{kClock, 60e-6, 200e-6, kSize}, {kSkew, 0, 0, kSize}}),
      load_cell("filter_lag", {{kLag, 1e-3, 4e-3, kSize}}),
      load_cell("absolute_value_sensor", {{kAbsolute, 0.01, 0.05, kSize}}),
      load_cell("quantisation", {{kForceStep, 8e3, 30e3, kSize}}),
  };
}

std::vector<Effect> other_sensor_effects() {
  const auto accelerometer = [](std::string_view name, std::vector<Draw> draws) {
    return Effect{name, "sensor", "acceleration", Relation::Kinematic, std::move(draws)};
  };
  return {
      accelerometer("accelerometer_tilt", {{kTiltX, 0.01, 0.05, kSize, kEitherSign},
                                           {kTiltY, 0.01, 0.05, kSize, kEitherSign}}),
      accelerometer("accelerometer_gain", {{kAccelerationGainX, 0.005, 0.03, kSize, kEitherSign},
                                           {kAccelerationGainY, 0.005, 0.03, kSize, kEitherSign}}),
      accelerometer("accelerometer_drift", {{kAccelerationDriftX, 0.03, 0.15, kSize, kEitherSign},
                                            {kAccelerationDriftY, 0.03, 0.15, kSize, kEitherSign}}),
  };
}

}  // namespace trial
