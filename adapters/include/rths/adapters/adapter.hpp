// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/clock.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::adapters {

/// The direction of a value, and its location on the ring.
enum class Direction {
  Input,      ///< read from a signal of the laboratory's map
  Output,     ///< written to a signal of the laboratory's map
  Monitor,    ///< written to monitor.<node>.<name>: an internal value to display and record
  Parameter,  ///< read from tune.<node>.<name>: a setting that may change during a run
};

/// One value that an adapter exchanges, in SI units.
struct Port {
  std::string name;  ///< full signal name of an Input or Output; else local to the adapter
  Direction direction = Direction::Input;
  std::string unit = "1";  ///< SI
  double initial = 0;      ///< of a Parameter [unit]
  bool event = false;      ///< of a Monitor: the run's events list each change
  /// Of a Parameter: lowest and highest value [unit]. Another value is not taken.
  std::optional<std::pair<double, double>> range = {};  // NOLINT: g++ needs the initializer
};

/// True if an adapter reads the value of a port, false if it writes it.
[[nodiscard]] inline bool is_read(const Port& port) {
  return port.direction == Direction::Input || port.direction == Direction::Parameter;
}

/// Inputs and outputs of one step.
struct StepData {
  double time = 0;  ///< scheduled time since the start of the run [s]
  double age = 0;   ///< from then until the inputs were read [s]; 0 in virtual time
  /// The step is made after its time, as others were due: those of a late node catch up.
  bool is_missed = false;
  std::span<const double> inputs;  ///< Inputs and Parameters, in the order of `ports`
  std::span<double> outputs;       ///< Outputs and Monitors, in the order of `ports`; keep their
                                   ///< values from step to step
  bool stopping = false;           ///< the run is over or a peer is lost: come to rest
  /// out: the reason of a Fault, which must outlive the step. Without a Fault: why the run has to
  /// stop, while this adapter comes to rest and then returns Fault.
  const char* message = "";
};

/// Events that start an adapter's next step before its scheduled time.
enum class Wake {
  None,      ///< none: steps are scheduled
  Inputs,    ///< a write to one of its inputs
  External,  ///< an event outside the ring, for which the adapter itself waits
};

/// A participant of a test: a solver, a controller, a test machine, a recorder.
///
/// An adapter exchanges arrays of values in SI units and has no access to the ring. The same
/// adapter therefore runs in its own process, with others in one process, or in virtual time.
class Adapter {
 public:
  virtual ~Adapter() = default;
  /// Returns the exchanged values; the list is constant. The runner reads inputs and writes outputs
  /// in this order, so a flag precedes the inputs that it guards and follows the outputs.   @setup
  [[nodiscard]] virtual std::vector<Port> ports() const = 0;
  /// Allocates memory and opens files. @throws Error   @setup
  virtual void activate() {}
  /// Runs one period. Returns Done when the adapter has finished and is at rest.   @realtime
  [[nodiscard]] virtual Status step(StepData& step) RTHS_REALTIME = 0;
  /// Returns the event that starts the next step early. Ignored in virtual time.   @realtime
  [[nodiscard]] virtual Wake wakes_on() const RTHS_REALTIME { return Wake::None; }
  /// Waits for the External event, at most for `longest`.
  virtual void wait_external(Duration longest) { static_cast<void>(longest); }
  /// Releases the resources of `activate`. Also called after a fault.
  /// @throws Error if its output, such as a file, is incomplete   @setup
  virtual void deactivate() {}
};

}  // namespace rths::adapters
