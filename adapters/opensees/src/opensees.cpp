// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees.hpp>

#include <poll.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/error.hpp>

#include "element_server.hpp"
#include "script.hpp"

namespace rths::adapters {
namespace {

constexpr auto kLookEvery = std::chrono::milliseconds{100};  // whether OpenSees still runs

class OpenSees final : public Adapter {
 public:
  explicit OpenSees(OpenSeesSettings settings)
      : settings_{std::move(settings)}, handshake_{settings_.wait_deadline} {}
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
  void begin_round(const Step& step);
  void answer_all(const Step& step);
  template <class Condition>
  [[nodiscard]] bool all(const Condition& condition) const {
    return std::all_of(servers_.begin(), servers_.end(), condition);
  }

  OpenSeesSettings settings_;
  std::vector<ElementServer> servers_;
  std::optional<Script> script_;
  OpfHandshake handshake_;
  TimePoint heard_{0};  ///< last, on the host's clock
  std::uint64_t rounds_ = 0;
  bool has_left_ = false;
  std::string message_;
};

std::vector<Port> OpenSees::ports() const {
  std::vector<Port> ports;
  const auto add = [&](const std::string& name, Direction direction, const std::string& unit) {
    ports.push_back({name, direction, unit, 0, false});
  };
  add("daq.atTarget", Direction::Input, "1");
  add("daq.switchPC", Direction::Input, "1");
  for (const auto& element : settings_.elements)
    for (const auto& dof : element.dofs)
      add(dof.force, Direction::Input, dof.is_rotation ? "N.m" : "N");
  for (const auto& element : settings_.elements)
    for (const auto& dof : element.dofs) {
      add(dof.displacement, Direction::Output, dof.is_rotation ? "rad" : "m");
      if (!dof.velocity.empty())
        add(dof.velocity, Direction::Output, dof.is_rotation ? "rad/s" : "m/s");
    }
  add("opf.1.time.target", Direction::Output, "s");
  add("opf.newTarget", Direction::Output, "1");
  add("step", Direction::Monitor, "1");
  return ports;
}

void OpenSees::activate() {
  for (const auto& element : settings_.elements) servers_.emplace_back(element);
  for (const auto& [file, content] : settings_.files)
    if (!(std::ofstream{file} << content).flush())
      throw Error{fmt::format("{}: cannot be written", file.string())};
  if (!settings_.command.empty()) script_.emplace(settings_.command, settings_.log);
  heard_ = WallClock{}.now();
}

// What it still has to do when its elements are gone, it may do: recorders are closed then.
void OpenSees::deactivate() {
  constexpr auto kToFinish = std::chrono::seconds{5};
  std::optional<std::string> trouble;
  if (script_ && has_left_) {
    script_->wait(kToFinish);
    trouble = script_->trouble();
  }
  script_.reset();
  servers_.clear();
  if (trouble) throw Error{*trouble};
}

void OpenSees::hear_all() {
  for (auto& server : servers_)
    if (server.hear()) heard_ = WallClock{}.now();
}

// All have their targets, or one of them waits for its force: then no more will come.
bool OpenSees::is_round_complete() const {
  return all([](const auto& server) { return server.has_trial(); }) ||
         !all([](const auto& server) { return !server.wants_force(); });
}

bool OpenSees::owes_nothing() const {
  return handshake_.is_there() && all([](const auto& server) { return !server.wants_force(); });
}

Duration OpenSees::patience() {
  const bool is_here = all([](const auto& server) { return server.is_connected(); });
  const double longest = is_here ? settings_.answer_deadline : settings_.connect_deadline;
  if (script_ && script_->has_ended())
    throw Error{script_->trouble().value_or("OpenSees has ended, and its elements have not")};
  const Duration left = heard_ + from_seconds(longest) - WallClock{}.now();
  if (left > Duration{0}) return std::min<Duration>(left, kLookEvery);
  throw Error{is_here ? fmt::format("OpenSees has been silent for {:g} s", longest)
                      : fmt::format("OpenSees has not come within {:g} s", longest)};
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
  return all([](const auto& server) { return server.wants_force(); }) ? News::Inputs
                                                                      : News::Outside;
}

void OpenSees::answer_all(const Step& step) {
  std::size_t at = kFeedback;
  for (std::size_t i = 0; i < servers_.size(); ++i) {
    const auto& dofs = settings_.elements[i].dofs;
    Eigen::VectorXd forces(static_cast<Eigen::Index>(dofs.size()));
    for (std::size_t k = 0; k < dofs.size(); ++k)
      forces[static_cast<Eigen::Index>(k)] = step.inputs[at++] / dofs[k].force_unit;
    if (servers_[i].wants_force()) servers_[i].answer(forces);
  }
}

void OpenSees::begin_round(const Step& step) {
  const bool is_move = !all([](const auto& server) { return !server.is_new(); });
  std::size_t at = 0;
  for (std::size_t i = 0; i < servers_.size(); ++i) {
    const Trial& trial = servers_[i].trial();
    const auto& dofs = settings_.elements[i].dofs;
    for (std::size_t k = 0; is_move && k < dofs.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      step.outputs[at++] = trial.displacement[row] * dofs[k].displacement_unit;
      if (!dofs[k].velocity.empty())
        step.outputs[at++] = trial.velocity[row] * dofs[k].displacement_unit;
    }
    servers_[i].take_trial();
  }
  if (!is_move) return;
  step.outputs[at] = servers_[0].trial().time;
  ++rounds_;
  handshake_.post(step.time);
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
  if (rounds_ == 0 && step.time < settings_.rest) {
    handshake_.be_patient(step.time);
    return Status::Ok;
  }
  const Status status =
      handshake_.look(step.inputs[kAtTarget] > 0, step.inputs[kSwitchPc] > 0, step.time);
  if (status == Status::Fault) {
    step.message = handshake_.message();
    return status;
  }
  converse(step);
  if (has_left_) handshake_.leave(step.time);
  return Status::Ok;
}

Status OpenSees::step(Step& step) noexcept {
  Status status = Status::Fault;
  try {
    status = advance(step);
    step.outputs.back() = static_cast<double>(rounds_);
  } catch (const std::exception& error) {
    message_ = error.what();
    // A script that failed says why; that its elements are gone follows from it.
    if (script_ && script_->wait(kLookEvery))
      if (const auto trouble = script_->trouble(); trouble && *trouble != message_)
        message_ += "; " + *trouble;
    step.message = message_.c_str();
  }
  step.outputs[step.outputs.size() - 2] = handshake_.new_target();
  return status;
}

}  // namespace

std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings) {
  return std::make_unique<OpenSees>(settings);
}

}  // namespace rths::adapters
