// SPDX-License-Identifier: Apache-2.0
//
// Built-in adapters behind the interface of plugins: librths_native.so. Its config has the keys
// experiment (a file), node (of this experiment), set (["key=value"]) and, for a recorder,
// recording (the file to write). A recorder then has the words of the laboratory's map.
#include <rths_adapter.hpp>

#include <rths/adapters/adapter.hpp>
#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/memmap/map.hpp>

namespace rths::app {
namespace {

experiment::Overrides changes_of(const Config& config) {
  experiment::Overrides changes;
  for (const auto& text : config.texts("set", {})) {
    const auto change = key_value(text);
    if (!change) config.fail("set", "found '" + text + "', expected key=value");
    changes.push_back(*change);
  }
  return changes;
}

rths_status status_of(Status status) {
  if (status == Status::Done) return RTHS_DONE;
  if (status == Status::Stale) return RTHS_STALE;
  if (status == Status::LimitExceeded) return RTHS_LIMIT_EXCEEDED;
  return status == Status::Fault ? RTHS_FAULT : RTHS_OK;
}

class NativePlugin final : public rths::PluginBase {
 public:
  explicit NativePlugin(const char* text) {
    const Config config = Config::parse(text, "config");
    experiment_ = load_experiment(config.text("experiment"), changes_of(config));
    const std::string node = config.text("node");
    recording_ = config.text("recording", "");
    config.reject_unknown_keys();
    plan_ = experiment_.node(node);
    if (plan_ == nullptr) config.fail("node", "the experiment has no node '" + node + "'");
    if (plan_->settings.role == experiment::Role::Recorder && recording_.empty())
      config.fail("node", "node '" + node + "' is a recorder, expected the key recording");
    ports_ = make()->ports();
    for (const auto& port : ports_)
      if (port.direction == adapters::Direction::Input ||
          port.direction == adapters::Direction::Parameter)
        ++inputs_;
  }

  [[nodiscard]] std::vector<rths_signal> signals() const override {
    std::vector<rths_signal> signals;
    for (const auto& port : ports_) {
      const auto range = port.range.value_or(std::pair{0.0, 0.0});
      signals.push_back({port.name.c_str(), port.unit.c_str(),
                         static_cast<std::uint32_t>(port.direction),
                         port.event ? static_cast<std::uint32_t>(RTHS_EVENT) : 0U, port.initial,
                         range.first, range.second});
    }
    return signals;
  }

  // A new adapter is in its initial state.
  void activate() override {
    adapter_ = make();
    adapter_->activate();
    stopping_ = false;
  }

  [[nodiscard]] rths_status step(double time_s, const double* in, double* out) noexcept override {
    adapters::StepData step;
    step.time = time_s;
    step.inputs = {in, inputs_};
    step.outputs = {out, ports_.size() - inputs_};
    step.stopping = stopping_;
    const Status status = adapter_->step(step);
    message_ = step.message;
    return status_of(status);
  }

  void deactivate() noexcept override {
    try {
      adapter_->deactivate();
    } catch (const Error&) {
      return;  // an incomplete file: no adapter without files throws
    }
  }
  void stop() noexcept override { stopping_ = true; }
  [[nodiscard]] const char* message() const noexcept override { return message_; }

 private:
  [[nodiscard]] std::unique_ptr<adapters::Adapter> make() const {
    const memmap::Map map = memmap::load_map(experiment_.map);
    const bool is_virtual = recording_.empty();  // a recorder has a thread, as in real time
    experiment::NodeContext context{plan_->node, plan_->schedule.period, is_virtual, recording_,
                                    map,         experiment_.texts(),    {},         {},
                                    {}};
    for (const auto& plan : experiment_.nodes) context.periods[plan.node] = plan.schedule.period;
    return plan_->settings.make(experiment_, context);
  }

  experiment::Experiment experiment_;
  std::filesystem::path recording_;
  const experiment::NodePlan* plan_ = nullptr;
  std::unique_ptr<adapters::Adapter> adapter_;
  std::vector<adapters::Port> ports_;
  std::size_t inputs_ = 0;
  bool stopping_ = false;
  const char* message_ = "";
};

}  // namespace
}  // namespace rths::app

RTHS_EXPORT_ADAPTER_WITH_STOP(rths::app::NativePlugin, "native", "0.1")
