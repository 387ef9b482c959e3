// SPDX-License-Identifier: Apache-2.0
#include "faulty_laboratory.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <rths/app/builtin_adapters.hpp>
#include <rths/recording/recording.hpp>

#include "launch/src/run_modes.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

using adapters::Adapter;
using adapters::Direction;
using adapters::Port;
using adapters::StepData;

/// A machine whose words are faulty on their way.
class FaultyMachine final : public Adapter {
 public:
  FaultyMachine(std::unique_ptr<Adapter> machine, const std::vector<Fault>& faults, double from)
      : machine_{std::move(machine)}, from_{from} {
    for (const auto& port : machine_->ports())
      (port.direction == Direction::Input || port.direction == Direction::Parameter ? names_in_
                                                                                    : names_out_)
          .push_back(port.name);
    inputs_.resize(names_in_.size());
    outputs_.resize(names_out_.size());
    for (const auto& fault : faults) {
      const auto& names = fault.word.starts_with("xpc.") ? names_in_ : names_out_;
      const auto at = index(names, fault.word);
      const auto other = fault.other_word.empty() ? at : index(names, fault.other_word);
      (&names == &names_in_ ? on_inputs_ : on_outputs_).push_back({fault, at, other});
    }
  }

  [[nodiscard]] std::vector<Port> ports() const override { return machine_->ports(); }
  void activate() override { machine_->activate(); }
  void deactivate() override { machine_->deactivate(); }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    std::copy(step.inputs.begin(), step.inputs.end(), inputs_.begin());
    apply(on_inputs_, inputs_, step.time);
    StepData inner = step;
    inner.inputs = inputs_;
    inner.outputs = outputs_;
    const Status status = machine_->step(inner);
    std::copy(outputs_.begin(), outputs_.end(), step.outputs.begin());
    apply(on_outputs_, step.outputs, step.time);
    step.message = inner.message;
    return status;
  }

 private:
  struct Wired {
    Fault fault;
    std::size_t at, other;
  };
  static std::size_t index(const std::vector<std::string>& names, const std::string& word) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) throw Error{"the machine has no word '" + word + "'"};
    return static_cast<std::size_t>(found - names.begin());
  }
  void apply(const std::vector<Wired>& faults, std::span<double> values, double time) noexcept {
    if (time < from_) return;
    const std::vector<double> before{values.begin(), values.end()};
    for (const auto& wired : faults)
      values[wired.at] = wired.fault.change(before[wired.at], before[wired.other], time - from_);
  }

  std::unique_ptr<Adapter> machine_;
  double from_;
  std::vector<std::string> names_in_, names_out_;
  std::vector<Wired> on_inputs_, on_outputs_;
  std::vector<double> inputs_, outputs_;
};

}  // namespace

experiment::Experiment short_experiment(const std::string& example,
                                        const experiment::Overrides& changes) {
  experiment::Overrides all{
      {"duration_s", "12"}, {"rest_s", "0.5"}, {"node.srmd.safety.enabled", "false"}};
  all.insert(all.end(), changes.begin(), changes.end());
  return app::load_experiment(test::source_tree() / "examples" / (example + ".toml"), all);
}

void run_with(const experiment::Experiment& experiment, const std::vector<Fault>& faults,
              double from, const std::filesystem::path& recording) {
  auto assembly = launch::assemble(
      experiment, launch::ClockKind::Virtual,
      {recording, launch::describe_run(experiment, launch::ClockKind::Virtual, "test"),
       experiment.texts()});
  for (auto& station : assembly.stations)
    if (station.plan.adapter == "srmd")
      station.adapter = std::make_unique<FaultyMachine>(std::move(station.adapter), faults, from);
  const auto run = launch::run_in_virtual_time(experiment, assembly, {});
  if (run.trouble.empty()) recording::add_meta(recording, {{"ending", "completed"}});
}

std::vector<Broken> judge_with(const experiment::Experiment& experiment,
                               const std::vector<Fault>& faults, double from) {
  const test::TemporaryFolder folder;
  run_with(experiment, faults, from, folder.path() / "run.h5");
  return judge(recording::Reader{folder.path() / "run.h5"});
}

void copy(const std::filesystem::path& from, const std::filesystem::path& to,
          const std::function<bool(double time, Row& row)>& edit) {
  const recording::Reader reader{from};
  recording::RecordingInfo info;
  const auto meta = reader.meta();
  info.meta.assign(meta.begin(), meta.end());
  for (const auto& text : {meta.at("experiment"), std::string{recording::kOverridesText},
                           std::string{recording::kSpecimenText}})
    info.config.emplace_back(text, reader.config(text));
  for (const auto& [node, drops] : reader.drops()) {
    static_cast<void>(drops);
    info.steps_per_row[node] = node == "opf" ? 4 : 1;
  }
  std::vector<SignalId> signals;
  std::vector<std::vector<double>> columns;
  const auto names = reader.names();
  for (const auto& name : names) {
    signals.push_back(reader.map().signal(name));
    columns.push_back(reader.signal(name));
  }
  recording::Writer writer{to, reader.map(), signals, info};
  std::vector<double> values(names.size());
  for (std::size_t i = 0; i < reader.rows(); ++i) {
    Row row;
    for (std::size_t c = 0; c < names.size(); ++c) row[names[c]] = columns[c][i];
    if (!edit(reader.time()[i], row)) continue;
    for (std::size_t c = 0; c < names.size(); ++c) values[c] = row.at(names[c]);
    writer.append(from_seconds(reader.time()[i]), values);
  }
  writer.close();
}

}  // namespace rths::report
