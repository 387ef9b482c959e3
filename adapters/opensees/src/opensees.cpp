// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees.hpp>

#include <algorithm>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/error.hpp>

#include "conversation.hpp"
#include "opf_words.hpp"
#include "specimen.hpp"

namespace rths::adapters {
namespace {

constexpr auto kLookEvery = std::chrono::milliseconds{5};  // whether OpenSees has done its rest

class OpenSees final : public Adapter {
 public:
  explicit OpenSees(OpenSeesSettings settings);
  [[nodiscard]] std::vector<Port> ports() const override;
  void activate() override;
  [[nodiscard]] Status step(StepData& step) noexcept override;
  [[nodiscard]] News awaits() const noexcept override;
  void wait_outside(Duration longest) override { opensees_->wait_for_news(longest); }
  void deactivate() override;

 private:
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };  // positions among the inputs

  [[nodiscard]] Status advance(StepData& step);
  // Hears what there is. Where time stands still, waits until OpenSees has done its part.
  void converse(const StepData& step);
  [[nodiscard]] std::span<const double> feedbacks(const StepData& step) const {
    return step.inputs.subspan(kFeedback);
  }
  [[nodiscard]] std::string overdue() const;
  void begin_test(const StepData& step);
  void begin_round(const StepData& step);
  void answer_all(const StepData& step);
  // Shakes those specimens that are not known yet, one after the other, once OpenSees is there.
  void identify(const StepData& step);
  void probe(const StepData& step);
  // Specimens that are not known yet come first.
  [[nodiscard]] auto unknown() {
    return std::find_if(specimens_.begin(), specimens_.end(),
                        [](const auto& specimen) { return !specimen.is_known(); });
  }
  [[nodiscard]] Status leave(double time);
  void write_monitors(const StepData& step) const;
  OpenSeesSettings settings_;
  OpfWords words_;
  std::size_t new_target_at_;        ///< among the outputs: behind what it guards
  std::vector<Specimen> specimens_;  ///< of each element
  std::optional<Conversation> opensees_;
  OpfHandshake handshake_;
  std::uint64_t rounds_ = 0;
  bool has_begun_ = false, has_moved_ = false, is_probing_ = false;
  std::string message_;
};

OpenSees::OpenSees(OpenSeesSettings settings)
    : settings_{std::move(settings)},
      words_{control_points(settings_.layout, settings_.trial_points, settings_.output_points),
             settings_.elements},
      new_target_at_{words_.commands().size()},
      handshake_{settings_.wait_deadline, settings_.handshake} {
  if (settings_.handshake == Handshake::TargetFirst && words_.is_relative_to_measured())
    throw Error{
        "-relCtrl and -relDaq need what is measured before the first target; with handshake = "
        "\"target_first\" nobody says when that is valid"};
  for (const auto& element : settings_.elements)
    specimens_.emplace_back(element, settings_.simulation_step);
}

std::vector<Port> OpenSees::ports() const {
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
  for (const auto& element : settings_.elements)
    for (const auto& axis : element.axes)
      add(element.name + '.' + axis.axis + ".stiffness", Direction::Monitor,
          element.turns(axis.of) ? "N.m/rad" : "N/m");
  return ports;
}

void OpenSees::activate() { opensees_.emplace(settings_); }

void OpenSees::deactivate() {
  const auto trouble =
      opensees_ && opensees_->has_left() ? opensees_->finish() : std::optional<std::string>{};
  opensees_.reset();
  if (trouble) throw Error{*trouble};
}

// Once an element waits for its force, OpenSees says no more before the specimen has arrived.
News OpenSees::awaits() const noexcept {
  if (!settings_.is_prompt || settings_.stops_time || handshake_.is_leaving()) return News::None;
  return handshake_.is_there() && has_begun_ ? News::Outside : News::Inputs;
}

void OpenSees::answer_all(const StepData& step) {
  auto& servers = opensees_->servers();
  for (std::size_t i = 0; i < servers.size(); ++i)
    if (servers[i].wants_measured()) {
      servers[i].answer(specimens_[i].measured(words_.measured(i, feedbacks(step))));
      opensees_->pass_turn();
    }
}

void OpenSees::begin_round(const StepData& step) {
  auto& servers = opensees_->servers();
  const bool is_move = std::any_of(servers.begin(), servers.end(),
                                   [](const auto& server) { return server.is_new(); });
  for (std::size_t i = 0; i < servers.size(); ++i) {
    const Trial& trial = servers[i].trial();
    const auto& command = specimens_[i].place(trial);
    if (is_move && !has_moved_) words_.start(i, command);
    if (is_move) words_.write(i, command, trial.time, step.outputs);
    servers[i].take_trial();
  }
  if (!is_move) return;
  has_moved_ = true;
  ++rounds_;
  handshake_.post(step.time);
}

void OpenSees::probe(const StepData& step) {
  const auto next = unknown();
  if (next == specimens_.end()) return;
  const auto element = static_cast<std::size_t>(next - specimens_.begin());
  words_.write(element, next->probe(), 0, step.outputs);
  handshake_.post(step.time);
  is_probing_ = true;
}

void OpenSees::identify(const StepData& step) {
  opensees_->require_running();
  if (!handshake_.is_there()) return;
  if (is_probing_) {
    const auto probed = unknown();
    const auto element = static_cast<std::size_t>(probed - specimens_.begin());
    probed->measure(words_.measured(element, feedbacks(step)));
    is_probing_ = false;
    opensees_->pass_turn();
  }
  probe(step);
}

std::string OpenSees::overdue() const {
  std::string message = handshake_.message();
  if (!has_begun_)
    message +=
        ": a controller of the older generation raises it after the first target only; "
        "handshake = \"target_first\" goes with that";
  return message;
}

void OpenSees::begin_test(const StepData& step) {
  words_.start(feedbacks(step));
  words_.write_idle(step.outputs);
  has_begun_ = true;
}

void OpenSees::converse(const StepData& step) {
  for (;;) {
    opensees_->hear(specimens_);
    if (opensees_->has_left() || !handshake_.is_there()) return;
    if (opensees_->has_come() && unknown() != specimens_.end()) return;
    if (opensees_->is_round_complete()) begin_round(step);
    if (!handshake_.is_there()) return;
    // Not before the specimen is where all trials want it.
    if (!opensees_->has_trials()) answer_all(step);
    const Duration patience = opensees_->patience();
    if (!settings_.stops_time) return;
    opensees_->wait_for_news(patience);
  }
}

// OpenSees may still have something to do: recorders are closed then.
Status OpenSees::leave(double time) {
  while (settings_.stops_time && !opensees_->has_finished())
    std::this_thread::sleep_for(kLookEvery);
  if (opensees_->has_finished()) handshake_.leave(time);
  return Status::Ok;
}

Status OpenSees::advance(StepData& step) {
  if (step.stopping && !handshake_.is_leaving()) handshake_.leave(step.time);
  if (handshake_.is_leaving()) return handshake_.has_left(step.time) ? Status::Done : Status::Ok;
  if (!has_begun_ && step.time < settings_.rest) {
    opensees_->hear(specimens_);
    handshake_.be_patient(step.time);
    return Status::Ok;
  }
  const bool was_there = handshake_.is_there();
  const Status status =
      handshake_.look(step.inputs[kAtTarget] > 0, step.inputs[kSwitchPc] > 0, step.time);
  if (status == Status::Fault) throw Error{overdue()};
  if (!was_there && handshake_.is_there()) opensees_->pass_turn();
  if (handshake_.is_there() && !has_begun_) begin_test(step);
  if (!is_probing_) converse(step);
  if (opensees_->has_left()) return leave(step.time);
  if (has_begun_ && opensees_->has_come() && unknown() != specimens_.end()) {
    identify(step);
    if (unknown() == specimens_.end()) converse(step);
  }
  return Status::Ok;
}

void OpenSees::write_monitors(const StepData& step) const {
  const auto monitors = step.outputs.subspan(new_target_at_ + 1);
  monitors[0] = static_cast<double>(rounds_);
  std::size_t at = 1;
  for (const auto& specimen : specimens_)
    for (const double stiffness : specimen.stiffness()) monitors[at++] = stiffness;
}

Status OpenSees::step(StepData& step) noexcept {
  Status status = Status::Fault;
  try {
    status = advance(step);
    write_monitors(step);
  } catch (const std::exception& error) {
    // A script that failed says why; that its elements are gone follows from it.
    message_ = opensees_->explained(error.what());
    step.message = message_.c_str();
  }
  step.outputs[new_target_at_] = handshake_.new_target();
  return status;
}

}  // namespace

std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings) {
  return std::make_unique<OpenSees>(settings);
}

}  // namespace rths::adapters
