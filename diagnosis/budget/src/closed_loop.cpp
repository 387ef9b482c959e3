// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/closed_loop.hpp>

#include <algorithm>
#include <cmath>

#include <rths/controller/target_exchange.hpp>
#include <rths/sim/plant_analysis.hpp>
#include <rths/sim/term.hpp>

namespace rths::budget {
namespace {

using Eigen::Vector2d;

constexpr double kRounding = 1e-9;  // of a count of steps times their length [s]

std::vector<sim::TermSettings> terms_of_stage(const sim::TestMachine& machine, sim::Stage stage) {
  std::vector<sim::TermSettings> found;
  for (const auto& term : machine.terms)
    if (sim::term_kind(term.kind).stage == stage) found.push_back(term);
  return found;
}

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

/// Motion of the platen and the forces on it, at the end of a controller period.
struct Platen {
  Vector2d displacement = Vector2d::Zero(), velocity = Vector2d::Zero(),
           acceleration = Vector2d::Zero();
  Vector2d specimen_force = Vector2d::Zero();
};

/// The machine's own force, as it moves the platen [N].
class MachineOwnForce {
 public:
  MachineOwnForce(const sim::TestMachine& machine, double period)
      : terms_{terms_of_stage(machine, sim::Stage::Machine), period}, axes_{machine.axes} {
    // platen_inertia reads the acceleration of its quantities; as a term of a machine it adds mass.
  }
  Vector2d operator()(const Platen& platen, double time, double axial_load) noexcept {
    sim::Quantities<double> q;
    q.time = time;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      q.displacement[i] = platen.displacement[axis];
      q.velocity[i] = platen.velocity[axis];
      q.acceleration[i] = platen.acceleration[axis];
    }
    q.axial_load = axial_load;
    terms_.advance(q);
    return {q.force[0] + axes_[0].effective_mass * platen.acceleration[0] + axes_[0].force_offset,
            q.force[1] + axes_[1].effective_mass * platen.acceleration[1] + axes_[1].force_offset};
  }

 private:
  RunningTerms terms_;
  std::array<sim::ServoAxis, 2> axes_;
};

/// Moves the platen as the reference says. Its rates are differences.
class IdealTransfer {
 public:
  IdealTransfer(const HybridTest& test, const sim::Bearing& specimen)
      : period_{test.period},
        actuator_{terms_of_stage(test.machine_simulated, sim::Stage::Actuator), period_},
        specimen_{specimen, period_} {}

  void step(const Vector2d& reference, double axial_load, Platen& platen) noexcept {
    sim::Quantities<double> q;
    q.time = time_;
    q.displacement = {reference[0], reference[1]};
    actuator_.advance(q);
    time_ += period_;
    const Vector2d displacement{q.displacement[0], q.displacement[1]};
    const Vector2d velocity = (displacement - platen.displacement) / period_;
    platen.acceleration = (velocity - platen.velocity) / period_;
    platen.velocity = velocity;
    platen.displacement = displacement;
    platen.specimen_force = specimen_.advance(displacement, velocity, axial_load);
  }

 private:
  double period_, time_ = 0;
  RunningTerms actuator_;
  sim::BearingRun specimen_;
};

sim::TestMachine quiet(sim::TestMachine machine, const sim::TestMachine& terms,
                       const sim::Bearing& specimen) {
  machine.terms = terms.terms;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    machine.axes[i].effective_mass = terms.axes[i].effective_mass;
    machine.axes[i].force_offset = terms.axes[i].force_offset;
  }
  // The identified hydraulics contain the actuator; sensors are exact.
  std::erase_if(machine.terms, [](const auto& term) {
    const sim::Stage stage = sim::term_kind(term.kind).stage;
    return stage == sim::Stage::Actuator || stage == sim::Stage::Sensor;
  });
  machine.noise = {0, 0, 0};
  machine.specimen = specimen;
  machine.has_specimen = true;
  return machine;
}

/// Moves the platen by the identified hydraulics.
class ServoTransfer {
 public:
  ServoTransfer(const HybridTest& test, const sim::TestMachine& terms, const sim::Bearing& specimen)
      : period_{test.period}, run_{quiet(test.machine_identified, terms, specimen), period_} {}

  void step(const Vector2d& reference, double axial_load, Platen& platen) noexcept {
    sim::MachineFeedback feedback;
    static_cast<void>(run_.step(reference, axial_load, feedback));
    platen.velocity = (feedback.displacement - platen.displacement) / period_;
    platen.displacement = feedback.displacement;
    platen.acceleration = feedback.acceleration;
    platen.specimen_force = run_.specimen_force();
    table_force = feedback.force;
  }

  Vector2d table_force = Vector2d::Zero();

 private:
  double period_;
  sim::TestMachineRun run_;
};

/// From the reference to the force that the controller feeds back.
class Laboratory {
 public:
  Laboratory(const HybridTest& test, Parts identified, std::size_t first_period)
      : test_{test},
        specimen_{has(identified, Part::Specimen) ? test.specimen_identified
                                                  : test.specimen_simulated},
        machine_{has(identified, Part::Machine) ? test.machine_identified : test.machine_simulated},
        ideal_{test, specimen_},
        force_{machine_, test.period},
        simulated_force_{test.machine_simulated, test.period},
        measures_{has(identified, Part::Force)},
        knows_load_{has(identified, Part::Machine) && !test.axial_load.empty()},
        periods_{first_period} {
    if (has(identified, Part::Tracking)) servo_.emplace(test, machine_, specimen_);
    for (const auto& machine : test.corrected)
      observers_.emplace_back(machine, test.period, test.slope_samples);
  }

  /// One controller period. @param compression  of the analysis [N]   @returns the force fed back
  const Vector2d& step(const Vector2d& reference, double compression) noexcept {
    const double load = knows_load_
                            ? test_.axial_load[std::min(periods_, test_.axial_load.size() - 1)]
                            : compression;
    if (servo_)
      servo_->step(reference, load, platen_);
    else
      ideal_.step(reference, load, platen_);
    ++periods_;
    const double time = static_cast<double>(periods_) * test_.period;
    const Vector2d own = force_(platen_, time, load);
    const Vector2d simulated = simulated_force_(platen_, time, load);
    const Vector2d table = servo_ ? servo_->table_force : Vector2d{platen_.specimen_force + own};
    if (!measures_) {
      fed_back_ = platen_.specimen_force + own - simulated;
      return fed_back_;
    }
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double corrected = observers_[static_cast<std::size_t>(i)].step(
          platen_.displacement[i], platen_.acceleration[i], table[i]);
      fed_back_[i] = (test_.corrects ? corrected : table[i]) + noise(static_cast<std::size_t>(i));
    }
    return fed_back_;
  }

  // Of the period just made.
  [[nodiscard]] double noise(std::size_t axis) const noexcept {
    const auto& noise = test_.force_noise[axis];
    return periods_ <= noise.size() ? noise[periods_ - 1] : 0;
  }
  [[nodiscard]] const Vector2d& fed_back() const { return fed_back_; }
  [[nodiscard]] const Vector2d& displacement() const { return platen_.displacement; }

 private:
  const HybridTest& test_;
  const sim::Bearing& specimen_;
  const sim::TestMachine& machine_;
  std::optional<ServoTransfer> servo_;
  IdealTransfer ideal_;
  MachineOwnForce force_, simulated_force_;
  std::vector<controller::ForceObserver> observers_;
  bool measures_, knows_load_;
  std::size_t periods_;
  Platen platen_;
  Vector2d fed_back_ = Vector2d::Zero();
};

/// The lead that compensates for the transfer system; none if that is ideal.
Vector2d led(const HybridTest& test, bool tracks, std::size_t period, const Vector2d& x,
             const Vector2d& v, const Vector2d& a) {
  Vector2d reference = x;
  for (std::size_t i = 0; tracks && i < 2; ++i) {
    if (test.lead[i].empty()) continue;
    const Lead& lead = test.lead[i][std::min(period, test.lead[i].size() - 1)];
    const auto axis = static_cast<Eigen::Index>(i);
    reference[axis] = lead[0] * x[axis] + lead[1] * v[axis] + lead[2] * a[axis];
  }
  return reference;
}

Vector2d along_tested(const HybridTest& test, Vector2d value) {
  for (std::size_t i = 0; i < 2; ++i)
    if (!test.tested[i]) value[static_cast<Eigen::Index>(i)] = 0;
  return value;
}

sim::PlantAnalysis analysis_of(const HybridTest& test, double step) {
  return sim::PlantAnalysis{test.plant, test.motion, test.implicit_stiffness, step, test.alpha};
}

void append(const Vector2d& target, Response& response) {
  response[0].push_back(target[0]);
  response[1].push_back(target[1]);
}

double compression(const HybridTest& test, const sim::PlantAnalysis& analysis) {
  return test.specimen_simulated.axial_load + analysis.vertical_force();
}

// As simulated: a target per controller period, which is its command.
Response run_with_fine_steps(const HybridTest& test, Parts identified) {
  const double step = test.period / test.rate;  // model time
  sim::PlantAnalysis analysis = analysis_of(test, step);
  Laboratory laboratory{test, identified, test.first_target};
  const bool tracks = has(identified, Part::Tracking);
  Response response;
  Vector2d last_velocity = Vector2d::Zero();
  const auto steps = std::llround(test.duration / step);
  const auto per_sample = std::max(1LL, std::llround(test.integration_step / step));
  for (long long n = 1; n <= steps; ++n) {
    const Vector2d target = along_tested(test, analysis.predict());
    const Vector2d velocity = along_tested(test, analysis.predicted_velocity()) / test.rate;
    const Vector2d reference = led(test, tracks, test.first_target + static_cast<std::size_t>(n),
                                   target, velocity, (velocity - last_velocity) / test.period);
    last_velocity = velocity;
    analysis.correct(along_tested(test, laboratory.step(reference, compression(test, analysis))));
    if (n % per_sample == 0) append(target, response);
  }
  return response;
}

/// The numerical side as it ran: targets once per integration step, after the time of computing.
class SteppedRun {
 public:
  SteppedRun(const HybridTest& test, Parts identified)
      : test_{test},
        tracks_{has(identified, Part::Tracking)},
        analysis_{analysis_of(test, test.integration_step)},
        laboratory_{test, identified, 0},
        settings_{settings_of(test)},
        command_{settings_},
        exchange_{{0, 0}, settings_},
        arrival_{test.first_target} {
    target_.displacement = target_.velocity = target_.acceleration = Eigen::VectorXd::Zero(2);
    begin();
  }

  Response run() {
    const auto steps =
        static_cast<std::size_t>(std::ceil(test_.duration / test_.integration_step - kRounding));
    while (response_[0].size() < steps) step();
    return std::move(response_);
  }

 private:
  static controller::PredictorCorrectorSettings settings_of(const HybridTest& test) {
    auto settings = test.command;
    settings.axes = 2;
    settings.integration_step = test.integration_step;
    settings.simulation_step = test.rate * test.integration_step;
    return settings;
  }

  void begin() {
    target_.displacement = along_tested(test_, analysis_.predict());
    load_ = compression(test_, analysis_);
  }

  // One controller period: the machine moves, the controller commands, the integrator answers.
  void step() {
    laboratory_.step(reference_, load_);
    const bool arrives = period_ == arrival_;
    if (arrives) append(target_.displacement, response_);
    const auto substeps =
        std::max(1L, std::lround(settings_.substeps * test_.period / settings_.simulation_step));
    for (long i = 0; i < substeps; ++i) {
      const bool is_new = exchange_.begin(arrives ? 1 : 0);
      command_.substep(is_new, target_);
      exchange_.end(command_, laboratory_.displacement(), laboratory_.fed_back());
    }
    reference_ = led(test_, tracks_, period_, command_.command(), command_.command_velocity(),
                     command_.command_acceleration());
    if (arrives) is_under_way_ = true;
    if (is_under_way_ && exchange_.at_target()) answer();
    ++period_;
  }

  void answer() {
    is_under_way_ = false;
    analysis_.correct(along_tested(test_, exchange_.held_force()));
    const std::size_t done = response_[0].size() - 1;
    const int computing =
        test_.computing.empty() ? 1 : test_.computing[std::min(done, test_.computing.size() - 1)];
    arrival_ = period_ + static_cast<std::size_t>(std::max(1, computing));
    begin();
  }

  const HybridTest& test_;
  bool tracks_;
  sim::PlantAnalysis analysis_;
  Laboratory laboratory_;
  controller::PredictorCorrectorSettings settings_;
  controller::PredictorCorrector command_;
  controller::TargetExchange exchange_;
  controller::Target target_;
  std::size_t period_ = 0, arrival_;
  bool is_under_way_ = false;
  double load_ = 0;
  Vector2d reference_ = Vector2d::Zero();
  Response response_;
};

}  // namespace

std::vector<double> noise_of(const std::vector<double>& signal, std::size_t reach) {
  std::vector<double> noise(signal.size(), 0.0);
  const auto m = static_cast<double>(reach);
  // Weights of the smoothing parabola at its middle.
  const double divisor = (2 * m - 1) * (2 * m + 1) * (2 * m + 3) / 3;
  for (std::size_t i = reach; i + reach < signal.size(); ++i) {
    double smooth = 0;
    for (std::size_t j = 0; j <= 2 * reach; ++j) {
      const double x = static_cast<double>(j) - m;
      smooth += (3 * m * m + 3 * m - 1 - 5 * x * x) / divisor * signal[i + j - reach];
    }
    noise[i] = signal[i] - smooth;
  }
  return noise;
}

Response closed_loop(const HybridTest& test, Parts identified) {
  if (!has(identified, Part::Numerical)) return run_with_fine_steps(test, identified);
  return SteppedRun{test, identified}.run();
}

Response replayed(const HybridTest& test, const std::array<std::vector<double>, 2>& force) {
  sim::PlantAnalysis analysis = analysis_of(test, test.integration_step);
  Response response;
  const std::size_t steps = std::min(force[0].size(), force[1].size());
  for (std::size_t k = 0; k < steps; ++k) {
    append(along_tested(test, analysis.predict()), response);
    analysis.correct({force[0][k], force[1][k]});
  }
  return response;
}

}  // namespace rths::budget
