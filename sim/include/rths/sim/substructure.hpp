// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <rths/core/axis.hpp>
#include <rths/core/realtime.hpp>

namespace rths::sim {

/// What the target of a degree of freedom is; the specimen answers with the other one.
enum class Controlled { Displacement, Force };

/// A degree of freedom at which a substructure meets the specimen: an axis of the machine, or one
/// of the structure's own.
struct InterfaceDof {
  std::string name;  ///< as in files: "long", or "pier2.yaw"
  AxisKind kind = AxisKind::Translational;
  Controlled controlled = Controlled::Displacement;

  [[nodiscard]] static InterfaceDof of(Axis axis,
                                       Controlled controlled = Controlled::Displacement) {
    return {name_of(axis), kind_of(axis), controlled};
  }
};

/// A quantity of a substructure that is recorded beside its targets.
struct MonitoredQuantity {
  std::string name, unit;  ///< SI
};

/// What is computed in a hybrid test, one time step at a time: the numerical substructure.
///
/// Vectors have a value per degree of freedom of the interface, in its order.
class Substructure {
 public:
  Substructure() = default;
  Substructure(const Substructure&) = default;
  Substructure& operator=(const Substructure&) = default;
  Substructure(Substructure&&) = default;
  Substructure& operator=(Substructure&&) = default;
  virtual ~Substructure() = default;

  /// Degrees of freedom with a controlled displacement come first.   @setup
  [[nodiscard]] virtual std::vector<InterfaceDof> interface() const = 0;
  /// Begins a step.
  /// @param target  overwritten: displacement or force at its end [m, rad, N, N·m]
  /// @param rate    overwritten: of the target [per s]; 0 if it is not known   @realtime
  virtual void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME = 0;
  /// Computes a part of what does not depend on the specimen's force, while the machine moves; does
  /// nothing if all is done. May be left out: `correct` then does the rest.   @realtime
  virtual void work_ahead() RTHS_REALTIME {}
  /// Ends the step.
  /// @param force  of the specimen at the target [N, N·m]   @realtime
  virtual void correct(std::span<const double> force) RTHS_REALTIME = 0;
  [[nodiscard]] virtual double time() const RTHS_REALTIME = 0;  ///< end of the step [s]

  /// What `monitor` writes.   @setup
  [[nodiscard]] virtual std::vector<MonitoredQuantity> monitors() const { return {}; }
  /// The values of the last step that ended.   @realtime
  virtual void monitor(std::span<double> /*values*/) const RTHS_REALTIME {}
};

}  // namespace rths::sim
