// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees.hpp>

#include <algorithm>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>

#include "opensees_connection.hpp"
#include "opf_words.hpp"
#include "specimen.hpp"

namespace rths::adapters {
namespace {

/// Compares the integration step of a script with that of the experiment, at its first moves.
class ScriptStep {
 public:
  /// @param expected  of the experiment; 0: any step is accepted [s]
  explicit ScriptStep(double expected) : expected_{expected}, is_checked_{expected == 0} {}

  /// Takes the time of a trial [s].
  void note(double time) {
    if (time == time_) return;
    is_first_ = time_ == 0;
    advance_ = time - time_;
    time_ = time;
  }
  /// Checks the last advance of the time, when a trial of the analysis moves the specimen. The
  /// first step ends at t + α·Δt with an α of at least a half, so only the second one is exact.
  /// @throws Error if the steps differ
  void check() {
    if (is_checked_ || advance_ == 0) return;
    const bool is_far = is_first_ && advance_ > kLongestOrigin * expected_;  // the time began later
    const double least = is_first_ ? kLeastAlpha * expected_ : expected_;
    const double tolerance = kTolerance * expected_;
    if (!is_far && (advance_ < least - tolerance || advance_ > expected_ + tolerance))
      throw Error{
          fmt::format("the script advances its time by {:.6g} s at its first move, "
                      "expected {:g} s (integration_step_s)",
                      advance_, expected_)};
    is_checked_ = !is_first_;
  }

 private:
  static constexpr double kLeastAlpha = 0.5;
  static constexpr double kTolerance = 1e-3;    // of a step
  static constexpr double kLongestOrigin = 20;  // steps
  double expected_, time_ = 0, advance_ = 0;
  bool is_first_ = false, is_checked_;
};

constexpr auto kExitPollPeriod = std::chrono::milliseconds{5};  // whether OpenSees has exited

class OpenSees final : public Adapter {
 public:
  explicit OpenSees(OpenSeesSettings settings)
      : settings_{std::move(settings)},
        words_{control_points(settings_.layout, settings_.trial_points, settings_.output_points),
               settings_.elements},
        new_target_at_{words_.commands().size()},
        handshake_{settings_.wait_deadline, settings_.handshake},
        script_step_{settings_.integration_step} {
    if (settings_.handshake == Handshake::TargetFirst && words_.is_relative_to_measured())
      throw Error{
          "-relCtrl and -relDaq need a measurement before the first target; with handshake = "
          "\"target_first\" no flag marks it as valid"};
    for (const auto& element : settings_.elements)
      specimens_.emplace_back(element, settings_.simulation_step);
    has_left_rest_.assign(specimens_.size(), false);
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    const auto add = [&](const std::string& name, Direction direction, const std::string& unit) {
      ports.push_back({name, direction, unit, 0, false});
    };
    add("daq.atTarget", Direction::Input, "1");
    add("daq.switchPC", Direction::Input, "1");
    const auto feedbacks = words_.feedbacks(), commands = words_.commands();
    ports.insert(ports.end(), feedbacks.begin(), feedbacks.end());
    ports.insert(ports.end(), commands.begin(), commands.end());
    add("opf.newTarget", Direction::Output, "1");
    add("step", Direction::Monitor, "1");
    add("time", Direction::Monitor, "s");
    add("computing_time", Direction::Monitor, "s");
    for (const auto& element : settings_.elements)
      for (const auto& axis : element.axes)
        add(element.name + '.' + axis.axis + ".stiffness", Direction::Monitor,
            element.turns(axis.index) ? "N.m/rad" : "N/m");
    for (std::size_t i = 1; i <= settings_.script.floors.size(); ++i)
      for (const Axis axis : kHorizontal)
        add(fmt::format("floor.{}.accel.{}", i, name_of(axis)), Direction::Monitor, "m/s2");
    return ports;
  }

  void activate() override { opensees_.emplace(settings_); }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    Status status = Status::Fault;
    try {
      status = advance(step);
      write_monitors(step);
    } catch (const std::exception& error) {
      // The script's own failure is the cause of a lost connection, so the message includes it.
      message_ = opensees_->with_exit_reason(error.what());
      step.message = message_.c_str();
    }
    step.outputs[new_target_at_] = handshake_.new_target();
    return status;
  }

  // While the specimen moves, OpenSees waits for its force and sends no messages.
  [[nodiscard]] Wake wakes_on() const noexcept override {
    if (!settings_.is_prompt || settings_.stops_time || handshake_.is_stopping()) return Wake::None;
    return handshake_.is_ready() && has_begun_ ? Wake::External : Wake::Inputs;
  }

  void wait_external(Duration longest) override { opensees_->wait_for_input(longest); }

  void deactivate() override {
    const auto failure =
        opensees_ && opensees_->disconnected() ? opensees_->finish() : std::optional<std::string>{};
    opensees_.reset();
    if (failure) throw Error{*failure};
  }

 private:
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };  // positions among the inputs

  [[nodiscard]] Status advance(StepData& step) {
    if (step.stopping && !handshake_.is_stopping()) handshake_.stop(step.time);
    if (handshake_.is_stopping())
      return handshake_.has_stopped(step.time) ? Status::Done : Status::Ok;
    if (!has_begun_ && step.time < settings_.rest) return rest(step.time);
    const bool was_ready = handshake_.is_ready();
    const Status status =
        handshake_.update(step.inputs[kAtTarget], step.inputs[kSwitchPc], step.time);
    if (status == Status::Fault) throw Error{deadline_message()};
    if (!was_ready && handshake_.is_ready()) arrive(step.time);
    if (handshake_.is_ready() && !has_begun_) begin_test(step);
    if (!is_probing_) exchange(step);
    if (opensees_->disconnected()) return finish(step.time);
    identify_next(step);
    return Status::Ok;
  }

  // The specimen is at its target: OpenSees computes the next one.
  void arrive(double time) {
    opensees_->restart_deadline();
    computing_time_ = settings_.computing_time ? settings_.computing_time() : 0;
    busy_until_ = time + computing_time_;
  }

  // A trial may be withdrawn by the next one, as after a failed step. Only the request for a force
  // tells that none follows, so that a run in virtual time does not depend on when messages arrive.
  [[nodiscard]] bool is_move_due() const {
    return opensees_->all_trials_received() &&
           (!settings_.stops_time || opensees_->has_open_request());
  }

  // Handles the pending messages. In virtual time, waits until OpenSees needs the specimen to move.
  void exchange(const StepData& step) {
    for (;;) {
      opensees_->receive(specimens_);
      if (opensees_->disconnected() || !handshake_.is_ready()) return;
      if (opensees_->connected() && next_unidentified() != specimens_.end()) return;
      if (is_move_due()) {
        if (step.time < busy_until_) return;
        take_trials(step);
      }
      if (!handshake_.is_ready()) return;
      // Only when the specimen is at the position of all trials.
      if (!opensees_->has_pending_trial()) answer_requests(step);
      const Duration time_left = opensees_->time_left();
      if (!settings_.stops_time) return;
      opensees_->wait_for_input(time_left);
    }
  }

  [[nodiscard]] std::span<const double> feedbacks(const StepData& step) const {
    return step.inputs.subspan(kFeedback);
  }

  [[nodiscard]] std::string deadline_message() const {
    std::string message = handshake_.message();
    if (!has_begun_)
      message +=
          ": older controllers raise it only after the first target; set handshake = "
          "\"target_first\" "
          "for them";
    return message;
  }

  void begin_test(const StepData& step) {
    // Older controllers give no valid measurement before the first target.
    if (settings_.handshake != Handshake::TargetFirst) words_.set_start(feedbacks(step));
    words_.write_unused(step.outputs);
    has_begun_ = true;
  }

  void take_trials(const StepData& step) {
    auto& servers = opensees_->servers();
    const bool is_move = std::any_of(servers.begin(), servers.end(),
                                     [](const auto& server) { return server.is_new(); });
    for (std::size_t i = 0; i < servers.size(); ++i) {
      const auto& command = specimens_[i].command_for(servers[i].trial());
      if (is_move && !has_moved_) words_.set_first_trial(i, command);
      if (is_move) check_first_move(i, command);
    }
    check_step(is_move);
    for (std::size_t i = 0; i < servers.size(); ++i) {
      if (is_move) words_.write(i, specimens_[i].command(), servers[i].trial().time, step.outputs);
      servers[i].take_trial();
    }
    if (!is_move) return;
    has_moved_ = true;
    ++moves_;
    time_ = servers.front().trial().time;
    handshake_.post(step.time);
  }

  // Rounding of a static analysis is no move: the specimen is still at rest.
  void check_first_move(std::size_t element, const Specimen::Command& command) {
    constexpr double kAtRest = 1e-3;  // of the largest first move
    const auto& settings = settings_.elements[element];
    if (has_left_rest_[element] ||
        !words_.is_away(element, command, kAtRest * settings.first_trial))
      return;
    try {
      words_.require_near_start(element, command, settings.first_trial);
    } catch (const Error& error) {
      throw Error{fmt::format("element '{}': {}", settings.name, error.what())};
    }
    has_left_rest_[element] = true;
  }

  // A static analysis has no velocities, and steps of its own.
  void check_step(bool is_move) {
    const Trial& trial = opensees_->servers().front().trial();
    script_step_.note(trial.time);
    if (is_move && !trial.velocity.isZero(0)) script_step_.check();
  }

  void answer_requests(const StepData& step) {
    auto& servers = opensees_->servers();
    for (std::size_t i = 0; i < servers.size(); ++i)
      if (servers[i].measurement_requested()) {
        servers[i].answer(specimens_[i].measured(words_.measured(i, feedbacks(step))));
        opensees_->restart_deadline();
      }
  }

  // Identifies the specimens with unknown properties, one after another, when OpenSees has
  // connected.
  void identify(const StepData& step) {
    opensees_->require_running();
    if (!handshake_.is_ready()) return;
    if (is_probing_) {
      const auto probed = next_unidentified();
      const auto element = static_cast<std::size_t>(probed - specimens_.begin());
      probed->measure(words_.measured(element, feedbacks(step)));
      is_probing_ = false;
      opensees_->restart_deadline();
    }
    probe(step);
  }

  // Continues the identification of stiffnesses, if one is left; the test goes on once all are
  // known.
  void identify_next(const StepData& step) {
    if (!has_begun_ || !opensees_->connected() || next_unidentified() == specimens_.end()) return;
    identify(step);
    if (next_unidentified() == specimens_.end()) exchange(step);
  }

  void probe(const StepData& step) {
    const auto next = next_unidentified();
    if (next == specimens_.end()) return;
    const auto element = static_cast<std::size_t>(next - specimens_.begin());
    words_.write(element, next->probe(), 0, step.outputs);
    handshake_.post(step.time);
    is_probing_ = true;
  }

  // The first specimen that is not identified yet.
  [[nodiscard]] std::vector<Specimen>::iterator next_unidentified() {
    return std::find_if(specimens_.begin(), specimens_.end(),
                        [](const auto& specimen) { return !specimen.is_identified(); });
  }

  // OpenSees may still run its final commands, such as closing its recorders.
  [[nodiscard]] Status finish(double time) {
    while (settings_.stops_time && !opensees_->has_finished())
      std::this_thread::sleep_for(kExitPollPeriod);
    if (opensees_->has_finished()) handshake_.stop(time);
    return Status::Ok;
  }

  // Before the test, messages wait for the end of the rest.
  [[nodiscard]] Status rest(double time) {
    opensees_->receive(specimens_);
    handshake_.restart_deadline(time);
    return Status::Ok;
  }

  void write_monitors(const StepData& step) {
    const auto monitors = step.outputs.subspan(new_target_at_ + 1);
    monitors[0] = static_cast<double>(moves_);
    monitors[1] = time_;
    monitors[2] = computing_time_;
    std::size_t at = 3;
    for (const auto& specimen : specimens_)
      for (const double stiffness : specimen.stiffness()) monitors[at++] = stiffness;
    if (const FloorFeed* const floors = opensees_->floors())
      write_floors(*floors, monitors.subspan(at));
  }

  // Absolute accelerations, in SI units.
  void write_floors(const FloorFeed& floors, std::span<double> monitors) const {
    const auto ground = settings_.ground(floors.time());
    for (std::size_t i = 0; i < monitors.size(); ++i) {
      const int dof = settings_.script.floors[i / 2].dofs[i % 2];
      if (dof == 0) continue;
      monitors[i] = settings_.elements.front().length_unit * floors.accelerations()[i] +
                    (floors.is_relative(dof) ? ground[i % 2] : 0);
    }
  }

  OpenSeesSettings settings_;
  OpfWords words_;
  std::size_t new_target_at_;        ///< among the outputs, after the values that it guards
  std::vector<Specimen> specimens_;  ///< of each element
  std::optional<OpenSeesConnection> opensees_;
  OpfHandshake handshake_;
  std::uint64_t moves_ = 0;
  double time_ = 0;            ///< of the last move, in the script [s]
  double computing_time_ = 0;  ///< of the current step [s]
  double busy_until_ = 0;      ///< a trial is taken from then on [s]
  ScriptStep script_step_;
  std::vector<bool> has_left_rest_;  ///< of each element
  bool has_begun_ = false, has_moved_ = false, is_probing_ = false;
  std::string message_;
};

}  // namespace

std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings) {
  return std::make_unique<OpenSees>(settings);
}

}  // namespace rths::adapters
