// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/closed_loop.hpp>

#include <algorithm>
#include <cmath>

#include <rths/controller/target_exchange.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "compensator.hpp"
#include "laboratory.hpp"

namespace rths::budget {
namespace {

using Eigen::Vector2d;

constexpr double kRounding = 1e-9;  // of a count of steps times their length [s]

Vector2d along_tested(const HybridTest& test, Vector2d value) {
  for (std::size_t i = 0; i < 2; ++i)
    if (!test.tested[i]) value[static_cast<Eigen::Index>(i)] = 0;
  return value;
}

// As identified: a target per integration step.
sim::PlantAnalysis analysis_of(const HybridTest& test) {
  return {test.plant,
          test.motion,
          test.implicit_stiffness,
          test.integration_step,
          test.alpha,
          sim::VerticalFeedback::Model,
          test.substeps};
}

void append(const Vector2d& target, Response& response) {
  response[0].push_back(target[0]);
  response[1].push_back(target[1]);
}

double compression(const HybridTest& test, const sim::PlantAnalysis& analysis) {
  return test.specimen_simulated.axial_load + analysis.vertical_force();
}

/// The laboratory, in the order of the ticks of machine and controller.
class DrivenLaboratory {
 public:
  /// @param first_tick  of the controller
  DrivenLaboratory(const HybridTest& test, Parts identified, std::size_t first_tick)
      : order_{has(identified, Part::Host) ? test.order : TickOrder{}},
        first_tick_{first_tick},
        laboratory_{test, identified, first_tick == 0 ? 0 : order_.machine_ticks(first_tick)} {}

  /// Of the controller's next tick.
  void send(const Vector2d& reference, const Command& command) {
    laboratory_.send(reference, command);
  }
  /// Moves the machine until the controller reads its feedback in a tick.
  void move_until(std::size_t controller_tick, double compression) {
    while (laboratory_.ticks() < order_.machine_ticks(controller_tick))
      laboratory_.move(sent_before(laboratory_.ticks()), compression);
  }
  const Vector2d& feed_back(const Vector2d& target, const Command& last) {
    return laboratory_.feed_back(target, last);
  }
  [[nodiscard]] const Vector2d& displacement() const { return laboratory_.displacement(); }
  [[nodiscard]] const Vector2d& specimen_force() const { return laboratory_.specimen_force(); }

 private:
  // References that the controller had sent before a tick of the machine.
  [[nodiscard]] std::size_t sent_before(std::size_t machine_tick) const {
    const std::size_t sent = order_.controller_ticks(machine_tick);
    return sent - std::min(sent, first_tick_);
  }

  TickOrder order_;
  std::size_t first_tick_;
  Laboratory laboratory_;
};

// As simulated: a target per controller period, which is its command.
Response run_with_fine_steps(const HybridTest& test, Parts identified) {
  const double step = test.period / test.rate;  // model time
  sim::PlantAnalysis analysis{test.plant, test.motion, test.implicit_stiffness, step, test.alpha};
  const std::size_t first = test.first_target + 1;  // tick of the controller
  DrivenLaboratory laboratory{test, identified, first};
  Compensator compensator{test, has(identified, Part::Tracking)};
  Response response;
  Command last;
  const auto steps = static_cast<std::size_t>(std::llround(test.duration / step));
  const auto per_sample = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::llround(test.integration_step / step)));
  for (std::size_t n = 1; n <= steps; ++n) {
    const std::size_t tick = first + n - 1;
    const Vector2d target = along_tested(test, analysis.predict());
    const Vector2d velocity = along_tested(test, analysis.predicted_velocity()) / test.rate;
    last = {target, velocity, (velocity - last.velocity) / test.period, {}};
    laboratory.send(compensator(tick, last, laboratory.specimen_force()), last);
    laboratory.move_until(tick + 1, compression(test, analysis));
    analysis.correct(along_tested(test, laboratory.feed_back(target, last)));
    if (n % per_sample == 0) append(target, response);
  }
  return response;
}

/// The numerical side as it ran: targets once per integration step, after the time of computing.
class SteppedRun {
 public:
  SteppedRun(const HybridTest& test, Parts identified)
      : test_{test},
        compensator_{test, has(identified, Part::Tracking)},
        is_late_{has(identified, Part::Host)},
        analysis_{analysis_of(test)},
        laboratory_{test, identified, 0},
        settings_{settings_of(test)},
        command_{settings_},
        exchange_{{test.sampling_delay[0], test.sampling_delay[1]}, settings_},
        arrival_{test.first_target} {
    target_.displacement = target_.velocity = target_.acceleration = Eigen::VectorXd::Zero(2);
    if (is_late_ && !test.arrivals.empty()) arrival_ = test.arrivals[0].last;
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

  // One tick of the controller, after those of the machine: the integrator answers it.
  void step() {
    laboratory_.move_until(tick_, load_);
    const bool waits = is_late_ && test_.order.is_missed(tick_);
    if (waits && tick_ == arrival_) ++arrival_;
    const bool arrives = tick_ == arrival_;
    if (arrives) arrived_ = target_.displacement;
    const Vector2d& force = laboratory_.feed_back(arrived_, sent_);
    if (arrives) append(target_.displacement, response_);
    const auto substeps =
        std::max(1L, std::lround(settings_.substeps * test_.period / settings_.simulation_step));
    for (long i = 0; i < substeps && waits; ++i) command_.wait();
    for (long i = 0; i < substeps && !waits; ++i) {
      const bool is_new = exchange_.begin(arrives ? 1 : 0);
      command_.substep(is_new, target_);
      exchange_.end(command_, laboratory_.displacement(), force);
    }
    const bool is_force_ahead = test_.target_force && test_.target_force->lead_time > 0;
    sent_ = {command_.command(), command_.command_velocity(), command_.command_acceleration(),
             pace_(command_.lost_time(), test_.period, is_force_ahead)};
    laboratory_.send(compensator_(tick_, sent_, laboratory_.specimen_force()), sent_);
    if (arrives) is_under_way_ = true;
    if (is_under_way_ && exchange_.at_target()) answer();
    ++tick_;
  }

  void answer() {
    is_under_way_ = false;
    analysis_.correct(along_tested(test_, exchange_.held_force()));
    const std::size_t next = response_[0].size();
    const int computing =
        test_.computing.empty() ? 1 : test_.computing[std::min(next, test_.computing.size()) - 1];
    arrival_ = tick_ + static_cast<std::size_t>(std::max(1, computing));
    if (is_late_ && next < test_.arrivals.size()) {
      const Arrival& found = test_.arrivals[next];
      arrival_ = std::max(std::clamp(arrival_, found.first, found.last), tick_ + 1);
    }
    begin();
  }

  const HybridTest& test_;
  Compensator compensator_;
  bool is_late_;
  sim::PlantAnalysis analysis_;
  DrivenLaboratory laboratory_;
  controller::PredictorCorrectorSettings settings_;
  controller::PredictorCorrector command_;
  controller::PaceMeter pace_;
  controller::TargetExchange exchange_;
  controller::Target target_;
  std::size_t tick_ = 0, arrival_;
  bool is_under_way_ = false;
  double load_ = 0;
  Vector2d arrived_ = Vector2d::Zero();  ///< the target that the controller knows [m]
  Command sent_;                         ///< of the last tick
  Response response_;
};

}  // namespace

namespace {

// Whether a tick of a node has the outputs of a tick of another.
bool has_seen(const TickTimes& reader, std::size_t tick, const TickTimes& writer,
              std::size_t written) {
  if (!reader.is_missed(tick)) return writer.end[written] <= reader.begin[tick];
  const double dated = writer.is_missed(written) ? writer.due[written] : writer.end[written];
  return dated < reader.due[tick];
}

}  // namespace

TickOrder order_of(const TickTimes& machine, const TickTimes& controller) {
  TickOrder order;
  order.missed = controller.missed;
  bool is_on_time = std::find(order.missed.begin(), order.missed.end(), true) == order.missed.end();
  const std::size_t moves = machine.begin.size(), answers = controller.begin.size();
  for (std::size_t n = 0, m = 0; n < answers; ++n) {
    while (m < moves && has_seen(controller, n, machine, m)) ++m;
    order.machine_before.push_back(m);
    is_on_time = is_on_time && (m == n + 1 || m == moves);
  }
  for (std::size_t m = 0, n = 0; m < moves; ++m) {
    while (n < answers && has_seen(machine, m, controller, n)) ++n;
    order.controller_before.push_back(n);
    is_on_time = is_on_time && (n == m || n == answers);
  }
  return is_on_time ? TickOrder{} : order;
}

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
  stop_if_interrupted();
  if (!has(identified, Part::Numerical)) return run_with_fine_steps(test, identified);
  return SteppedRun{test, identified}.run();
}

Response replayed(const HybridTest& test, const std::array<std::vector<double>, 2>& force) {
  sim::PlantAnalysis analysis = analysis_of(test);
  Response response;
  const std::size_t steps = std::min(force[0].size(), force[1].size());
  for (std::size_t k = 0; k < steps; ++k) {
    append(along_tested(test, analysis.predict()), response);
    analysis.correct({force[0][k], force[1][k]});
  }
  return response;
}

}  // namespace rths::budget
