// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/replay.hpp>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/units.hpp>
#include <rths/plugin/plugin_node.hpp>
#include <rths/recording/roles.hpp>

namespace rths::adapters {
namespace {

constexpr double kLongestEnd = 1.9;  // after it is asked to stop [s]
constexpr Duration kTick = std::chrono::milliseconds{1};
constexpr double kRounding = 1e-9;  // of a time, also after an hour [s]

class Replay final : public Adapter {
 public:
  /// @param run  kept as long as this adapter; null: the words have a map that lasts
  Replay(ReplaySettings settings, std::shared_ptr<const recording::Reader> run)
      : settings_{std::move(settings)}, run_{std::move(run)} {
    for (const auto& word : settings_.words) codecs_.emplace_back(*word.entry.signal);
  }

  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports;
    for (const auto& [entry, words] : settings_.words) {
      const auto& signal = *entry.signal;
      const bool is_monitor = entry.partition->name.starts_with("monitor.");
      ports.push_back({is_monitor ? signal.name : entry.name,
                       is_monitor ? Direction::Monitor : Direction::Output,
                       memmap::parse_unit(signal.unit).si, 0, is_monitor && signal.event});
    }
    return ports;
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    const Schedule& schedule = settings_.schedule;
    const double now = to_seconds(schedule.phase + steps_++ * schedule.period);
    const auto& time = settings_.time;
    while (row_ < time.size() && time[row_] < now - kRounding) ++row_;
    if (row_ == time.size()) return Status::Done;
    for (std::size_t i = 0; i < codecs_.size(); ++i)
      step.outputs[i] = codecs_[i].decode(settings_.words[i].words[row_]);
    if (step.stopping && stopped_at_ < 0) stopped_at_ = step.time;
    return step.stopping && step.time - stopped_at_ >= kLongestEnd ? Status::Done : Status::Ok;
  }

 private:
  ReplaySettings settings_;
  std::shared_ptr<const recording::Reader> run_;
  std::vector<memmap::Codec> codecs_;
  std::size_t row_ = 0;
  Duration::rep steps_ = 0;
  double stopped_at_ = -1;
};

}  // namespace

std::unique_ptr<Adapter> make_replay(ReplaySettings settings) {
  return std::make_unique<Replay>(std::move(settings), nullptr);
}

using namespace experiment;

namespace {

// The words of the laboratory's map and the monitors of the node, without those of its runner,
// which this node writes itself.
bool is_replayed(const memmap::SignalEntry& entry, const std::string& node) {
  const std::string& partition = entry.partition->name;
  if (partition == "monitor." + node) return !entry.signal->name.starts_with("host.");
  return !partition.starts_with("monitor.") && !partition.starts_with("tune.");
}

// The keys of an experiment that the recorded solver read have the effect that is recorded.
SolverTraits traits_of(const recording::Reader& run, const std::string& node) {
  SolverTraits traits;
  const auto experiment = recording::recorded_experiment(run);
  const Config table =
      experiment ? experiment->table_or_empty("node").table_or_empty(node) : Config{};
  traits.integrates_plant = traits.has_computing_time = table.text("adapter", "") == "numerical";
  return traits;
}

}  // namespace

NodeSettings read_replay(const std::string& node, const Config& table,
                         const Experiment& /*setup*/) {
  NodeSettings settings = plugin::read_role(table);
  // The recorded machine had these parameters.
  if (settings.role == Role::Machine) settings.machine_table = MachineTable::Whole;
  // Its time can wait for a late controller, as that of a simulated machine.
  if (settings.role != Role::Controller && !table.has("late_inputs"))
    settings.schedule.missed = MissedSteps::Wait;
  // A step for each tick of the controller, which reads nothing between them.
  if (settings.role == Role::Solver) settings.schedule.period = kTick;
  const auto file = table.resolve(table.text("recording"));
  const std::string recorded = table.text("of_node", node);
  const auto run = table.placed("recording", [&] {
    return recording::of_file(file, [&] { return std::make_shared<recording::Reader>(file); });
  });
  static_cast<void>(table.placed("of_node", [&] { return run->map().node(recorded); }));
  if (settings.role == Role::Solver) settings.solver = traits_of(*run, recorded);
  std::vector<recording::MessageFault> faults;
  for (const auto& fault : table.tables("fault")) {
    faults.push_back(recording::read_message_fault(fault, run->map()));
    if (faults.back().node != recorded)
      fault.fail("node", fmt::format("found the words of node '{}', expected those of '{}'",
                                     faults.back().node, recorded));
  }
  settings.make = [=](const Experiment& test, const NodeContext&) {
    ReplaySettings replay{
        run->time(), recording::of_file(file, [&] { return recording::words_of(*run, recorded); }),
        test.node(node)->schedule};
    for (const auto& fault : faults) recording::apply(fault, replay.time, replay.words);
    std::erase_if(replay.words,
                  [&](const auto& word) { return !is_replayed(word.entry, recorded); });
    // The entries of the words point into the map of the run.
    return std::make_unique<Replay>(std::move(replay), run);
  };
  return settings;
}

}  // namespace rths::adapters
