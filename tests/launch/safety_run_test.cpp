// SPDX-License-Identifier: Apache-2.0
//
// The whole laboratory in virtual time, with faults of solver, controller and sensors. Whatever
// fails, no reference beyond a limit reaches the machine, and the run says why it ended.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/adapters/numerical.hpp>
#include <rths/adapters/safe_machine.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>
#include <rths/app/builtin_adapters.hpp>
#include <rths/controller/safety.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/lead_rubber.hpp"
#include "support/process.hpp"
#include "support/realtime_guard.hpp"

namespace rths::launch {
namespace {

using adapters::Adapter;
using adapters::Port;
using adapters::StepData;
using controller::SafetyCause;
using experiment::Experiment;
using experiment::NodeContext;
using experiment::NodeSettings;

/// Changes words of an adapter from a time on.
struct Fault {
  std::vector<std::string> words;  ///< inputs or outputs
  /// @param value  of the word   @param held  at the begin of the fault   @param since  then [s]
  std::function<double(double value, double held, double since)> change;
  double from = 0;  ///< [s]
};

/// An adapter with a fault in its words.
class Faulty final : public Adapter {
 public:
  Faulty(std::unique_ptr<Adapter> inner, Fault fault)
      : inner_{std::move(inner)}, fault_{std::move(fault)} {
    std::size_t inputs = 0, outputs = 0;
    for (const auto& port : inner_->ports()) {
      std::size_t& index = is_read(port) ? inputs : outputs;
      if (std::count(fault_.words.begin(), fault_.words.end(), port.name) > 0)
        (is_read(port) ? inputs_ : outputs_).push_back({index, std::nullopt});
      ++index;
    }
    if (inputs_.size() + outputs_.size() != fault_.words.size())
      throw Error{"the adapter lacks a word of the fault"};
    in_.resize(inputs);
    out_.resize(outputs);
  }
  [[nodiscard]] std::vector<Port> ports() const override { return inner_->ports(); }
  void activate() override { inner_->activate(); }
  void deactivate() override { inner_->deactivate(); }
  [[nodiscard]] Status step(StepData& step) noexcept override {
    if (!has_stepped_) std::copy(step.outputs.begin(), step.outputs.end(), out_.begin());
    has_stepped_ = true;
    std::copy(step.inputs.begin(), step.inputs.end(), in_.begin());
    apply(inputs_, in_, step.time);
    StepData inner = step;
    inner.inputs = in_;
    inner.outputs = out_;
    const Status status = inner_->step(inner);
    std::copy(out_.begin(), out_.end(), step.outputs.begin());
    apply(outputs_, step.outputs, step.time);
    step.message = inner.message;
    return status;
  }

 private:
  struct Word {
    std::size_t index;
    std::optional<double> held;
  };
  void apply(std::vector<Word>& words, std::span<double> values, double time) noexcept {
    if (time < fault_.from) return;
    for (auto& word : words) {
      if (!word.held) word.held = values[word.index];
      values[word.index] = fault_.change(values[word.index], *word.held, time - fault_.from);
    }
  }
  std::unique_ptr<Adapter> inner_;
  Fault fault_;
  std::vector<Word> inputs_, outputs_;
  std::vector<double> in_, out_;
  bool has_stepped_ = false;
};

/// The node that has the fault.
enum class Where { Nowhere, Solver, Controller, Sensors, Operator };
Where fault_where = Where::Nowhere;  // NOLINT: for the factories, which are plain functions
Fault fault;                         // NOLINT

NodeSettings with_fault(NodeSettings settings, Where here) {
  if (fault_where != here) return settings;
  settings.make = [make = settings.make](const Experiment& setup, const NodeContext& context) {
    return std::make_unique<Faulty>(make(setup, context), fault);
  };
  return settings;
}

NodeSettings read_machine(const std::string& node, const Config& table, const Experiment& setup) {
  return with_fault(
      adapters::with_safety(with_fault(adapters::read_srmd(node, Config{}, setup), Where::Sensors),
                            table.table_or_empty("safety"), setup),
      Where::Operator);
}
NodeSettings read_controller(const std::string& node, const Config& table,
                             const Experiment& setup) {
  return with_fault(adapters::read_simulink_like(node, table, setup), Where::Controller);
}
NodeSettings read_solver(const std::string& node, const Config& table, const Experiment& setup) {
  return with_fault(adapters::read_numerical(node, table, setup), Where::Solver);
}

/// A run of the example, and its recorded reference.
struct Recorded {
  RunOutcome outcome;
  std::vector<double> time, trip;
  std::array<std::vector<double>, 2> reference;  ///< as the machine received it [m]
  double trip_time = -1;                         ///< [s]; −1: none
  SafetyCause cause = SafetyCause::None;
};

constexpr double kRest = 0.3, kDuration = 7;  // [s]

Recorded run_with(Where where, Fault wanted, Overrides changes = {},
                  const std::function<Duration(const std::string&, Duration)>& lateness = {}) {
  fault_where = where;
  fault = std::move(wanted);
  std::vector<experiment::AdapterKind> factories(app::builtin_adapters().begin(),
                                                 app::builtin_adapters().end());
  for (auto& factory : factories) {
    const std::string name = factory.name;
    if (name == "srmd") factory.read = read_machine;
    if (name == "simulink_like") factory.read = read_controller;
    if (name == "numerical") factory.read = read_solver;
  }
  Overrides all{{"duration_s", std::to_string(kDuration)}, {"rest_s", std::to_string(kRest)}};
  all.insert(all.end(), changes.begin(), changes.end());
  const auto experiment =
      load_experiment(factories, test::source_tree() / "examples/srmd_lprb_2d_ats.toml", all);
  const test::TemporaryFolder folder;
  RunOptions options;
  options.clock = ClockKind::Virtual;
  options.recording = folder.path() / "run.h5";
  options.version = "test";
  options.lateness = lateness;
  Recorded recorded;
  recorded.outcome = run(experiment, options);
  const recording::Reader reader{options.recording};
  recorded.time = reader.time();
  if (reader.has("monitor.srmd.safety.trip"))
    recorded.trip = reader.signal("monitor.srmd.safety.trip");
  recorded.reference = {reader.signal("srmd.long.displ.ref_echo"),
                        reader.signal("srmd.lat.displ.ref_echo")};
  const auto first = std::find_if(recorded.trip.begin(), recorded.trip.end(),
                                  [](double value) { return value > 0; });
  if (first != recorded.trip.end()) {
    recorded.trip_time = recorded.time[static_cast<std::size_t>(first - recorded.trip.begin())];
    recorded.cause = static_cast<SafetyCause>(*first);
  }
  return recorded;
}

// Largest share of a limit that the recorded reference uses. Table 1 of the paper, and
// docs/safety.md.
double share_of_limits(const Recorded& recorded) {
  constexpr double kStroke[] = {1.22, 0.61}, kVelocity[] = {1.25 * 1.778, 1.25 * 0.762},
                   kAcceleration[] = {78, 38}, kJump[] = {0.08, 0.035};
  constexpr std::size_t kWindow = 40;
  constexpr double kTime = 0.04;
  double most = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto& r = recorded.reference[axis];
    for (std::size_t i = 2 * kWindow; i < r.size(); ++i) {
      const double velocity = (r[i] - r[i - kWindow]) / kTime;
      const double before = (r[i - kWindow] - r[i - 2 * kWindow]) / kTime;
      most = std::max({most, std::abs(r[i]) / kStroke[axis], std::abs(velocity) / kVelocity[axis],
                       std::abs(velocity - before) / kTime / kAcceleration[axis],
                       std::abs(r[i] - r[i - 1]) / kJump[axis]});
    }
  }
  return most;
}

// The words of the ring are single precision: 6e-8 of 48 inches in second differences.
constexpr double kRounding = 1e-4;

/// Checks what holds for every trip.
/// @param from  the layer could know the fault [s]
void expect_trip(const Recorded& recorded, SafetyCause cause, double from) {
  EXPECT_EQ(recorded.cause, cause) << recorded.outcome.trouble;
  EXPECT_LE(share_of_limits(recorded), 1 + kRounding);
  EXPECT_GE(recorded.trip_time, from - 0.0015);
  EXPECT_FALSE(recorded.outcome.completed);
  const std::string& line = recorded.outcome.trouble;
  EXPECT_EQ(line.rfind("srmd: safety trip at ", 0), 0U) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  // Every row of the two seconds before the trip, or since the begin, is in the recording.
  const double begin = std::max(0.0, recorded.trip_time - 2);
  const auto rows = std::count_if(recorded.time.begin(), recorded.time.end(), [&](double time) {
    return time >= begin - 1e-6 && time < recorded.trip_time - 1e-6;
  });
  EXPECT_NEAR(static_cast<double>(rows), 1000 * (recorded.trip_time - begin), 1);
  // The machine came to rest, and the recording shows it.
  EXPECT_GT(recorded.time.back(),
            recorded.trip_time + (cause == SafetyCause::FirstCommand ? 0 : 1.2));
  for (const auto& reference : recorded.reference) EXPECT_EQ(reference.back(), 0);
}

constexpr double kStrong = 6.8;                          // both axes beyond 50 mm [s]
constexpr double kInRest = 0.15;                         // before the first target [s]
constexpr double kInRampDown = kRest + kDuration + 0.6;  // [s]
constexpr double kTwoTicks = 0.0021;

// The specimen under its load, on a host that is busy at the start: controller and solver have
// stepped before the machine has measured anything.
TEST(SafetyRun, StartsThoughTheFirstStepOfTheMachineIsLate) {
  const auto experiment =
      load_experiment(app::builtin_adapters(), test::source_tree() / "examples/srmd_platen_2d.toml",
                      {{"duration_s", "1"}, {"rest_s", "0.1"}});
  const test::TemporaryFolder folder;
  RunOptions options;
  options.clock = ClockKind::Virtual;
  options.recording = folder.path() / "run.h5";
  options.version = "test";
  options.lateness = [](const std::string& node, Duration time) {
    return from_seconds(node == "srmd" && time == Duration::zero() ? 0.0015 : 0);
  };

  const RunOutcome outcome = run(experiment, options);

  EXPECT_TRUE(outcome.completed) << outcome.trouble;
}

TEST(SafetyRun, PassesTheCommandOfTheExampleUnchanged) {
  const Recorded guarded = run_with(Where::Nowhere, {});
  fault_where = Where::Nowhere;
  const test::TemporaryFolder folder;
  const auto experiment =
      app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d_ats.toml",
                           {{"duration_s", std::to_string(kDuration)},
                            {"rest_s", std::to_string(kRest)},
                            {"node.srmd.safety.enabled", "false"}});
  RunOptions options;
  options.clock = ClockKind::Virtual;
  options.recording = folder.path() / "run.h5";
  ASSERT_TRUE(run(experiment, options).completed);
  const recording::Reader bare{options.recording};
  const auto reference = bare.signal("srmd.lat.displ.ref_echo");

  EXPECT_TRUE(guarded.outcome.completed) << guarded.outcome.trouble;
  EXPECT_EQ(guarded.cause, SafetyCause::None);
  EXPECT_LE(share_of_limits(guarded), 1);
  // Up to the end of the test; the stop then brakes.
  for (std::size_t i = 0; i < static_cast<std::size_t>(1000 * (kRest + kDuration)); ++i)
    ASSERT_EQ(guarded.reference[1][i], reference[i]) << i;
}

TEST(SafetyRun, EndsATestWithFourTimesTheMotion) {
  const Recorded recorded = run_with(Where::Nowhere, {}, {{"motion.scale", "5.6"}});

  expect_trip(recorded, recorded.cause, kRest);
  EXPECT_NE(recorded.cause, SafetyCause::None);
}

// The limits are those of this test: without the layer, the same motion exceeds them.
TEST(SafetyRun, ExceedsTheLimitsWithoutTheLayer) {
  const Recorded recorded = run_with(
      Where::Nowhere, {}, {{"motion.scale", "5.6"}, {"node.srmd.safety.enabled", "false"}});

  EXPECT_GT(share_of_limits(recorded), 1.2);
}

// ±2 inches are 50.8 mm.
TEST(SafetyRun, TakesTheRangeOfTheMap) {
  const test::TemporaryFolder folder;
  std::string map = test::content_of(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
  const std::string reference = "name = \"displ.ref\"\nindex = [\"long\", \"lat\", \"vert\"]\n";
  ASSERT_NE(map.find(reference), std::string::npos);
  map.insert(map.find(reference) + reference.size(), "range = [-2, 2]\n");
  const auto file = folder.write("narrow.ringmap.toml", map);

  const Recorded recorded = run_with(Where::Nowhere, {}, {{"map", '"' + file.string() + '"'}});

  expect_trip(recorded, SafetyCause::CommandDisplacement, kRest);
  for (const auto& axis : recorded.reference)
    for (const double value : axis) ASSERT_LE(std::abs(value), 0.0508 + 1e-8);
}

TEST(SafetyRun, RefusesWrongKeys) {
  const auto error = [](const char* key, const char* value) {
    return test::error_of([&] {
      static_cast<void>(app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml",
                                             {{std::string{"node.srmd.safety."} + key, value}}));
    });
  };

  EXPECT_EQ(error("velocity_m_per_s", "[1]"),
            "--set node.srmd.safety.velocity_m_per_s: velocity_m_per_s has 1 numbers, expected "
            "[long, lat] or [long, lat, vert]");
  EXPECT_EQ(error("velocty_m_per_s", "[1, 1]"),
            "--set node.srmd.safety.velocty_m_per_s: unknown key 'velocty_m_per_s' (did you mean "
            "'velocity_m_per_s'?)");
  EXPECT_EQ(error("braking_m_per_s2", "[100, 100]"),
            "--set node.srmd.safety.braking_m_per_s2: safety: braking is 100, expected at most the "
            "limit of acceleration");
  EXPECT_EQ(error("force_N", "[-1, 1]"),
            "--set node.srmd.safety.force_N: force_N is -1, expected a positive number");
}

TEST(SafetyRun, TripsOnNaNFromTheSolver) {
  for (const double from : {kInRest, kStrong}) {
    const Recorded recorded =
        run_with(Where::Solver,
                 {{"opf.long.displ.target"},
                  [](double, double, double) { return std::numeric_limits<double>::quiet_NaN(); },
                  from});
    expect_trip(recorded, SafetyCause::NodeInvalid, from);
    EXPECT_LE(recorded.trip_time, from + kTwoTicks);
  }
}

TEST(SafetyRun, TripsOnAStuckDisplacement) {
  const auto hold = [](double, double held, double) { return held; };
  const Recorded recorded = run_with(Where::Sensors, {{"srmd.lat.displ.fbk"}, hold, kStrong});
  expect_trip(recorded, recorded.cause, kStrong);
  EXPECT_TRUE(recorded.cause == SafetyCause::FeedbackStuck) << recorded.outcome.trouble;
  EXPECT_LE(recorded.trip_time, kStrong + 0.020);

  // At rest a stuck displacement is that of a platen at rest: it trips when the platen has to move.
  const Recorded at_rest = run_with(Where::Sensors, {{"srmd.lat.displ.fbk"}, hold, kInRest});
  expect_trip(at_rest, SafetyCause::FeedbackStuck, kRest);
}

TEST(SafetyRun, TripsOnAFlippedForce) {
  const auto flip = [](double value, double, double) { return -value; };
  const std::vector<std::string> words{"srmd.long.force.fbk"};
  const Recorded strong = run_with(Where::Sensors, {words, flip, kStrong});
  expect_trip(strong, SafetyCause::ForceJump, kStrong);
  EXPECT_LE(strong.trip_time, kStrong + kTwoTicks);

  const Recorded from_rest = run_with(Where::Sensors, {words, flip, kInRest});
  expect_trip(from_rest, SafetyCause::ForceSign, kRest);
}

TEST(SafetyRun, EndsAnUnstableLoop) {
  // Three times the gain of the loop, from the begin and in strong motion.
  const auto gain = [](double value, double, double since) {
    return value * std::min(3.0, 1 + 20 * since);
  };
  const std::vector<std::string> words{"xpc.long.displ.ref", "xpc.lat.displ.ref"};
  for (const double from : {kInRest, kStrong}) {
    const Recorded recorded = run_with(Where::Controller, {words, gain, from});
    expect_trip(recorded, recorded.cause, from);
    EXPECT_NE(recorded.cause, SafetyCause::None);
  }
}

TEST(SafetyRun, TripsOnAFrozenNode) {
  const double watchdog = 0.05;
  for (const std::string frozen : {"xpc", "opf"})
    for (const double from : {kInRest, kStrong}) {
      const Recorded recorded =
          run_with(Where::Nowhere, {}, {{"node.srmd.safety.watchdog_s", "0.05"}},
                   [&](const std::string& node, Duration due) {
                     const bool is_frozen =
                         node == frozen && to_seconds(due) >= from && to_seconds(due) < from + 0.01;
                     return is_frozen ? from_seconds(0.5) : Duration{0};
                   });
      expect_trip(recorded, SafetyCause::NodeSilent, from + watchdog);
      EXPECT_LE(recorded.trip_time, from + watchdog + kTwoTicks) << frozen;
      EXPECT_NE(recorded.outcome.trouble.find(frozen + ": silence is"), std::string::npos);
    }
}

TEST(SafetyRun, RefusesToStartFarFromThePlaten) {
  const Recorded recorded = run_with(
      Where::Sensors,
      {{"srmd.long.displ.fbk"}, [](double value, double, double) { return value + 0.1; }, 0});

  expect_trip(recorded, SafetyCause::FirstCommand, 0);
  EXPECT_LE(recorded.trip_time, 0.003);
  for (const auto& reference : recorded.reference)
    for (const double value : reference) ASSERT_EQ(value, 0);
}

TEST(SafetyRun, StopsForTheOperatorWithoutAJump) {
  for (const double from : {kInRest, kStrong}) {
    const Recorded recorded = run_with(
        Where::Operator, {{"safety.stop"}, [](double, double, double) { return 1.0; }, from});

    EXPECT_EQ(recorded.outcome.trouble.rfind("srmd: stopped by the operator at ", 0), 0U)
        << recorded.outcome.trouble;
    EXPECT_FALSE(recorded.outcome.completed);
    EXPECT_EQ(recorded.cause, SafetyCause::None);
    EXPECT_LE(share_of_limits(recorded), 1 + kRounding);
    for (const auto& reference : recorded.reference) EXPECT_EQ(reference.back(), 0);
  }
}

// The reference of the ramp-down does not depend on other nodes or on feedback.
TEST(SafetyRun, RampsDownWhateverFails) {
  const auto nan = [](double, double, double) { return std::numeric_limits<double>::quiet_NaN(); };
  const auto flip = [](double value, double, double) { return -value; };
  const auto hold = [](double, double held, double) { return held; };
  const Recorded good = run_with(Where::Nowhere, {});
  const std::pair<Where, Fault> faults[] = {
      {Where::Solver, {{"opf.long.displ.target"}, nan, kInRampDown}},
      {Where::Controller,
       {{"xpc.long.displ.ref"}, [](double, double, double) { return 3.0; }, kInRampDown}},
      {Where::Sensors, {{"srmd.lat.displ.fbk"}, hold, kInRampDown}},
      {Where::Sensors, {{"srmd.long.force.fbk"}, flip, kInRampDown}},
      {Where::Operator, {{"safety.stop"}, [](double, double, double) { return 1.0; }, kInRampDown}},
  };
  for (const auto& [where, wanted] : faults) {
    const Recorded recorded = run_with(where, wanted);
    EXPECT_EQ(recorded.reference, good.reference) << wanted.words[0];
  }
}

// A trip formats its line inside the step.
TEST(SafeMachine, IsRealTimeWhileItTrips) {
  adapters::SrmdSettings machine;
  machine.machine = sim::srmd_machine();
  machine.machine.specimen = test::plain_lead_rubber();
  adapters::SafeMachineSettings settings;
  settings.safety.axes.resize(1);
  settings.safety.axes[0].jump = 0.01;
  settings.axes = {{"long", "xpc.long.displ.ref", "srmd.long.displ.fbk", "srmd.long.force.fbk"}};
  settings.nodes = {"xpc"};
  const auto first = adapters::make_safe_machine(adapters::make_srmd(machine), settings);
  const auto second = adapters::make_safe_machine(adapters::make_srmd(machine), settings);
  test::Bench benches[] = {test::Bench{*first}, test::Bench{*second}};
  std::size_t turn = 0;
  const auto trip = [](test::Bench& bench, double* count, double* reference) {
    for (int i = 0; i < 10; ++i) {
      *count = i + 1;
      static_cast<void>(bench.step(1e-3 * i));
    }
    *reference = 0.02;
    static_cast<void>(bench.step(0.01));
  };

  double* counts[] = {&benches[0].in("monitor.xpc.host.step"),
                      &benches[1].in("monitor.xpc.host.step")};
  double* references[] = {&benches[0].in("xpc.long.displ.ref"),
                          &benches[1].in("xpc.long.displ.ref")};

  EXPECT_REALTIME({
    trip(benches[turn], counts[turn], references[turn]);
    ++turn;
  });

  EXPECT_STREQ(benches[1].message(),
               "safety trip at 0.010 s: long: jump of the command is 0.02 m, expected at most "
               "0.01 m");
}

TEST(SafetyRun, HasOneLineAReportAndAnExitCode) {
  const test::TemporaryFolder folder;
  const auto run =
      test::run_rths({"run", (test::source_tree() / "examples/srmd_lprb_2d.toml").string(),
                      "--clock", "virtual", "--no-diagnosis", "--set", "motion.scale=5.6", "--set",
                      "uncompensated={}", "--set", "held_out={}", "--out", folder.path().string()});

  EXPECT_EQ(run.exit_code, 2);
  const std::string begin = "rths: the run ended early: srmd: safety trip at ";
  EXPECT_EQ(run.err.rfind(begin, 0), 0U) << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
  const auto numbers = nlohmann::json::parse(test::content_of(folder.path() / "report.json"));
  EXPECT_EQ(numbers["conclusive"], false);
  const auto& changes = numbers["safety"];
  const auto trip = std::find_if(changes.begin(), changes.end(),
                                 [](const auto& change) { return change["state"] == "trip"; });
  ASSERT_NE(trip, changes.end());
  EXPECT_EQ((*std::next(trip))["state"], "hold");
  EXPECT_EQ(changes.back()["state"], "tripped");
  EXPECT_TRUE(test::breaks(numbers, "safety")) << numbers["broken"];
  EXPECT_NE(test::content_of(folder.path() / "report.html").find("safety-section"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::launch
