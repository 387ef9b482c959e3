// SPDX-License-Identifier: Apache-2.0
#include "dynamic_run.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "connection_force.hpp"

namespace rths::diagnosis {
namespace {

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

using sim::value_of;

// Five-point differences as of measured motions, in signal.cpp; three points and fewer at the ends.
template <class Real>
std::vector<Real> rate_of_samples(const std::vector<Real>& x, double time_step) {
  const std::size_t n = x.size();
  std::vector<Real> rate(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i >= 2 && i + 2 < n) {
      rate[i] = ((x[i + 1] - x[i - 1]) * 8 - (x[i + 2] - x[i - 2])) * (1 / (12 * time_step));
      continue;
    }
    const std::size_t from = i > 0 ? i - 1 : 0, to = std::min(i + 1, n - 1);
    if (to > from) rate[i] = (x[to] - x[from]) * (1 / (static_cast<double>(to - from) * time_step));
  }
  return rate;
}

template <class Real>
std::vector<Real> second_rate_of_samples(const std::vector<Real>& x, double time_step) {
  const std::size_t n = x.size();
  const double square = time_step * time_step;
  std::vector<Real> rate(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const Real near = x[i + 1] + x[i - 1];
    rate[i] = i >= 2 && i + 2 < n
                  ? (near * 16 - x[i] * 30 - x[i + 2] - x[i - 2]) * (1 / (12 * square))
                  : (near - x[i] * 2) * (1 / square);
  }
  return rate;
}

template <class Real>
void pass_if(const std::optional<ComponentTerms>& chain, const std::vector<Real>& values,
             double start, std::vector<Real>& signal) {
  if (chain) pass(*chain, values, start, signal);
}

// An input of the linear system: values at samples and, if it is bent between them, the ends of a
// line in each substep.
template <class Real>
struct PlantSignal {
  std::vector<Real> at_samples, lines;
};

constexpr std::size_t kPieces = 4;  // of a substep of a bent input

// Values of a signal at the ends of the pieces of all substeps.
template <class Real>
std::vector<Real> refined(const DynamicSetup& setup, const std::vector<double>& signal) {
  std::vector<Real> fine;
  const Index last = static_cast<Index>(signal.size()) - 1;
  for (Index sample = 0; sample < last; ++sample)
    for (std::size_t i = 0; i < static_cast<std::size_t>(setup.substeps); ++i) {
      const double a = between(signal, sample, setup.between.before, setup.between.start[i]);
      const double b = between(signal, sample, setup.between.before, setup.between.end[i]);
      for (std::size_t piece = 0; piece < kPieces; ++piece)
        fine.emplace_back(a + (b - a) * static_cast<double>(piece) / kPieces);
    }
  fine.emplace_back(signal.back());
  return fine;
}

// The line in each substep that has the mean and the first moment of the signal there.
template <class Real>
std::vector<Real> lines_through(const std::vector<Real>& fine) {
  constexpr double kPiece = 1.0 / kPieces;
  std::vector<Real> ends;
  for (std::size_t first = 0; first + kPieces < fine.size(); first += kPieces) {
    Real mean{}, moment{};
    for (std::size_t i = 0; i < kPieces; ++i) {
      const Real &a = fine[first + i], &b = fine[first + i + 1];
      const double middle = (static_cast<double>(i) + 0.5) * kPiece - 0.5;
      mean += (a + b) * (0.5 * kPiece);
      moment += (a + b) * (0.5 * kPiece * middle) + (b - a) * (kPiece * kPiece / 12);
    }
    ends.push_back(mean - moment * 6);
    ends.push_back(mean + moment * 6);
  }
  return ends;
}

template <class Real>
std::vector<PlantSignal<Real>> plant_inputs(const DynamicSetup& setup,
                                            const DynamicSignals& signals,
                                            const std::vector<Real>& values) {
  std::vector<PlantSignal<Real>> channels(signals.inputs.size());
  for (std::size_t i = 0; i < signals.inputs.size(); ++i) {
    auto& [at_samples, lines] = channels[i];
    at_samples.assign(signals.inputs[i].begin(), signals.inputs[i].end());
    pass_if(setup.inputs[i], values, signals.start, at_samples);
    if (!setup.is_bent[i]) continue;
    auto fine = refined<Real>(setup, signals.inputs[i]);
    pass_if(setup.inputs[i], values, signals.start, fine);
    lines = lines_through(fine);
  }
  std::vector<PlantSignal<Real>> result;
  for (const auto& [channel, order] : setup.plant_inputs) {
    result.push_back(channels[channel]);
    if (order > 0) result.back().lines.clear();
    auto& samples = result.back().at_samples;
    if (order == 1) samples = rate_of_samples(samples, setup.time_step);
    if (order == 2) samples = second_rate_of_samples(samples, setup.time_step);
  }
  return result;
}

template <class Real, class Entry>
class FreeRun {
 public:
  FreeRun(const DynamicSetup& setup, const DynamicSignals& signals,
          const StepMatrices<Entry>& steps, const std::vector<Real>& values)
      : setup_{setup},
        steps_{steps},
        inputs_{plant_inputs(setup, signals, values)},
        forces_{forces_of(setup, steps, values)},
        state_(size(steps.phi.rows)),
        next_(state_.size()),
        u0_(inputs_.size()),
        u1_(inputs_.size()),
        free_displacement_(forces_.size()),
        free_velocity_(forces_.size()),
        displacement_(forces_.size()),
        velocity_(forces_.size()),
        acceleration_(forces_.size()) {
    for (std::size_t i = 0; i < state_.size() && signals.start_state.size() > 0; ++i)
      state_[i] = signals.start_state[static_cast<Index>(i)];
    for (std::size_t i = 0; i < forces_.size(); ++i)
      yield_.push_back(value_of(steps.yield(index(i), index(i))));
    for (std::size_t i = 0; i < inputs_.size(); ++i) u1_[i] = inputs_[i].at_samples.front();
    set_motion(state_, u1_);
    forces_.start(free_displacement_, free_velocity_, acceleration_, signals.start);
    displacement_ = free_displacement_;
    velocity_ = free_velocity_;
  }

  void outputs_at(Index sample, std::vector<std::vector<Real>>& outputs) {
    y_.assign(outputs.size(), Real{});
    for (std::size_t i = 0; i < inputs_.size(); ++i) u0_[i] = inputs_[i].at_samples[size(sample)];
    add_product(steps_.c, state_.data(), y_.data());
    add_product(steps_.d, u0_.data(), y_.data());
    add_product(steps_.h, forces_.force.data(), y_.data());
    for (std::size_t i = 0; i < outputs.size(); ++i) outputs[i][size(sample)] = y_[i];
  }

  // Advances from one sample to the next.
  void advance(Index sample, double time) {
    for (int substep = 0; substep < setup_.substeps; ++substep) {
      for (std::size_t i = 0; i < inputs_.size(); ++i) set_ends(i, sample, size(substep));
      step(time + setup_.time_step * (substep + 1) / setup_.substeps);
    }
  }

  [[nodiscard]] const std::vector<Real>& displacement() const { return displacement_; }
  [[nodiscard]] const std::vector<Real>& velocity() const { return velocity_; }
  [[nodiscard]] const std::vector<Real>& acceleration() const { return acceleration_; }

 private:
  static std::size_t size(Index i) { return static_cast<std::size_t>(i); }
  static Index index(std::size_t i) { return static_cast<Index>(i); }

  static ConnectionForces<Real> forces_of(const DynamicSetup& setup,
                                          const StepMatrices<Entry>& steps,
                                          const std::vector<Real>& values) {
    std::vector<ConnectionForce<Real>> forces;
    for (std::size_t i = 0; i < setup.connections.size(); ++i)
      forces.emplace_back(setup.connections[i], values, Real{steps.stiffness(index(i), 0)},
                          Real{steps.damping(index(i), 0)});
    return ConnectionForces<Real>{std::move(forces)};
  }

  // Takes an input at the ends of a substep.
  void set_ends(std::size_t input, Index sample, std::size_t substep) {
    const auto& [at_samples, lines] = inputs_[input];
    if (!lines.empty()) {
      const std::size_t at = 2 * (size(sample) * size(setup_.substeps) + substep);
      u0_[input] = lines[at];
      u1_[input] = lines[at + 1];
      return;
    }
    u0_[input] = between(at_samples, sample, setup_.between.before, setup_.between.start[substep]);
    u1_[input] = between(at_samples, sample, setup_.between.before, setup_.between.end[substep]);
  }

  // Computes the motion of the connections without the forces at the end of this step.
  void set_motion(const std::vector<Real>& state, const std::vector<Real>& u) {
    std::fill(free_displacement_.begin(), free_displacement_.end(), Real{});
    std::fill(free_velocity_.begin(), free_velocity_.end(), Real{});
    add_product(steps_.p, state.data(), free_displacement_.data());
    add_product(steps_.q, u.data(), free_displacement_.data());
    add_product(steps_.r, state.data(), free_velocity_.data());
    add_product(steps_.s, u.data(), free_velocity_.data());
    std::fill(acceleration_.begin(), acceleration_.end(), Real{});
    add_product(steps_.t, u.data(), acceleration_.data());
  }

  void step(double time) {
    std::fill(next_.begin(), next_.end(), Real{});
    add_product(steps_.phi, state_.data(), next_.data());
    add_product(steps_.b0, u0_.data(), next_.data());
    add_product(steps_.b1, u1_.data(), next_.data());
    if (forces_.size() > 0) {
      add_product(steps_.e_before, forces_.before().data(), next_.data());
      add_product(steps_.e0, forces_.force.data(), next_.data());
      set_motion(next_, u1_);
      const auto move = [&](const Real* force, std::vector<Real>& d, std::vector<Real>& v) {
        d = free_displacement_;
        v = free_velocity_;
        add_product(steps_.yield, force, d.data());
        add_product(steps_.yield_rate, force, v.data());
      };
      forces_.solve(move, yield_, displacement_, velocity_, acceleration_, time);
      add_product(steps_.e1, forces_.force.data(), next_.data());
    }
    state_.swap(next_);
  }

  const DynamicSetup& setup_;
  const StepMatrices<Entry>& steps_;
  std::vector<PlantSignal<Real>> inputs_;
  ConnectionForces<Real> forces_;
  std::vector<Real> state_, next_, u0_, u1_, y_;
  std::vector<Real> free_displacement_, free_velocity_, displacement_, velocity_, acceleration_;
  std::vector<double> yield_;
};

template <class Real, class Entry>
std::vector<std::vector<Real>> plant_outputs(const DynamicSetup& setup,
                                             const DynamicSignals& signals,
                                             const StepMatrices<Entry>& steps,
                                             const std::vector<Real>& values,
                                             std::vector<std::vector<double>>* motion) {
  const std::size_t samples = signals.inputs.empty() ? 0 : signals.inputs[0].size();
  std::vector<std::vector<Real>> outputs(setup.outputs.size(), std::vector<Real>(samples));
  if (samples == 0) return outputs;
  const std::size_t connections = setup.connections.size();
  if (motion != nullptr) motion->assign(3 * connections, std::vector<double>(samples));
  FreeRun<Real, Entry> run{setup, signals, steps, values};
  for (std::size_t i = 0; i < samples; ++i) {
    const auto sample = static_cast<Index>(i);
    if (i > 0)
      run.advance(sample - 1, signals.start + static_cast<double>(i - 1) * setup.time_step);
    run.outputs_at(sample, outputs);
    for (const auto& output : outputs)
      if (!(std::abs(value_of(output[i])) <= signals.limit)) return {};
    for (std::size_t c = 0; motion != nullptr && c < connections; ++c) {
      (*motion)[c][i] = value_of(run.displacement()[c]);
      (*motion)[connections + c][i] = value_of(run.velocity()[c]);
      (*motion)[2 * connections + c][i] = value_of(run.acceleration()[c]);
    }
  }
  return outputs;
}

template <class Real>
void pass_outputs(const DynamicSetup& setup, const DynamicSignals& signals,
                  const std::vector<Real>& values, std::vector<std::vector<Real>>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i)
    pass_if(setup.outputs[i], values, signals.start, outputs[i]);
}

}  // namespace

template <class Real, class Entry>
std::vector<std::vector<Real>> run_freely(const DynamicSetup& setup, const DynamicSignals& signals,
                                          const StepMatrices<Entry>& steps,
                                          const std::vector<Real>& values,
                                          std::vector<std::vector<double>>* motion) {
  auto outputs = plant_outputs(setup, signals, steps, values, motion);
  pass_outputs(setup, signals, values, outputs);
  return outputs;
}

std::vector<std::vector<sim::Dual>> through_outputs(const DynamicSetup& setup,
                                                    const DynamicSignals& signals,
                                                    const StepMatrices<double>& steps,
                                                    const std::vector<sim::Dual>& values) {
  std::vector<double> plain;
  for (const auto& value : values) plain.push_back(value.value);
  std::vector<std::vector<sim::Dual>> outputs;
  for (const auto& output : plant_outputs(setup, signals, steps, plain, nullptr))
    outputs.emplace_back(output.begin(), output.end());
  pass_outputs(setup, signals, values, outputs);
  return outputs;
}

template std::vector<std::vector<double>> run_freely<double, double>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<double>&,
    const std::vector<double>&, std::vector<std::vector<double>>*);
template std::vector<std::vector<sim::Dual>> run_freely<sim::Dual, double>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<double>&,
    const std::vector<sim::Dual>&, std::vector<std::vector<double>>*);
template std::vector<std::vector<sim::Dual>> run_freely<sim::Dual, sim::Dual>(
    const DynamicSetup&, const DynamicSignals&, const StepMatrices<sim::Dual>&,
    const std::vector<sim::Dual>&, std::vector<std::vector<double>>*);

}  // namespace rths::diagnosis
