// SPDX-License-Identifier: Apache-2.0
//
// The parts of a laboratory: transfer system, specimen, the machine's own force, sensors.
#pragma once

#include <array>
#include <vector>

#include <rths/budget/closed_loop.hpp>
#include <rths/loop/transfer_system.hpp>
#include <rths/sim/term.hpp>

namespace rths::budget::platen {

using Eigen::Vector2d;

[[nodiscard]] std::vector<sim::TermSettings> terms_of_stage(const sim::TestMachine& machine,
                                                            sim::Stage stage);

/// Terms with their state.
class RunningTerms {
 public:
  RunningTerms(const std::vector<sim::TermSettings>& terms, double period)
      : composition_{terms, period}, state_(composition_.states()) {}
  void advance(sim::Quantities<double>& q) noexcept { composition_.advance(state_, q); }

 private:
  sim::Composition composition_;
  std::vector<double> state_;
};

/// Motion along long and lat [m, m/s, m/s²].
struct Motion {
  Vector2d displacement = Vector2d::Zero(), velocity = Vector2d::Zero(),
           acceleration = Vector2d::Zero();
};

/// Motion of the platen and the forces on it, at the end of a controller period.
struct Platen : Motion {
  Vector2d specimen_force = Vector2d::Zero();
};

/// The machine's own force, as it moves the platen [N].
class MachineOwnForce {
 public:
  MachineOwnForce(const sim::TestMachine& machine, double period)
      : terms_{terms_of_stage(machine, sim::Stage::Machine), period}, axes_{machine.axes} {}
  Vector2d operator()(const Platen& platen, double time, double axial_load) noexcept;

 private:
  RunningTerms terms_;
  std::array<sim::ServoAxis, 2> axes_;
};

/// Moves the platen as the commands say, after the actuator terms of the simulated machine. Its
/// rates are those of the command: where a command has a kink, or waits for a late node and then
/// jumps, differences of its displacement would be accelerations of hundreds of m/s².
class IdealTransfer {
 public:
  IdealTransfer(const HybridTest& test, const sim::Bearing& specimen)
      : period_{test.period},
        actuator_{terms_of_stage(test.machine_simulated, sim::Stage::Actuator), period_},
        specimen_{specimen, period_} {}

  /// The motion that the command of the controller's next tick asks for.
  Motion asked_by(const loop::Command& command) noexcept;
  /// One tick of the machine. @param motion  asked for by the last command that it has found
  void step(const Motion& motion, double axial_load, Platen& platen) noexcept;

 private:
  double period_, time_ = 0;
  RunningTerms actuator_;
  sim::BearingRun specimen_;
};

/// Moves the platen by the identified hydraulics.
class ServoTransfer {
 public:
  /// @param terms  machine whose terms, masses and offsets it has
  ServoTransfer(const HybridTest& test, const sim::TestMachine& terms,
                const sim::Bearing& specimen);

  /// One tick of the machine. @param reference  the last one that it has found [m]
  void step(const Vector2d& reference, double axial_load, Platen& platen) noexcept;

  Vector2d table_force = Vector2d::Zero();

 private:
  double period_;
  sim::TestMachineRun run_;
};

/// The sensor terms of a machine: what it reads, before noise.
class Sensors {
 public:
  Sensors(const sim::TestMachine& machine, double period)
      : terms_{terms_of_stage(machine, sim::Stage::Sensor), period} {}
  loop::AxisMeasurement operator()(const Platen& platen, const Vector2d& table_force, double time,
                                   double axial_load) noexcept;

 private:
  RunningTerms terms_;
};

/// The value of a tick; 0 beyond the last.
[[nodiscard]] inline double at(const std::vector<double>& values, std::size_t tick) {
  return tick < values.size() ? values[tick] : 0;
}

}  // namespace rths::budget::platen
