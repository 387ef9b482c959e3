// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees.hpp>

#include <poll.h>

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/error.hpp>

#include "element_server.hpp"
#include "opensees_process.hpp"
#include "opf_words.hpp"
#include "specimen.hpp"

namespace rths::adapters {
namespace {

constexpr int kMostQuestions = 100;  // at once: OpenSees waits for each answer
constexpr auto kLookEvery = std::chrono::milliseconds{100};  // whether OpenSees still runs

class OpenSees final : public Adapter {
 public:
  explicit OpenSees(OpenSeesSettings settings);
  [[nodiscard]] std::vector<Port> ports() const override;
  void activate() override;
  [[nodiscard]] Status step(Step& step) noexcept override;
  [[nodiscard]] News awaits() const noexcept override;
  void wait_outside(Duration longest) override { wait_for_news(longest); }
  void deactivate() override;

 private:
  enum In : std::size_t { kAtTarget, kSwitchPc, kFeedback };  // positions among the inputs

  [[nodiscard]] Status advance(Step& step);
  void hear_all();
  [[nodiscard]] Duration patience();
  void wait_for_news(Duration longest) const;
  // Hears what there is. Where time stands still, waits until OpenSees has done its part.
  void converse(const Step& step);
  [[nodiscard]] bool is_round_complete() const;
  [[nodiscard]] bool owes_nothing() const;
  [[nodiscard]] std::span<const double> feedbacks(const Step& step) const {
    return step.inputs.subspan(kFeedback);
  }
  [[nodiscard]] std::string overdue() const;
  void begin_test(const Step& step);
  void begin_round(const Step& step);
  void answer_all(const Step& step);
  // Shakes those specimens that are not known yet, one after the other. @returns whether it has
  // something to do
  bool identify(const Step& step);
  void write_monitors(const Step& step) const;
  template <class Condition>
  [[nodiscard]] bool all(const Condition& condition) const {
    return std::all_of(servers_.begin(), servers_.end(), condition);
  }

  OpenSeesSettings settings_;
  OpfWords words_;
  std::size_t new_target_at_;        ///< among the outputs: behind what it guards
  std::vector<Specimen> specimens_;  ///< of each element
  std::vector<ElementServer> servers_;
  std::optional<OpenSeesProcess> opensees_;
  OpfHandshake handshake_;
  std::uint64_t rounds_ = 0;
  bool has_begun_ = false, has_moved_ = false, is_probing_ = false;
  bool has_left_ = false;
  std::string message_;
};

OpenSees::OpenSees(OpenSeesSettings settings)
    : settings_{std::move(settings)},
      words_{control_points(settings_.layout, settings_.trial_points, settings_.output_points),
             settings_.elements},
      new_target_at_{words_.commands().size()},
      handshake_{settings_.wait_deadline, settings_.handshake} {
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

void OpenSees::activate() {
  for (const auto& element : settings_.elements) servers_.emplace_back(element);
  opensees_.emplace(settings_.script);
}

void OpenSees::deactivate() {
  const auto trouble = opensees_ && has_left_ ? opensees_->finish() : std::nullopt;
  opensees_.reset();
  servers_.clear();
  if (trouble) throw Error{*trouble};
}

// Matrices are answered at once: what OpenSees says next may be a target.
void OpenSees::hear_all() {
  for (std::size_t i = 0; i < servers_.size(); ++i)
    for (int heard = 0; heard < kMostQuestions && servers_[i].hear(); ++heard) {
      opensees_->heard();
      if (servers_[i].has_just_come() && !settings_.elements[i].is_udp)
        opensees_->keep(servers_[i].descriptor());
      if (servers_[i].wants_matrix()) servers_[i].answer(specimens_[i].matrices());
    }
}

// All have their targets, or one of them waits for its force: then no more will come.
bool OpenSees::is_round_complete() const {
  return all([](const auto& server) { return server.has_trial(); }) ||
         !all([](const auto& server) { return !server.wants_measured(); });
}

bool OpenSees::owes_nothing() const {
  return handshake_.is_there() && all([](const auto& server) { return !server.wants_measured(); });
}

Duration OpenSees::patience() {
  const bool is_here = all([](const auto& server) { return server.is_connected(); });
  const auto& script = settings_.script;
  const Duration left = is_here ? opensees_->patience(script.answer_deadline, "has been silent for")
                                : opensees_->patience(script.connect_deadline, "has not come for");
  return std::min<Duration>(left, kLookEvery);
}

void OpenSees::wait_for_news(Duration longest) const {
  std::vector<pollfd> news;
  for (const auto& server : servers_)
    if (!server.has_left()) news.push_back({server.descriptor(), POLLIN, 0});
  const timespec patience{longest / std::chrono::seconds{1},
                          (longest % std::chrono::seconds{1}).count()};
  ppoll(news.data(), news.size(), &patience, nullptr);
}

// Once every element waits for its force, OpenSees says no more before the specimen has arrived.
News OpenSees::awaits() const noexcept {
  if (!settings_.is_prompt || settings_.stops_time || handshake_.is_leaving()) return News::None;
  const bool waits_for_specimen =
      !has_begun_ || is_probing_ || all([](const auto& server) { return server.wants_measured(); });
  return waits_for_specimen ? News::Inputs : News::Outside;
}

void OpenSees::answer_all(const Step& step) {
  for (std::size_t i = 0; i < servers_.size(); ++i)
    if (servers_[i].wants_measured())
      servers_[i].answer(specimens_[i].measured(words_.measured(i, feedbacks(step))));
}

void OpenSees::begin_round(const Step& step) {
  const bool is_move = !all([](const auto& server) { return !server.is_new(); });
  for (std::size_t i = 0; i < servers_.size(); ++i) {
    const Trial& trial = servers_[i].trial();
    const auto& command = specimens_[i].place(trial);
    if (is_move && !has_moved_) words_.start(i, command);
    if (is_move) words_.write(i, command, trial.time, step.outputs);
    servers_[i].take_trial();
  }
  if (!is_move) return;
  has_moved_ = true;
  ++rounds_;
  handshake_.post(step.time);
}

bool OpenSees::identify(const Step& step) {
  if (is_probing_ && !handshake_.is_there()) return true;
  for (std::size_t i = 0; i < specimens_.size(); ++i) {
    if (specimens_[i].is_known()) continue;
    if (is_probing_) {
      specimens_[i].measure(words_.measured(i, feedbacks(step)));
      is_probing_ = false;
      opensees_->heard();  // it has waited for us, not we for it
      return identify(step);
    }
    words_.write(i, specimens_[i].probe(), 0, step.outputs);
    handshake_.post(step.time);
    is_probing_ = true;
    return true;
  }
  return false;
}

std::string OpenSees::overdue() const {
  std::string message = handshake_.message();
  if (!has_begun_)
    message +=
        ": a controller of the older generation raises it after the first target only; "
        "handshake = \"target_first\" goes with that";
  return message;
}

void OpenSees::begin_test(const Step& step) {
  words_.start(feedbacks(step));
  has_begun_ = true;
}

void OpenSees::converse(const Step& step) {
  while (true) {
    hear_all();
    if (handshake_.is_there() && is_round_complete()) begin_round(step);
    if (handshake_.is_there()) answer_all(step);
    has_left_ = all([](const auto& server) { return server.has_left(); });
    if (has_left_) return;
    if (!settings_.stops_time || !owes_nothing()) {
      if (owes_nothing()) static_cast<void>(patience());
      return;
    }
    wait_for_news(patience());
  }
}

Status OpenSees::advance(Step& step) {
  if (step.stopping && !handshake_.is_leaving()) handshake_.leave(step.time);
  if (handshake_.is_leaving()) return handshake_.has_left(step.time) ? Status::Done : Status::Ok;
  if (!has_begun_ && step.time < settings_.rest) {
    handshake_.be_patient(step.time);
    return Status::Ok;
  }
  const Status status =
      handshake_.look(step.inputs[kAtTarget] > 0, step.inputs[kSwitchPc] > 0, step.time);
  if (status == Status::Fault) throw Error{overdue()};
  if (handshake_.is_there() && !has_begun_) begin_test(step);
  if (has_begun_ && identify(step)) return Status::Ok;
  converse(step);
  if (has_left_) handshake_.leave(step.time);
  return Status::Ok;
}

void OpenSees::write_monitors(const Step& step) const {
  const auto monitors = step.outputs.subspan(new_target_at_ + 1);
  monitors[0] = static_cast<double>(rounds_);
  std::size_t at = 1;
  for (const auto& specimen : specimens_)
    for (const double stiffness : specimen.stiffness()) monitors[at++] = stiffness;
}

Status OpenSees::step(Step& step) noexcept {
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
