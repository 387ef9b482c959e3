// SPDX-License-Identifier: Apache-2.0
//
// Times one step of each component of the loop. All of them share a controller tick of 1 ms.
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>
#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/ats.hpp>
#include <rths/controller/force_observer.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/target_force.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths {
namespace {

void predictor_corrector_substep(benchmark::State& state) {
  controller::PredictorCorrectorSettings settings;
  settings.axes = 2;
  controller::PredictorCorrector pc{settings};
  controller::Target target{Eigen::Vector2d{0.1, 0.2}, Eigen::Vector2d::Zero(),
                            Eigen::Vector2d::Zero()};
  int substep = 0;
  for (auto _ : state) {
    pc.substep(substep % 100 == 0, target);
    ++substep;
    benchmark::DoNotOptimize(pc.command().data());
  }
}
BENCHMARK(predictor_corrector_substep);

void ats_step(benchmark::State& state) {
  controller::Ats ats{controller::AtsSettings{}};
  double t = 0;
  for (auto _ : state) {
    t += 0.001;
    const double x = 0.1 * std::sin(t);
    benchmark::DoNotOptimize(
        ats.step({x, 0.1 * std::cos(t), -x}, 0.1 * std::sin(t - 0.05), 1, true));
  }
}
BENCHMARK(ats_step);

// Learns in every step, and solves in every fiftieth.
void adaptive_inverse_step(benchmark::State& state) {
  controller::AdaptiveInverse inverse{controller::AdaptiveInverseSettings{}};
  double t = 0;
  for (auto _ : state) {
    t += 0.001;
    benchmark::DoNotOptimize(
        inverse.step(0.1 * std::sin(t), 0.1 * std::sin(t - 0.01), 1e6 * std::sin(t), 1, true));
  }
}
BENCHMARK(adaptive_inverse_step);

// Two axes, fifteen sliders; learns in every step.
void target_force_step(benchmark::State& state) {
  controller::TargetForce force{controller::TargetForceSettings{}};
  double t = 0;
  for (auto _ : state) {
    t += 0.001;
    const double target[] = {0.1 * std::sin(t), 0.1 * std::cos(t)};
    const double measured[] = {0.1 * std::sin(t - 0.01), 0.1 * std::cos(t - 0.01)};
    const double acceleration[] = {-measured[0], -measured[1]};
    const double measured_force[] = {1e7 * measured[0], 1e7 * measured[1]};
    force.step({target, measured, acceleration, measured_force}, true);
    benchmark::DoNotOptimize(force.correction().data());
  }
}
BENCHMARK(target_force_step);

void force_observer_step(benchmark::State& state) {
  controller::ForceObserver observer{controller::unison_eqs_setup().long_axis, 0.001};
  double t = 0;
  for (auto _ : state) {
    t += 0.001;
    benchmark::DoNotOptimize(observer.step(0.1 * std::sin(t), -0.1 * std::sin(t), 1e5));
  }
}
BENCHMARK(force_observer_step);

void test_machine_step_1ms(benchmark::State& state) {
  constexpr double kAxialLoad = 9.7e6;  // [N]
  sim::TestMachine with_specimen = sim::srmd_machine();
  with_specimen.specimen = sim::read_bearing(Config::load(rths::find_bearing("lprb")), kAxialLoad);
  sim::TestMachineRun machine{with_specimen, 0.001};
  sim::MachineFeedback feedback;
  double t = 0;
  for (auto _ : state) {
    t += 0.001;
    benchmark::DoNotOptimize(machine.step({0.1 * std::sin(3 * t), 0}, kAxialLoad, feedback));
  }
}
BENCHMARK(test_machine_step_1ms);

void plant_integration_step(benchmark::State& state) {
  const sim::GroundMotion motion{0.01, std::vector<double>(1000, 1.0),
                                 std::vector<double>(1000, 1.0)};
  sim::PlantAnalysis analysis{sim::assemble(sim::example_plant()), motion, 3.58e8, 0.01, -0.05};
  for (auto _ : state) {
    const Eigen::Vector2d u = analysis.predict();
    analysis.correct(4e6 * u);
    benchmark::DoNotOptimize(u.data());
  }
}
BENCHMARK(plant_integration_step);

memmap::Map srmd_map() { return memmap::load_map(rths::find_map("srmd")); }

void ring_word_write(benchmark::State& state) {
  auto ring = broker::Ring::in_process(srmd_map());
  auto node = ring.join("opf", 0);
  std::uint32_t word = 0;
  for (auto _ : state) benchmark::DoNotOptimize(node.write(LongwordOffset{1025}, ++word));
}
BENCHMARK(ring_word_write);

void ring_group_write_48_words(benchmark::State& state) {
  auto ring = broker::Ring::in_process(srmd_map());
  auto node = ring.join("srmd", 0);
  const auto group = ring.tear_group("srmd");
  std::vector<std::uint32_t> words(48, 1);
  for (auto _ : state) benchmark::DoNotOptimize(node.write_group(group, words));
}
BENCHMARK(ring_group_write_48_words);

void ring_group_read_48_words(benchmark::State& state) {
  auto ring = broker::Ring::in_process(srmd_map());
  const auto node = ring.observe();
  const auto group = ring.tear_group("srmd");
  std::vector<std::uint32_t> words(48, 1);
  for (auto _ : state) benchmark::DoNotOptimize(node.read_group(group, words));
}
BENCHMARK(ring_group_read_48_words);

// A whole controller: ten predictor-corrector substeps, two compensators, two observers.
void controller_tick(benchmark::State& state, const char* diagram) {
  const auto target = adapters::make_simulink_like(rths::shared_files() / "diagrams" / diagram, {});
  std::vector<double> inputs;
  std::vector<double> outputs;
  for (const auto& port : target->ports()) {
    const bool is_input = port.direction == adapters::Direction::Input ||
                          port.direction == adapters::Direction::Parameter;
    (is_input ? inputs : outputs).push_back(port.initial);
  }
  adapters::StepData step;
  step.inputs = inputs;
  step.outputs = outputs;
  for (auto _ : state) {
    step.time += 0.001;
    inputs[0] = std::fmod(step.time, 0.01) < 0.003 ? 1 : 0;
    inputs[3] = 0.1 * std::sin(step.time);
    benchmark::DoNotOptimize(target->step(step));
  }
}
BENCHMARK_CAPTURE(controller_tick, hybrid, "hybrid_controller.toml")
    ->Name("hybrid_controller_tick");
BENCHMARK_CAPTURE(controller_tick, adaptive, "adaptive_controller.toml")
    ->Name("adaptive_controller_tick");

}  // namespace
}  // namespace rths

BENCHMARK_MAIN();
