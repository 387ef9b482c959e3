// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <rths/maths/statistics.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/judgement.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::report {

using maths::largest_magnitude;
using recording::Reader;

/// Reach of the comparison of displacement and acceleration to either side, in model time [s].
inline constexpr double kMotionSpan = 0.1;

/// Ticks [begin, end).
struct TickSpan {
  std::size_t begin = 0, end = 0;
};

/// A recorded signal, one value per tick of the machine; empty if it is not recorded.
struct RecordedSignal {
  std::string name;
  std::vector<double> values;
  [[nodiscard]] bool is_recorded() const { return !values.empty(); }
};

/// The signals of one tested axis, in SI.
struct AxisEvidence {
  std::size_t index = 0;                    ///< 0: long, 1: lat
  sim::AxisLimits limits;                   ///< of the machine
  double effective_mass = 0;                ///< of the platen [kg]
  RecordedSignal command, reference, echo;  ///< of the controller; as the machine received it
  RecordedSignal unlimited, limited;        ///< the reference before and after its limits
  RecordedSignal displacement, acceleration, force;  ///< feedback of the machine
  RecordedSignal target, answer;    ///< of the integrator; the force that it receives
  RecordedSignal specimen_force;    ///< as measured, without the machine's own force
  RecordedSignal sent_force;        ///< the force that the controller returns
  std::vector<double> model_force;  ///< of the model under the measured motion; or empty
  double largest_command = 0, largest_force = 0;  ///< within the limits of the machine
};

/// The recorded signals of a test with a controller and a machine, up to the end of the test.
struct Evidence {
  double interval = 0;         ///< from tick to tick [s]
  double rate = 1;             ///< wall time over model time
  double step = 0;             ///< wall time of an integration step [s]
  std::vector<double> time;    ///< of each tick, since the run began [s]
  std::size_t rest = 0;        ///< ticks before the first target
  std::vector<TickSpan> gaps;  ///< ticks without rows, interpolated
  std::vector<AxisEvidence> axes;
  RecordedSignal load, load_reference;  ///< of the specimen, vertical
};

/// @returns no axes if the recording has no controller or no machine
[[nodiscard]] Evidence gather(const Reader& run, const Config& experiment);

/// Windows of this length in model time that overlap by three quarters, away from gaps.
/// @param length  [s]
[[nodiscard]] std::vector<TickSpan> windows(const Evidence& evidence, double length);

[[nodiscard]] std::span<const double> part(const std::vector<double>& values,
                                           const TickSpan& window);

/// A response as gain × reference + offset, by least squares.
struct Proportion {
  double gain = 0, offset = 0, correlation = 0;
  double difference = 0;               ///< RMS of response minus reference, without their means
  double reference = 0, response = 0;  ///< standard deviations
};
[[nodiscard]] Proportion fit(std::span<const double> reference, std::span<const double> response);

/// The fit with the smallest difference among delays of the response of up to `latest` ticks.
[[nodiscard]] Proportion fit_delayed(const RecordedSignal& reference,
                                     const RecordedSignal& response, const TickSpan& window,
                                     std::size_t latest);

/// The same of a copy, whose delay changes by a tick when a node is a part of a tick late: for each
/// 20 ticks the delay of up to `latest` with the smallest difference.
[[nodiscard]] Proportion fit_copy(const RecordedSignal& reference, const RecordedSignal& response,
                                  const TickSpan& window, std::size_t latest);

}  // namespace rths::report
