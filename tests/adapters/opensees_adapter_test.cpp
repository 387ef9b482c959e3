// SPDX-License-Identifier: Apache-2.0
// Sixteen elements of one OpenSees process, half of them over UDP, on one ring.
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/adapters/opensees.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths::adapters {
namespace {

constexpr int kCount = 16, kAnalysisSteps = 100, kFirstPort = 18'120;

std::string point(int i) { return fmt::format("p{}", i + 1); }
double stiffness(int i) { return 1e5 * (i + 1); }  // [N/m]

// A specimen for each element that reaches its target at once.
class Springs final : public Adapter {
 public:
  [[nodiscard]] std::vector<Port> ports() const override {
    std::vector<Port> ports{{"opf.newTarget", Direction::Input, "1", 0, false}};
    for (int i = 0; i < kCount; ++i)
      ports.push_back({"opf." + point(i) + ".displ.target", Direction::Input, "m", 0, false});
    for (int i = 0; i < kCount; ++i)
      ports.push_back({"daq." + point(i) + ".force.fbk", Direction::Output, "N", 0, false});
    ports.push_back({"daq.switchPC", Direction::Output, "1", 0, false});
    ports.push_back({"daq.atTarget", Direction::Output, "1", 0, false});
    return ports;
  }
  [[nodiscard]] Status step(StepData& step) noexcept override {
    const bool has_target = step.inputs[0] > 0;
    targets_ += has_target && !had_target_ ? 1 : 0;
    had_target_ = has_target;
    for (std::size_t i = 0; i < kCount; ++i)
      step.outputs[i] = stiffness(static_cast<int>(i)) * step.inputs[1 + i];
    step.outputs[kCount] = has_target ? 1 : 0;
    step.outputs[kCount + 1] = has_target ? 0 : 1;
    return Status::Ok;
  }
  [[nodiscard]] int targets() const { return targets_; }

 private:
  bool had_target_ = false;
  int targets_ = 0;
};

OpenSeesSettings settings_of(const test::TemporaryFolder& folder, const std::string& python) {
  OpenSeesSettings settings;
  settings.stops_time = true;
  for (int i = 0; i < kCount; ++i) {
    OpenSeesElement element;
    element.name = point(i);
    element.is_udp = i % 2 == 1;
    element.port = static_cast<std::uint16_t>(kFirstPort + i);
    element.is_rotation = {false};
    element.axes = {{point(i)}};
    settings.layout.commands.push_back(
        {"opf." + point(i) + ".displ.target", point(i), OpfQuantity::Displacement, "m"});
    settings.layout.feedbacks.push_back(
        {"daq." + point(i) + ".force.fbk", point(i), OpfQuantity::Force, "N"});
    element.initial_stiffness = SquareMatrix::diagonal(1, stiffness(i));
    element.damping = element.mass = SquareMatrix::diagonal(1, 0);
    settings.elements.push_back(element);
  }
  settings.script.command = {python, (test::source_tree() / "tests/opensees/many.py").string(),
                             std::to_string(kFirstPort), std::to_string(kCount),
                             std::to_string(kAnalysisSteps)};
  settings.script.log = folder.path() / "ring.log";
  return settings;
}

memmap::Map map_of(const std::vector<Port>& solver, const std::vector<Port>& springs) {
  memmap::MapDescription description;
  description.name = "sixteen";
  description.size_longwords = 1024;
  description.nodes = {{"opf", NodeId{1}, ""}, {"xpc", NodeId{2}, ""}};
  std::uint32_t next = 0;
  const auto add = [&](const std::string& partition, const std::string& node,
                       const std::vector<Port>& ports, Direction direction) {
    memmap::Partition p;
    p.name = partition;
    p.node = node;
    p.base = LongwordOffset{next};
    for (const auto& port : ports) {
      if (port.direction != direction) continue;
      memmap::Signal signal;
      // Except for a node's own monitors, a signal's name begins with that of its partition.
      signal.name = port.name.starts_with(partition + ".") ? port.name.substr(partition.size() + 1)
                                                           : port.name;
      signal.unit = port.unit;
      signal.offset = advance(p.base, p.longwords++);
      p.signals.push_back(signal);
    }
    next = (next + p.longwords + 15) / 16 * 16;
    description.partitions.push_back(p);
  };
  auto all = runner_ports();
  all.insert(all.end(), solver.begin(), solver.end());
  add("opf", "opf", solver, Direction::Output);
  add("daq", "xpc", springs, Direction::Output);
  add("monitor.opf", "opf", all, Direction::Monitor);
  add("monitor.xpc", "xpc", runner_ports(), Direction::Monitor);
  return memmap::Map{std::move(description)};
}

std::vector<std::vector<double>> rows_of(std::istream&& in) {
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words{line};
    std::vector<double> row;
    for (double value = 0; words >> value;) row.push_back(value);
    if (row.size() == kCount) rows.push_back(row);
  }
  return rows;
}

using OpenSeesAdapter = test::WithOpenSees<>;

TEST_F(OpenSeesAdapter, ServesSixteenElementsAtOnce) {
  const test::TemporaryFolder folder;
  const auto solver = make_opensees(settings_of(folder, python_));
  Springs springs;
  const auto map = map_of(solver->ports(), springs.ports());
  auto ring = broker::Ring::in_process(map);
  constexpr Duration kPeriod{1'000'000};
  AdapterRunner solving{*solver, ring, "opf", map.hash(), {kPeriod}};
  AdapterRunner moving{springs, ring, "xpc", map.hash(), {kPeriod}};
  solver->activate();
  Status status = Status::Ok;
  for (Duration time{0}; status == Status::Ok; time += kPeriod) {
    static_cast<void>(moving.tick(time, false, {}));
    status = solving.tick(time, false, {});
  }
  EXPECT_EQ(status, Status::Done) << solving.message();
  // One target per step, except for the first, without motion: trials of different updates never
  // mix.
  EXPECT_EQ(springs.targets(), kAnalysisSteps - 1);
  solver->deactivate();

  test::Running own{{python_, (test::source_tree() / "tests/opensees/many.py").string(), "inside",
                     std::to_string(kCount), std::to_string(kAnalysisSteps)}};
  const auto expected = rows_of(std::istringstream{own.wait(30).out});
  const auto found = rows_of(std::ifstream{folder.path() / "ring.log"});
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kAnalysisSteps));
  ASSERT_EQ(found.size(), expected.size());
  for (int i = 0; i < kCount; ++i) {
    double difference = 0, size = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const auto at = static_cast<std::size_t>(i);
      difference += std::pow(found[k][at] - expected[k][at], 2);
      size += std::pow(expected[k][at], 2);
    }
    EXPECT_LT(std::sqrt(difference / size), 1e-5) << point(i);  // float32 on the ring
  }
}

}  // namespace
}  // namespace rths::adapters
