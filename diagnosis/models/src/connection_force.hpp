// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
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

/// Forces at the end of a step. They depend on the motion there, which depends on them. Secant
/// iterations solve each connection; their interaction enters in the next iteration.
template <class Real>
class ConnectionForces {
 public:
  std::vector<Real> force;  ///< at the end of the last step [SI]

  explicit ConnectionForces(std::vector<ConnectionForce<Real>> connections)
      : force(connections.size()),
        connections_{std::move(connections)},
        last_(connections_.size()),
        guess_(connections_.size()),
        slope_(connections_.size(), 0),
        peak_(connections_.size(), 0),
        before_(connections_.size()) {}

  [[nodiscard]] const std::vector<Real>& before() const { return last_; }  ///< one step earlier
  [[nodiscard]] std::size_t size() const { return connections_.size(); }

  /// Sets the forces at a given motion.
  void start(const std::vector<Real>& displacement, const std::vector<Real>& velocity,
             const std::vector<Real>& acceleration, double time) {
    for (std::size_t i = 0; i < size(); ++i) {
      force[i] = connections_[i].trial(displacement[i], velocity[i], acceleration[i], time);
      connections_[i].commit();
    }
    last_ = force;
  }

  /// Solves for the forces at the end of a step.
  /// @param move  computes the motion at the end of the step for given forces there
  /// @param yield  ∂d/∂f of each connection
  template <class Move>
  void solve(const Move& move, const std::vector<double>& yield, std::vector<Real>& displacement,
             std::vector<Real>& velocity, const std::vector<Real>& acceleration, double time) {
    const bool is_explicit =
        std::all_of(yield.begin(), yield.end(), [](double each) { return each == 0; });
    for (std::size_t i = 0; i < size(); ++i) guess_[i] = force[i] + (force[i] - last_[i]);
    last_ = force;
    const int most = is_explicit ? 1 : kMostIterations;
    for (int iteration = 1;; ++iteration) {
      move(guess_.data(), displacement, velocity);
      bool settled = true;
      for (std::size_t i = 0; i < size(); ++i) {
        force[i] = connections_[i].trial(displacement[i], velocity[i], acceleration[i], time);
        settled &= improve(i, yield[i], sim::value_of(displacement[i]), iteration > 1);
      }
      if ((settled && iteration > 1) || iteration == most) break;
    }
    for (auto& connection : connections_) connection.commit();
  }

 private:
  static constexpr int kMostIterations = 6;
  static constexpr double kTolerance = 1e-8;  // of the largest force so far

  struct Trial {
    double displacement = 0, force = 0;
  };

  // Improves the guess by the force at the last one. @returns whether the last one was close enough
  bool improve(std::size_t i, double yield, double displacement, bool has_before) {
    const double value = sim::value_of(force[i]);
    peak_[i] = std::max(peak_[i], std::abs(value));
    const double way = displacement - before_[i].displacement;
    if (has_before && way != 0)
      slope_[i] = std::clamp(yield * (value - before_[i].force) / way, -kSteepest, kFlattest);
    before_[i] = {displacement, value};
    const Real off = force[i] - guess_[i];
    guess_[i] += off * (1 / (1 - slope_[i]));
    return std::abs(sim::value_of(off)) <= kTolerance * peak_[i];
  }
  static constexpr double kSteepest = 1e3, kFlattest = 0.5;

  std::vector<ConnectionForce<Real>> connections_;
  std::vector<Real> last_, guess_;
  std::vector<double> slope_, peak_;
  std::vector<Trial> before_;
};

}  // namespace rths::diagnosis
