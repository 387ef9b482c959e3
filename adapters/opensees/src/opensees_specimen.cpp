// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees_specimen.hpp>

#include <poll.h>

#include <algorithm>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "opensees_process.hpp"
#include "slave_element.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr auto kAlivePollPeriod = std::chrono::milliseconds{20};  // whether OpenSees still runs

class OpenSeesSpecimen final : public Adapter {
 public:
  explicit OpenSeesSpecimen(OpenSeesSpecimenSettings settings);
  [[nodiscard]] std::vector<Port> ports() const override { return ports_; }
  void activate() override;
  [[nodiscard]] Status step(StepData& step) noexcept override;
  void deactivate() override;

 private:
  void add_ports(const OpenSeesElement& element);
  void advance(const StepData& step);
  void send_targets(const StepData& step);
  [[nodiscard]] bool receive_responses();
  void wait_for_input() const;
  void write_feedbacks(const StepData& step) const;

  OpenSeesSpecimenSettings settings_;
  std::vector<Port> ports_;
  std::vector<SlaveElement> elements_;
  std::optional<OpenSeesProcess> opensees_;
  /// Outputs of each axis: displacement (if the map has its word), force.
  std::vector<std::pair<std::optional<std::size_t>, std::size_t>> outputs_;
  bool had_target_ = false, is_moving_ = false, has_sent_end_ = false;
  double arrival_ = 0;  ///< last or next arrival at a target [s]
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
    for (const auto& port : ports_)
      if (port.name == signal->name)
        throw Error{fmt::format("element '{}': axis '{}' is listed twice", element.name, axis)};
    ports_.push_back({signal->name, direction, signal->unit, 0, false});
  };
  const auto& [commands, feedbacks] = settings_.layout;
  for (const auto& axis : element.axes)
    add(OpfLayout::find(commands, axis.axis, OpfQuantity::Displacement), Direction::Input,
        axis.axis);
  const auto count = [&] {
    return static_cast<std::size_t>(
        std::count_if(ports_.begin(), ports_.end(),
                      [](const Port& port) { return port.direction == Direction::Output; }));
  };
  for (const auto& axis : element.axes) {
    std::optional<std::size_t> displacement;
    if (const auto* signal = OpfLayout::find(feedbacks, axis.axis, OpfQuantity::Displacement)) {
      displacement = count();
      add(signal, Direction::Output, axis.axis);
    }
    outputs_.emplace_back(displacement, count());
    add(OpfLayout::find(feedbacks, axis.axis, OpfQuantity::Force), Direction::Output, axis.axis);
  }
}

void OpenSeesSpecimen::activate() {
  opensees_.emplace(settings_.script);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    while (!elements_[i].connect()) {
      static_cast<void>(
          opensees_->time_left(settings_.script.connect_deadline, "has not opened its port for"));
      std::this_thread::sleep_for(kAlivePollPeriod);
    }
    if (!settings_.elements[i].is_udp) opensees_->keep(elements_[i].descriptor());
  }
}

// OpenSees exits with a failure after the end message, so its result is ignored.
void OpenSeesSpecimen::deactivate() {
  if (opensees_ && has_sent_end_) opensees_->finish();
  opensees_.reset();
  elements_.clear();
}

void OpenSeesSpecimen::send_targets(const StepData& step) {
  std::size_t at = 1;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    VectorXd target{settings_.elements[i].dofs()};
    for (double& value : target) value = step.inputs[at++];
    elements_[i].send_target(target);
  }
  opensees_->restart_deadline();
  is_moving_ = true;
  arrival_ = std::max(step.time, arrival_ + settings_.simulation_step);
}

void OpenSeesSpecimen::wait_for_input() const {
  std::vector<pollfd> sockets;
  for (const auto& element : elements_)
    if (element.awaits_response()) sockets.push_back({element.descriptor(), POLLIN, 0});
  poll(sockets.data(), sockets.size(), static_cast<int>(kAlivePollPeriod.count()));
}

bool OpenSeesSpecimen::receive_responses() {
  bool are_complete = true;
  for (auto& element : elements_) are_complete = element.receive() && are_complete;
  return are_complete;
}

void OpenSeesSpecimen::write_feedbacks(const StepData& step) const {
  std::size_t axis = 0;
  for (const auto& element : elements_)
    for (Index i = 0; i < element.force().size(); ++i, ++axis) {
      if (outputs_[axis].first) step.outputs[*outputs_[axis].first] = element.displacement()[i];
      step.outputs[outputs_[axis].second] = element.force()[i];
    }
}

void OpenSeesSpecimen::advance(const StepData& step) {
  const bool has_target = step.inputs[0] > 0;
  if (has_target && !had_target_) send_targets(step);
  had_target_ = has_target;
  if (is_moving_) {
    bool has_arrived = receive_responses();
    while (!has_arrived) {
      static_cast<void>(
          opensees_->time_left(settings_.script.answer_deadline, "has not answered for"));
      if (!settings_.stops_time) break;
      wait_for_input();
      has_arrived = receive_responses();
    }
    if (has_arrived && !has_target && step.time >= arrival_) {
      write_feedbacks(step);
      is_moving_ = false;
    }
  }
  step.outputs[step.outputs.size() - 2] = has_target ? 1 : 0;
  step.outputs[step.outputs.size() - 1] = is_moving_ ? 0 : 1;
}

Status OpenSeesSpecimen::step(StepData& step) noexcept {
  try {
    if (!step.stopping && step.inputs[0] >= 0) {
      advance(step);
      return Status::Ok;
    }
    for (auto& element : elements_) element.send_end();
    has_sent_end_ = true;
    return Status::Done;
  } catch (const std::exception& error) {
    message_ = opensees_->with_exit_reason(error.what());
    step.message = message_.c_str();
    return Status::Fault;
  }
}

}  // namespace

std::unique_ptr<Adapter> make_opensees_specimen(const OpenSeesSpecimenSettings& settings) {
  return std::make_unique<OpenSeesSpecimen>(settings);
}

}  // namespace rths::adapters
