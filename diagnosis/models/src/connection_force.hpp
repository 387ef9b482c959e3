// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "dynamic_run.hpp"

namespace rths::diagnosis {

/// Force of one connection's terms. A trial step can be repeated before it is committed.
template <class Real>
class ConnectionForce {
 public:
  ConnectionForce(const ConnectionWithTerms& connection, const std::vector<Real>& values,
                  const Real& stiffness, const Real& damping)
      : connection_{&connection},
        parameters_{connection.terms.parameters(values)},
        state_(connection.terms.composition().states()),
        trial_state_(state_.size()) {
    const UnitScales& scales = connection.terms.scales();
    into_length_ = 1 / scales.length;
    into_velocity_ = scales.time / scales.length;
    into_acceleration_ = into_velocity_ * scales.time;
    force_ = scales.force;
    if (!connection.holds_linear) return;
    stiffness_ = stiffness;
    damping_ = damping;
    const auto& composition = connection.terms.composition();
    const auto set = [&](std::string_view term, const char* name, const Real& value) {
      parameters_[composition.parameter_index(std::string{term}, name)] = value;
    };
    set(kLinearSpring, "linear", stiffness * (1 / scales.of("N/m")));
    set(kLinearDamper, "damping", damping * (1 / scales.of("N*s/m")));
  }

  /// Force of a trial step from the committed state [SI], without the linear spring and damper,
  /// which belong to the linear system.
  Real trial(const Real& displacement, const Real& velocity, const Real& acceleration,
             double time) {
    std::copy(state_.begin(), state_.end(), trial_state_.begin());
    quantities_ = {};
    quantities_.time = time / connection_->terms.scales().time;
    quantities_.displacement[0] = displacement * into_length_;
    quantities_.velocity[0] = velocity * into_velocity_;
    quantities_.acceleration[0] = acceleration * into_acceleration_;
    connection_->terms.composition().advance(parameters_, trial_state_, quantities_);
    Real force = quantities_.force[0] * force_;
    if (connection_->holds_linear) force -= stiffness_ * displacement + damping_ * velocity;
    return force;
  }
  void commit() { state_.swap(trial_state_); }

 private:
  const ConnectionWithTerms* connection_;
  std::vector<Real> parameters_, state_, trial_state_;
  double into_length_, into_velocity_, into_acceleration_, force_;
  Real stiffness_{}, damping_{};
  sim::Quantities<Real> quantities_;
};

}  // namespace rths::diagnosis
