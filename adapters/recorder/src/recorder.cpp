// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/recorder.hpp>

#include <atomic>
#include <chrono>
#include <optional>
#include <string_view>
#include <thread>

#include <boost/lockfree/spsc_queue.hpp>

#include <rths/controller/safety_states.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/memmap/units.hpp>

namespace rths::adapters {
namespace {

constexpr std::size_t kQueuedRows = 2000;  // 2 s at 1 kHz: longer than any disk stalls
constexpr auto kWriterNap = std::chrono::milliseconds{5};
constexpr double kSettling = 0.2;  // recorded after a safety layer came to rest [s]
constexpr double kSilence = 0.5;   // without a step: its node is dead [s]
constexpr std::string_view kSafetyState = ".safety.state";

bool is_moving(double state) noexcept {
  return state == static_cast<double>(controller::SafetyState::Hold) ||
         state == static_cast<double>(controller::SafetyState::RampDown);
}

/// The words of a node with a safety layer, as inputs of the recorder.
class SafetyLayer {
 public:
  SafetyLayer(std::size_t state, std::optional<std::size_t> count) : state_{state}, count_{count} {}
  /// Whether the layer moves its machine. A dead node leaves the state that it had.
  [[nodiscard]] bool is_moving_its_machine(const StepData& step) noexcept {
    const double count = count_ ? step.inputs[*count_] : step.time;
    if (count != last_count_) stepped_at_ = step.time;
    last_count_ = count;
    return is_moving(step.inputs[state_]) && step.time - stepped_at_ < kSilence;
  }

 private:
  std::size_t state_;
  std::optional<std::size_t> count_;  ///< of the node's steps
  double last_count_ = -1, stepped_at_ = 0;
};

class Recorder final : public Adapter {
 public:
  Recorder(const memmap::Map& map, const RecorderSettings& settings)
      : map_{map}, settings_{settings} {
    for (std::uint32_t i = 0; i < map_.signals().size(); ++i) {
      signals_.push_back(SignalId{i});
      const std::string& name = map_.entry(SignalId{i}).name;
      if (name.ends_with(kSafetyState)) add_safety_layer(i, name);
    }
  }
  ~Recorder() override { stop_writer(); }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    for (const auto id : signals_) {
      const auto& entry = map_.entry(id);
      ports.push_back(
          {entry.name, Direction::Input, memmap::parse_unit(entry.signal->unit).si, 0, false});
    }
    for (const auto& port : recorder_monitors()) ports.push_back(port);
    return ports;
  }

  void activate() override {
    writer_.emplace(settings_.file, map_, signals_, settings_.info);
    outgoing_.resize(row_length());
    incoming_.resize(row_length());
    if (!settings_.own_thread) return;
    queue_ = std::make_unique<Queue>(kQueuedRows * row_length());
    thread_ = std::thread{[this] { run_writer(); }};
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    if (failed_.load(std::memory_order_acquire)) {
      step.message = failure_.c_str();
      return Status::Fault;
    }
    record(step);
    if (!step.stopping) return Status::Ok;
    if (stopped_at_ < 0) stopped_at_ = step.time;
    for (auto& layer : safety_layers_)
      if (layer.is_moving_its_machine(step)) moved_at_ = step.time;
    const double since = step.time - stopped_at_;
    const bool is_over = since >= settings_.linger && step.time - moved_at_ >= kSettling;
    return is_over || since >= settings_.longest ? Status::Done : Status::Ok;
  }

  // Rows may still be queued after the last step.
  void deactivate() override {
    stop_writer();
    if (failed_.load(std::memory_order_acquire)) throw Error{failure_};
    if (writer_) writer_->close();
  }

 private:
  // A row in the queue: its time, then its values.
  using Queue = boost::lockfree::spsc_queue<double>;
  [[nodiscard]] std::size_t row_length() const noexcept { return signals_.size() + 1; }

  void add_safety_layer(std::size_t state, const std::string& name) {
    const std::string node = name.substr(0, name.size() - kSafetyState.size());
    std::optional<std::size_t> count;
    if (const auto signal = map_.find_signal(node + ".host.step")) count = signal->value();
    safety_layers_.emplace_back(state, count);
  }

  void write_queued() {
    writer_->set_rows_missing(missing_rows_.load(std::memory_order_relaxed));
    while (queue_->read_available() >= row_length()) {
      queue_->pop(incoming_.data(), row_length());
      writer_->append(from_seconds(incoming_[0]), std::span{incoming_}.subspan(1));
    }
  }

  void run_writer() noexcept {
    try {
      while (!finish_.load(std::memory_order_acquire)) {
        write_queued();
        std::this_thread::sleep_for(kWriterNap);
      }
      write_queued();
      writer_->close();
    } catch (const std::exception& error) {
      failure_ = error.what();
      failed_.store(true, std::memory_order_release);
    }
  }

  void stop_writer() noexcept {
    finish_.store(true, std::memory_order_release);
    if (thread_.joinable()) thread_.join();
  }

  void record(StepData& step) noexcept {
    if (step.age >= settings_.period || (queue_ && queue_->write_available() < row_length())) {
      step.outputs[0] =
          static_cast<double>(missing_rows_.fetch_add(1, std::memory_order_relaxed) + 1);
    } else if (queue_) {
      outgoing_[0] = step.time;
      std::copy(step.inputs.begin(), step.inputs.end(), outgoing_.begin() + 1);
      queue_->push(outgoing_.data(), row_length());
    } else {
      write_now(step);
    }
  }

  void write_now(const StepData& step) noexcept {
    try {
      writer_->append(from_seconds(step.time), step.inputs);
    } catch (const std::exception& error) {
      failure_ = error.what();
      failed_.store(true, std::memory_order_release);
    }
  }

  const memmap::Map map_;
  RecorderSettings settings_;
  std::vector<SignalId> signals_;
  std::optional<recording::Writer> writer_;
  std::unique_ptr<Queue> queue_;
  std::vector<double> outgoing_, incoming_;
  std::thread thread_;
  std::atomic<bool> finish_{false};
  std::atomic<bool> failed_{false};
  std::string failure_;
  std::atomic<std::uint64_t> missing_rows_{0};
  std::vector<SafetyLayer> safety_layers_;
  double stopped_at_ = -1, moved_at_ = -1;
};

}  // namespace

std::vector<Port> recorder_monitors() { return {{"lost_rows", Direction::Monitor, "1", 0, true}}; }

std::unique_ptr<Adapter> make_recorder(const memmap::Map& map, const RecorderSettings& settings) {
  return std::make_unique<Recorder>(map, settings);
}

using namespace experiment;

namespace {

constexpr double kRowPeriod = 1e-3;  // [s]
constexpr double kOverhang = 0.2;    // recorded after the other nodes came to rest [s]

std::unique_ptr<Adapter> make(const Experiment& setup, const NodeContext& context) {
  RecorderSettings settings;
  settings.file = context.recording;
  settings.info = {context.config, context.meta, {}};
  for (const auto& [node, period] : context.periods)
    settings.info.steps_per_row[node] = to_seconds(context.period) / to_seconds(period);
  settings.own_thread = !context.is_virtual;
  settings.period = to_seconds(context.period);
  settings.linger = setup.stop.retreat.hold + setup.stop.retreat.ramp + kOverhang;
  settings.longest = setup.stop.longest + 2 * kOverhang;
  return make_recorder(context.map, settings);
}

}  // namespace

NodeSettings read_recorder(const std::string& /*node*/, const Config& /*table*/,
                           const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Recorder;
  settings.schedule = schedule_of(kRowPeriod, 0.8 * kRowPeriod);
  settings.monitors = recorder_monitors;
  settings.make = make;
  return settings;
}

}  // namespace rths::adapters
