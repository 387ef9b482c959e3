// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <rths/core/clock.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::adapters {

/// Which way a value goes, and where it lives on the ring.
enum class Direction {
  Input,      ///< read from a signal of the laboratory's map
  Output,     ///< written to a signal of the laboratory's map
  Monitor,    ///< written to monitor.<node>.<name>: an inner value, to be seen and recorded
  Parameter,  ///< read from tune.<node>.<name>: a setting that may be changed while running
};

/// One value that an adapter exchanges, in SI units.
struct Port {
  std::string name;  ///< full signal name for Input and Output, else a name of the adapter's
  Direction direction = Direction::Input;
  std::string unit = "1";  ///< SI
  double initial = 0;      ///< of a Parameter [unit]
  bool event = false;      ///< of a Monitor: a change is worth a line in the run's events
};

/// What one step has to work with.
struct StepData {
  double time = 0;                 ///< since the run began, as scheduled [s]
  std::span<const double> inputs;  ///< Inputs and Parameters, in the order of `ports`
  std::span<double> outputs;       ///< Outputs and Monitors, in the order of `ports`; hold what was
                                   ///< written last
  bool stopping = false;           ///< the run is over or a peer has vanished: come to rest
  const char* message = "";        ///< out: why, with Fault; must outlive the step
};

/// What may bring an adapter's next step before it is due.
enum class News {
  None,     ///< nothing
  Inputs,   ///< a write to one of its inputs
  Outside,  ///< something that is not on the ring: it waits for that itself
};

/// Whatever takes part in a test: a solver, a controller, a test machine, a recorder.
///
/// It sees arrays of values in SI units and never the ring, so the same adapter runs in a process
/// of its own, beside others in one process, and in virtual time.
class Adapter {
 public:
  virtual ~Adapter() = default;
  /// What it exchanges; always the same list. Inputs are read and outputs are written in this
  /// order, so a flag stands before the inputs that it guards and after the outputs.   @setup
  [[nodiscard]] virtual std::vector<Port> ports() const = 0;
  /// Last chance to allocate, open files and complain. @throws Error   @setup
  virtual void activate() = 0;
  /// One period. Done: nothing is left to do, and everything is at rest.   @realtime
  [[nodiscard]] virtual Status step(StepData& step) RTHS_REALTIME = 0;
  /// What it waits for, beside its next step's being due. In virtual time all steps wait for that
  /// alone.   @realtime
  [[nodiscard]] virtual News awaits() const RTHS_REALTIME { return News::None; }
  /// Waits for news from outside, at most so long.
  virtual void wait_outside(Duration longest) { static_cast<void>(longest); }
  /// Lets go of what `activate` took. Also called after a fault.
  /// @throws Error if what it should leave behind is not whole   @setup
  virtual void deactivate() = 0;
};

}  // namespace rths::adapters
