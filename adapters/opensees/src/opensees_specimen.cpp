// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees_specimen.hpp>

#include <poll.h>

#include <algorithm>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>

#include "script.hpp"
#include "slave_element.hpp"
#include "socket_keeper.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr auto kLookEvery = std::chrono::milliseconds{20};  // whether OpenSees still runs
constexpr auto kToFinish = std::chrono::seconds{5};

class OpenSeesSpecimen final : public Adapter {
 public:
  explicit OpenSeesSpecimen(OpenSeesSpecimenSettings settings);
  [[nodiscard]] std::vector<Port> ports() const override { return ports_; }
  void activate() override;
  [[nodiscard]] Status step(Step& step) noexcept override;
  void deactivate() override;

 private:
  void add_ports(const OpenSeesElement& element);
  void advance(const Step& step);
  void ask(const Step& step);
  [[nodiscard]] bool has_arrived();
  void write_feedbacks(const Step& step) const;
  // @throws Error if OpenSees has ended, or the time is up
  void require_patience(double longest, const char* otherwise);

  OpenSeesSpecimenSettings settings_;
  std::vector<Port> ports_;
  std::vector<SlaveElement> elements_;
  std::optional<Script> script_;        ///< OpenSees that ends with us, or
  std::optional<SocketKeeper> keeper_;  ///< what that of a user's own is left with
  /// Outputs of each axis: displacement if the map has a word for it, force.
  std::vector<std::pair<std::optional<std::size_t>, std::size_t>> outputs_;
  bool had_target_ = false, is_moving_ = false, is_dismissed_ = false;
  double arrival_ = 0;  ///< the last or the next [s]
  TimePoint asked_{0};  ///< on the host's clock
  std::string message_;
};

OpenSeesSpecimen::OpenSeesSpecimen(OpenSeesSpecimenSettings settings)
    : settings_{std::move(settings)}, ports_{{"opf.newTarget", Direction::Input, "1", 0, false}} {
  for (const auto& element : settings_.elements) {
    add_ports(element);
    elements_.emplace_back(element);
  }
  ports_.push_back({"daq.switchPC", Direction::Output, "1", 0, false});
  ports_.push_back({"daq.atTarget", Direction::Output, "1", 0, false});
}

void OpenSeesSpecimen::add_ports(const OpenSeesElement& element) {
  const auto add = [&](const OpfSignal* signal, Direction direction, const std::string& axis) {
    if (signal == nullptr)
      throw Error{
          fmt::format("element '{}': the map has no words for axis '{}'", element.name, axis)};
    ports_.push_back({signal->name, direction, signal->unit, 0, false});
  };
  const auto& [commands, feedbacks] = settings_.layout;
  for (const auto& axis : element.axes)
    add(OpfLayout::find(commands, axis.axis, Quantity::Displacement), Direction::Input, axis.axis);
  const auto count = [&] {
    return static_cast<std::size_t>(
        std::count_if(ports_.begin(), ports_.end(),
                      [](const Port& port) { return port.direction == Direction::Output; }));
  };
  for (const auto& axis : element.axes) {
    std::optional<std::size_t> displacement;
    if (const auto* signal = OpfLayout::find(feedbacks, axis.axis, Quantity::Displacement)) {
      displacement = count();
      add(signal, Direction::Output, axis.axis);
    }
    outputs_.emplace_back(displacement, count());
    add(OpfLayout::find(feedbacks, axis.axis, Quantity::Force), Direction::Output, axis.axis);
  }
}

void OpenSeesSpecimen::require_patience(double longest, const char* otherwise) {
  if (script_ && script_->has_ended())
    throw Error{script_->trouble().value_or("OpenSees has ended")};
  if (WallClock{}.now() > asked_ + from_seconds(longest))
    throw Error{fmt::format("OpenSees {} within {:g} s{}", otherwise, longest,
                            script_ ? fmt::format(" ({})", settings_.log.string()) : "")};
}

void OpenSeesSpecimen::activate() {
  if (settings_.command.empty())
    keeper_.emplace();
  else
    script_.emplace(settings_.command, settings_.log);
  asked_ = WallClock{}.now();
  for (auto& element : elements_) {
    while (!element.connect()) {
      require_patience(settings_.connect_deadline, "has not opened its port");
      std::this_thread::sleep_for(kLookEvery);
    }
    if (keeper_) keeper_->keep(element.descriptor());
  }
}

void OpenSeesSpecimen::deactivate() {
  if (script_ && is_dismissed_) script_->wait(kToFinish);
  script_.reset();
  if (keeper_ && is_dismissed_) keeper_->release();
  keeper_.reset();
  elements_.clear();
}

void OpenSeesSpecimen::ask(const Step& step) {
  std::size_t at = 1;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    VectorXd target{settings_.elements[i].dofs()};
    for (double& value : target) value = step.inputs[at++];
    elements_[i].ask(target);
  }
  asked_ = WallClock{}.now();
  is_moving_ = true;
  arrival_ = std::max(step.time, arrival_ + settings_.simulation_step);
}

bool OpenSeesSpecimen::has_arrived() {
  bool is_there = true;
  for (auto& element : elements_) is_there = element.hear() && is_there;
  return is_there;
}

void OpenSeesSpecimen::write_feedbacks(const Step& step) const {
  std::size_t axis = 0;
  for (const auto& element : elements_)
    for (Index i = 0; i < element.force().size(); ++i, ++axis) {
      if (outputs_[axis].first) step.outputs[*outputs_[axis].first] = element.displacement()[i];
      step.outputs[outputs_[axis].second] = element.force()[i];
    }
}

void OpenSeesSpecimen::advance(const Step& step) {
  const bool has_target = step.inputs[0] > 0;
  if (has_target && !had_target_) ask(step);
  had_target_ = has_target;
  if (is_moving_) {
    bool is_there = has_arrived();
    while (!is_there && settings_.stops_time) {
      require_patience(settings_.answer_deadline, "has not answered");
      pollfd news{elements_[0].descriptor(), POLLIN, 0};
      poll(&news, 1, static_cast<int>(kLookEvery.count()));
      is_there = has_arrived();
    }
    if (!is_there) require_patience(settings_.answer_deadline, "has not answered");
    if (is_there && !has_target && step.time >= arrival_) {
      write_feedbacks(step);
      is_moving_ = false;
    }
  }
  step.outputs[step.outputs.size() - 2] = has_target ? 1 : 0;
  step.outputs[step.outputs.size() - 1] = is_moving_ ? 0 : 1;
}

Status OpenSeesSpecimen::step(Step& step) noexcept {
  try {
    if (!step.stopping && step.inputs[0] >= 0) {
      advance(step);
      return Status::Ok;
    }
    for (auto& element : elements_) element.dismiss();
    is_dismissed_ = true;
    return Status::Done;
  } catch (const std::exception& error) {
    message_ = error.what();
    if (script_ && script_->wait(kLookEvery))
      if (const auto trouble = script_->trouble(); trouble && *trouble != message_)
        message_ += "; " + *trouble;
    step.message = message_.c_str();
    return Status::Fault;
  }
}

}  // namespace

std::unique_ptr<Adapter> make_opensees_specimen(const OpenSeesSpecimenSettings& settings) {
  return std::make_unique<OpenSeesSpecimen>(settings);
}

}  // namespace rths::adapters
