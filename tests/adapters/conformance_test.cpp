// SPDX-License-Identifier: Apache-2.0
// Requirements on every adapter.
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include <rths/adapters/numerical.hpp>
#include <rths/adapters/recorder.hpp>
#include <rths/adapters/replay.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>

#include "sim/machine/srmd_file.hpp"
#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/lead_rubber.hpp"
#include "support/realtime_guard.hpp"

namespace rths::adapters {
namespace {

std::unique_ptr<Adapter> make_sample_numerical() {
  NumericalSettings settings;
  settings.structure = std::make_shared<sim::StickModel>(sim::example_plant());
  settings.motion = {0.01, std::vector<double>(500, 1.0), std::vector<double>(500, 0.5)};
  settings.bearing_initial_stiffness = test::kInitialStiffness;
  return make_numerical(settings);
}

std::unique_ptr<Adapter> make_sample_recorder() {
  static const test::TemporaryFolder folder;
  RecorderSettings settings;
  settings.file = folder.path() / "run.h5";
  return make_recorder(memmap::load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml"),
                       settings);
}

// A recorded machine at rest, for 10 s.
std::unique_ptr<Adapter> make_sample_replay() {
  static const memmap::Map map =
      memmap::load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
  ReplaySettings settings;
  for (int i = 0; i < 10'000; ++i) settings.time.push_back(0.001 * i);
  const std::vector<std::uint32_t> words(settings.time.size());
  settings.words = {{map.entry(map.signal("srmd.long.displ.fbk")), words}};
  return make_replay(settings);
}

struct Candidate {
  const char* name;
  std::function<std::unique_ptr<Adapter>()> make;
  friend std::ostream& operator<<(std::ostream& out, const Candidate& c) { return out << c.name; }
};

class EveryAdapter : public ::testing::TestWithParam<Candidate> {
 protected:
  void SetUp() override {
    adapter = GetParam().make();
    adapter->activate();
  }
  void TearDown() override { adapter->deactivate(); }
  std::unique_ptr<Adapter> adapter;
};

TEST_P(EveryAdapter, ListsTheSamePortsEveryTimeAndNoneTwice) {
  const auto first = adapter->ports();
  const auto second = adapter->ports();

  std::set<std::string> names;
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].name, second[i].name);
    EXPECT_TRUE(names.insert(first[i].name).second) << first[i].name;
  }
  EXPECT_FALSE(first.empty());
}

TEST_P(EveryAdapter, StepsInRealTime) {
  test::Bench bench{*adapter};
  Status status = Status::Ok;
  for (int i = 0; i < 20; ++i) EXPECT_REALTIME(status = bench.step(0.001 * i));
  EXPECT_NE(status, Status::Fault);
}

TEST_P(EveryAdapter, ComesToRestWithinTwoSecondsOfTheStop) {
  test::Bench bench{*adapter};
  double time = 0;
  for (int i = 0; i < 100; ++i) static_cast<void>(bench.step(time += 0.001));
  const double stop = time;
  Status status = Status::Ok;
  while (status != Status::Done && time < stop + 5) status = bench.step(time += 0.001, true);

  EXPECT_EQ(status, Status::Done);
  EXPECT_LT(time - stop, 2);
}

INSTANTIATE_TEST_SUITE_P(
    BuiltIn, EveryAdapter,
    ::testing::Values(Candidate{"numerical", make_sample_numerical},
                      Candidate{"recorder", make_sample_recorder},
                      Candidate{"replay", make_sample_replay},
                      Candidate{"simulink_like",
                                [] {
                                  return make_simulink_like(
                                      test::source_tree() /
                                          "adapters/simulink_like/diagrams/hybrid_controller.toml",
                                      {});
                                }},
                      Candidate{"srmd",
                                [] {
                                  SrmdSettings settings;
                                  settings.machine = sim::srmd_machine();
                                  return make_srmd(settings);
                                }},
                      Candidate{"srmd_platen",
                                [] {
                                  SrmdPlatenSettings settings;
                                  settings.machine = test::srmd_machine_with_bearing();
                                  return make_srmd_platen(settings);
                                }}),
    [](const auto& candidate) { return std::string{candidate.param.name}; });

}  // namespace
}  // namespace rths::adapters
