// SPDX-License-Identifier: Apache-2.0
#include "fmu_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "forked_runs.hpp"

namespace rths::foreign {
namespace {

constexpr double kSamePlace = 1e-6;  // of a step
constexpr double kMostDivisions = 20;

/// One run, from the first row to the last.
class FmuRun {
 public:
  FmuRun(FmuSetup& setup, const RunInputs& inputs, bool is_restarted, double* results)
      : setup_{setup},
        inputs_{inputs},
        step_{step_of(setup, inputs.time_step)},
        is_restarted_{is_restarted},
        results_{results},
        given_(inputs.inputs.size() + setup.rest.size()),
        now_(setup.settings.outputs.size()),
        before_(now_.size()),
        motion_(setup.motion_count),
        state_(setup.state_count),
        forces_(setup.ports.size()),
        last_displacement_(forces_.size()) {
    std::copy(setup.rest.begin(), setup.rest.end(), given_.begin() + std::ssize(inputs.inputs));
    for (const auto& [name, value] : setup.settings.start) start_values_.push_back(value);
    if (!inputs.law.key.empty()) law_ = inputs.law.begin(step_);
  }

  void run() {
    calls_ = fmi::load_calls(setup_.library, setup_.description.version);
    log_.rename("simulation");
    if (!calls_->instantiate(setup_.description, {"simulation", setup_.folder / "resources", false},
                             log_))
      throw Error{
          fmt::format("fmi{}Instantiate failed: {}", setup_.description.version,
                      *log_.last_error() != '\0' ? log_.last_error() : "without a message")};
    take_inputs(0, 0);
    initialize(0);
    read();
    next_forces(0);
    if (is_restarted_) restart(0, step_ / 2);
    write_rows();
    while (next_row_ < inputs_.rows) make_step();
  }

 private:
  void require(int answer, const char* function) {
    if (answer <= fmi::kWarning) return;
    const char* text = log_.last_error();
    throw Error{fmt::format("fmi{0}{1} returned fmi{0}{2} at {3:g} s{4}{5}",
                            setup_.description.version, function, fmi::name_of_status(answer),
                            time(), *text != '\0' ? ": " : "", text)};
  }
  [[nodiscard]] double time() const { return static_cast<double>(steps_) * step_; }

  void set(fmi::Exchanges& exchanges, const std::vector<double>& values) {
    for (auto& exchange : exchanges) {
      bool fits = true;
      require(calls_->set(exchange, values, fits), "Set");
      if (!fits) throw Error{"a value is outside the range of its type"};
    }
  }
  void get(fmi::Exchanges& exchanges, std::vector<double>& values) {
    for (auto& exchange : exchanges) require(calls_->get(exchange, values.data()), "Get");
  }

  // The inputs as means between two times, or at one.
  void take_inputs(double from, double to) {
    for (std::size_t i = 0; i < inputs_.inputs.size(); ++i) {
      const auto& rows = inputs_.inputs[i];
      const double first = from / inputs_.time_step, last = to / inputs_.time_step;
      const double begin = value_at(rows, first, setup_.settings.holds_inputs);
      given_[i] =
          setup_.settings.holds_inputs ? begin : 0.5 * (begin + value_at(rows, last, false));
    }
  }
  // With the forces of the ports, extrapolated by a share of a step.
  void give_inputs(double ahead) {
    std::vector<double> values = given_;
    for (std::size_t i = 0; i < setup_.ports.size(); ++i)
      if (const auto force = setup_.ports[i].force)
        values[*force] -= forces_[i].now + ahead * (forces_[i].now - forces_[i].before);
    set(setup_.given, values);
  }

  void initialize(double at) {
    set(setup_.start, start_values_);
    set(setup_.parameters, inputs_.parameters);
    if (at > 0 || is_kicked_) set(setup_.states, state_);
    give_inputs(0);
    require(calls_->enter_initialization(at), "EnterInitializationMode");
    require(calls_->exit_initialization(), "ExitInitializationMode");
  }

  void read() {
    std::swap(before_, now_);
    get(setup_.outputs, now_);
    get(setup_.motions, motion_);
    if (is_restarted_) get(setup_.states, state_);
    for (std::size_t i = 0; i < now_.size(); ++i)
      if (!std::isfinite(now_[i]))
        throw Error{fmt::format("'{}' is {} at {:g} s, expected a finite number",
                                setup_.settings.outputs[i], now_[i], time())};
  }

  void next_forces(double span) {
    for (std::size_t i = 0; i < setup_.ports.size() && law_; ++i) {
      const auto& port = setup_.ports[i];
      PortMotion motion{inputs_.start + time(), motion_[port.displacement], 0};
      if (port.velocity)
        motion.velocity = motion_[*port.velocity];
      else if (span > 0)
        motion.velocity = (motion.displacement - last_displacement_[i]) / span;
      // The state has had half of the last force more than this step ends with.
      if (port.state) motion.velocity -= 0.5 * step_ * forces_[i].now;
      last_displacement_[i] = motion.displacement;
      const double force = law_->next(i, motion);
      forces_[i] = {force, span > 0 ? forces_[i].now : force};
      if (port.state && port.output && span > 0) now_[*port.output] -= 0.5 * step_ * force;
    }
  }

  // Starts anew with the states of this time, changed by the forces over a span.
  void restart(double at, double span) {
    for (std::size_t i = 0; i < setup_.ports.size(); ++i)
      if (setup_.ports[i].state) state_[*setup_.ports[i].state] -= span * forces_[i].now;
    is_kicked_ = true;
    require(calls_->reset(), "Reset");
    initialize(at);
  }

  void make_step() {
    const double from = time();
    take_inputs(from, from + step_);
    give_inputs(0.5);
    const fmi::StepEnd end = calls_->step(from, step_);
    if (end.fault != nullptr)
      throw Error{fmt::format("fmi{}DoStep {}", setup_.description.version, end.fault)};
    if (end.terminates) throw Error{fmt::format("asks for its end at {:g} s", from)};
    require(end.answer, "DoStep");
    ++steps_;
    take_inputs(from + step_, from + step_);
    give_inputs(1);
    read();
    next_forces(step_);
    if (is_restarted_) restart(time(), step_);
    write_rows();
  }

  // The rows up to this time.
  void write_rows() {
    for (; next_row_ < inputs_.rows; ++next_row_) {
      const double behind =
          static_cast<double>(steps_) - static_cast<double>(next_row_) * inputs_.time_step / step_;
      if (behind < -kSamePlace) return;
      const double share = behind > kSamePlace ? behind : 0;
      for (std::size_t i = 0; i < now_.size(); ++i)
        results_[i * inputs_.rows + next_row_] = now_[i] + share * (before_[i] - now_[i]);
    }
  }

  struct Force {
    double now = 0, before = 0;
  };

  FmuSetup& setup_;
  const RunInputs& inputs_;
  double step_;
  bool is_restarted_, is_kicked_ = false;
  double* results_;
  std::vector<double> given_, now_, before_, motion_, state_, start_values_;
  std::vector<Force> forces_;
  std::vector<double> last_displacement_;
  std::unique_ptr<PortForces> law_;
  std::unique_ptr<fmi::Calls> calls_;
  fmi::FmuLog log_;
  std::size_t steps_ = 0, next_row_ = 0;
};

}  // namespace

double step_of(const FmuSetup& setup, double interval) {
  if (setup.settings.step > 0) return setup.settings.step;
  const auto fixed = setup.description.fixed_step;
  if (!fixed) return interval;
  const double steps = std::round(interval / *fixed);
  if (steps < 1 || std::abs(steps * *fixed - interval) > kSamePlace * interval) return *fixed;
  for (double divisions = std::min(steps, kMostDivisions); divisions > 1; --divisions)
    if (std::fmod(steps, divisions) == 0) return interval / divisions;
  return interval;
}

void run_fmu(FmuSetup setup, const RunInputs& inputs, bool is_restarted, double* results) {
  FmuRun{setup, inputs, is_restarted, results}.run();
}

}  // namespace rths::foreign
