// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opensees_specimen.hpp>

#include <poll.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <thread>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/Core>

#include <rths/core/error.hpp>

#include "endpoint.hpp"
#include "message_codes.hpp"
#include "opensees_process.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;

using Eigen::VectorXd;

constexpr Index kUsualLength = 256;  // of a message [doubles]

/// The client of one `element actuator` or `element adapter` of OpenSees, which is a server for
/// another solver. OpenSees takes a target, computes a step, and answers with displacement and
/// force when it is ready for the next target.
///
/// The first message is that of a `genericClient`, [n, 0, 0, 0, 0, n, 0, 0, n, 0, D]; requests are
/// [code, n displacements], replies [n displacements, n forces].
class SlaveElement {
 public:
  explicit SlaveElement(const OpenSeesElement& element) : element_{element} {
    const Index n = element.dofs();
    message_.resize(static_cast<std::size_t>(std::max(kUsualLength, 2 * n)));
    to_script_ = force_to_script_ = displacement_ = force_ = VectorXd::Zero(n);
    for (Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const bool turns = element.is_rotation[at];
      const double direction = element.axes[at].direction;
      to_script_[i] = direction / element.displacement_unit(turns);
      force_to_script_[i] = direction / element.force_unit_of(turns);
    }
  }

  /// Connects if its port is open. @returns whether it is connected   @throws Error
  [[nodiscard]] bool connect() {
    endpoint_ = Endpoint::connect(element_.is_udp ? Transport::Udp : Transport::Tcp,
                                  element_.address, element_.port);
    if (!endpoint_) return false;
    const auto n = static_cast<std::int32_t>(element_.dofs());
    const std::array<std::int32_t, 11> sizes{
        n, 0, 0, 0, 0, n, 0, 0, n, 0, static_cast<std::int32_t>(message_.size())};
    endpoint_->send(std::as_bytes(std::span{sizes}), kSendDeadline);
    return true;
  }

  /// Sends a target, in SI along the machine's axes, and requests the response.
  void send_target(const VectorXd& displacement) {
    const VectorXd target = to_script_.cwiseProduct(displacement);
    std::copy(target.begin(), target.end(), message_.begin() + 1);
    send(message_code::kTrial);
    send(message_code::kForce);
    awaits_response_ = true;
  }

  /// @returns whether the response has arrived   @throws Error with the element's name
  [[nodiscard]] bool receive() {
    if (!awaits_response_) return true;
    const auto response =
        with_name([&] { return endpoint_->receive(message_.size() * sizeof(double)); });
    if (response.empty()) return false;
    std::memcpy(message_.data(), response.data(), response.size());
    awaits_response_ = false;
    const Index n = element_.dofs();
    const Eigen::Map<const VectorXd> values{message_.data(), 2 * n};
    if (!values.allFinite())
      throw Error{fmt::format("element '{}': OpenSees sent NaN or infinity", element_.name)};
    displacement_ = values.head(n).cwiseQuotient(to_script_);
    force_ = values.tail(n).cwiseQuotient(force_to_script_);
    return true;
  }

  /// Along the machine's axes [m, rad], [N, N·m].
  [[nodiscard]] const Eigen::VectorXd& displacement() const { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_; }

  /// Ends the connection; OpenSees then exits.
  void send_end() {
    if (!endpoint_) return;
    message_[0] = message_code::kEnd;
    with_name([&] { endpoint_->send_last(std::as_bytes(std::span{message_}), kSendDeadline); });
    endpoint_.reset();
  }

  [[nodiscard]] bool awaits_response() const { return awaits_response_; }
  [[nodiscard]] int descriptor() const { return endpoint_ ? endpoint_->descriptor() : -1; }

 private:
  template <class Action>

  std::invoke_result_t<Action> with_name(const Action& action) {
    try {
      return action();
    } catch (const Error&) {  // the endpoint's message refers to a client
      throw Error{fmt::format("element '{}': OpenSees closed the connection", element_.name)};
    }
  }

  void send(double code) {
    message_[0] = code;
    with_name([&] { endpoint_->send(std::as_bytes(std::span{message_}), kSendDeadline); });
  }

  OpenSeesElement element_;
  std::optional<Endpoint> endpoint_;
  std::vector<double> message_;
  Eigen::VectorXd to_script_;        ///< of displacements, signed by the axes' directions
  Eigen::VectorXd force_to_script_;  ///< of forces, signed likewise
  Eigen::VectorXd displacement_, force_;
  bool awaits_response_ = false;
};

using Eigen::Index;
using Eigen::VectorXd;

constexpr auto kAlivePollPeriod = std::chrono::milliseconds{20};  // whether OpenSees still runs

class OpenSeesSpecimen final : public Adapter {
 public:
  explicit OpenSeesSpecimen(OpenSeesSpecimenSettings settings)
      : settings_{std::move(settings)}, ports_{{"opf.newTarget", Direction::Input, "1", 0, false}} {
    for (const auto& element : settings_.elements) {
      add_ports(element);
      elements_.emplace_back(element);
    }
    ports_.push_back({"daq.switchPC", Direction::Output, "1", 0, false});
    ports_.push_back({"daq.atTarget", Direction::Output, "1", 0, false});
  }

  [[nodiscard]] std::vector<Port> ports() const override { return ports_; }

  void activate() override {
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

  [[nodiscard]] Status step(StepData& step) noexcept override {
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

  // OpenSees exits with a failure after the end message, so its result is ignored.
  void deactivate() override {
    if (opensees_ && has_sent_end_) opensees_->finish();
    opensees_.reset();
    elements_.clear();
  }

 private:
  void add_ports(const OpenSeesElement& element) {
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

  void advance(const StepData& step) {
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

  void send_targets(const StepData& step) {
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

  [[nodiscard]] bool receive_responses() {
    bool are_complete = true;
    for (auto& element : elements_) are_complete = element.receive() && are_complete;
    return are_complete;
  }

  void wait_for_input() const {
    std::vector<pollfd> sockets;
    for (const auto& element : elements_)
      if (element.awaits_response()) sockets.push_back({element.descriptor(), POLLIN, 0});
    poll(sockets.data(), sockets.size(), static_cast<int>(kAlivePollPeriod.count()));
  }

  void write_feedbacks(const StepData& step) const {
    std::size_t axis = 0;
    for (const auto& element : elements_)
      for (Index i = 0; i < element.force().size(); ++i, ++axis) {
        if (outputs_[axis].first) step.outputs[*outputs_[axis].first] = element.displacement()[i];
        step.outputs[outputs_[axis].second] = element.force()[i];
      }
  }

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

}  // namespace

std::unique_ptr<Adapter> make_opensees_specimen(const OpenSeesSpecimenSettings& settings) {
  return std::make_unique<OpenSeesSpecimen>(settings);
}

}  // namespace rths::adapters
