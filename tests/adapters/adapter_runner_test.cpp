// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/broker/follow.hpp>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"
#include "support/ring_maps.hpp"

namespace rths::adapters {
namespace {

using std::chrono::milliseconds;

std::string bench_map() {
  std::string map = R"(
ringmap = 1
[ring]
name = "bench"
version = 1
size_bytes = 4096
[nodes]
echo = 1
sender = 2
operator = 3
[[partition]]
name = "sender"
node = "sender"
offset = 0
longwords = 2
tear_group = true
[[partition.signal]]
name = "displ"
offset = 1
type = "f32"
unit = "mm"
[[partition]]
name = "echo"
node = "echo"
offset = 16
longwords = 2
[[partition.signal]]
name = "displ"
offset = 16
type = "f32"
unit = "inch"
[[partition]]
name = "tune.echo"
node = "operator"
offset = 64
longwords = 1
[[partition.signal]]
name = "gain"
offset = 64
type = "f32"
initial = 3
[[partition]]
name = "monitor.echo"
node = "echo"
offset = 32
longwords = 16
tear_group = true
[[partition.signal]]
name = "twice"
offset = 47
type = "f32"
unit = "m"
)";
  int offset = 32;
  for (const auto& port : runner_ports())
    map += "[[partition.signal]]\nname = \"" + port.name +
           "\"\noffset = " + std::to_string(offset++) + "\ntype = \"f32\"\nunit = \"" + port.unit +
           "\"\n";
  return map;
}

/// Returns its input times its gain.
class Echo final : public Adapter {
 public:
  std::vector<Port> list = {{"sender.displ", Direction::Input, "m", 0, false},
                            {"gain", Direction::Parameter, "1", 3, false, {{0, 100.3}}},
                            {"echo.displ", Direction::Output, "m", 0, false},
                            {"twice", Direction::Monitor, "m", 0, false}};
  Status result = Status::Ok;
  int steps = 0;
  int ends_after = 0;
  bool poisoned = false;
  const char* request = "";
  double input = 0;   ///< of the last step [m]
  double oldest = 0;  ///< largest age of its inputs [s]

  [[nodiscard]] std::vector<Port> ports() const override { return list; }
  [[nodiscard]] Status step(StepData& step) noexcept override {
    ++steps;
    input = step.inputs[0];
    oldest = std::max(oldest, step.age);
    step.outputs[0] = poisoned ? std::nan("") : step.inputs[0] * step.inputs[1];
    step.outputs[1] = 2 * step.inputs[0];
    step.message = request;
    if (step.stopping || (ends_after > 0 && steps >= ends_after)) return Status::Done;
    return result;
  }
};

class AdapterRunnerTest : public ::testing::Test {
 protected:
  explicit AdapterRunnerTest(MissedSteps missed = MissedSteps::Make)
      : runner{echo, ring, "echo", map.hash(), {milliseconds{1}, Duration{0}, missed}} {}

  memmap::Map map = memmap::parse_map(bench_map(), "bench");
  broker::Ring ring = broker::Ring::in_process(map);
  broker::Node sender = ring.join("sender", 0);
  Echo echo;
  AdapterRunner runner;

  void send(double displacement) {
    const auto& entry = map.entry(map.signal("sender.displ"));
    const std::uint32_t words[2] = {0, memmap::Codec{*entry.signal}.encode(displacement)};
    ASSERT_EQ(sender.write_group(ring.tear_group("sender"), words), Status::Ok);
  }
  void tune_gain(double gain) {
    broker::Node hand = ring.join("operator", 0);
    const auto& signal = *map.entry(map.signal("tune.echo.gain")).signal;
    ASSERT_EQ(hand.write(signal.offset, memmap::Codec{signal}.encode(gain)), Status::Ok);
  }
  [[nodiscard]] double value(const std::string& name) const {
    const auto& entry = map.entry(map.signal(name));
    return memmap::Codec{*entry.signal}.decode(sender.read(entry.signal->offset));
  }
};

TEST_F(AdapterRunnerTest, ConvertsUnitsOnTheWayInAndOut) {
  send(0.0254);

  ASSERT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);

  EXPECT_NEAR(value("echo.displ"), 3 * 0.0254, 1e-8);
  EXPECT_NEAR(value("monitor.echo.twice"), 2 * 0.0254, 1e-8);
}

TEST_F(AdapterRunnerTest, ReadsParametersThatAreTunedWhileItRuns) {
  tune_gain(5);
  send(0.1);

  static_cast<void>(runner.tick(Duration{0}, false, {}));

  EXPECT_NEAR(value("echo.displ"), 0.5, 1e-6);
}

TEST_F(AdapterRunnerTest, WritesItsOwnMonitors) {
  echo.result = Status::LimitExceeded;
  static_cast<void>(runner.tick(Duration{0}, false, {Duration{20'000}, milliseconds{2}}));
  static_cast<void>(runner.tick(Duration{0}, false, {}));

  EXPECT_EQ(value("monitor.echo.host.step"), 2);
  EXPECT_EQ(value("monitor.echo.host.status"), static_cast<double>(Status::LimitExceeded));
  EXPECT_EQ(value("monitor.echo.host.overruns"), 1);
  EXPECT_EQ(value("monitor.echo.host.late"), 0);
  EXPECT_NEAR(value("monitor.echo.host.late_max"), 20e-6, 1e-12);
  EXPECT_EQ(runner.overruns(), 1U);
}

// On cards, words go out one by one: no node waits for a word behind the monitors.
TEST_F(AdapterRunnerTest, WritesItsMonitorsLast) {
  auto writes = ring.follow("echo");
  static_cast<void>(runner.tick(Duration{0}, false, {}));

  std::vector<std::uint32_t> offsets;
  for (broker::Write write; writes.next(write) == broker::Followed::Write;)
    offsets.push_back(write.offset.value());
  EXPECT_EQ(offsets, (std::vector<std::uint32_t>{16, 32}));
}

// NaN and infinite values are dropped in both directions; the last valid value is held and counted.
TEST_F(AdapterRunnerTest, HoldsTheLastValueIfAWordIsNaN) {
  send(0.1);
  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);
  send(std::nan(""));

  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Stale);

  EXPECT_NEAR(value("echo.displ"), 0.3, 1e-6);
  EXPECT_EQ(value("monitor.echo.host.stale"), 1);
  EXPECT_EQ(value("monitor.echo.host.invalid"), 1);
}

// An operator's wrong value moves nothing.
TEST_F(AdapterRunnerTest, CountsNoParameterAsInvalid) {
  tune_gain(std::nan(""));

  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Stale);

  EXPECT_EQ(value("monitor.echo.host.invalid"), 0);
}

TEST_F(AdapterRunnerTest, PassesOnARequestToStop) {
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  EXPECT_STREQ(runner.stop_request(), "");
  echo.request = "over";

  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);

  EXPECT_STREQ(runner.stop_request(), "over");
}

TEST_F(AdapterRunnerTest, HoldsTheLastValueIfAnAdapterOutputsNaN) {
  send(0.1);
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  echo.poisoned = true;

  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::LimitExceeded);

  EXPECT_NEAR(value("echo.displ"), 0.3, 1e-6);
  EXPECT_EQ(value("monitor.echo.host.invalid"), 1);
}

TEST_F(AdapterRunnerTest, HoldsTheLastValueIfAValueOverflowsItsWord) {
  send(0.1);
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  tune_gain(100);
  send(1e35);

  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::LimitExceeded);

  EXPECT_NEAR(value("echo.displ"), 0.3, 1e-6);
}

// A parameter can be written without `rths send`, which checks its range.
TEST_F(AdapterRunnerTest, HoldsTheLastValueOfAParameterOutsideItsRange) {
  tune_gain(5);
  send(0.1);
  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);
  for (const double gain : {1e6, -1.0, std::nan("")}) {
    tune_gain(gain);
    EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Stale) << gain;
    EXPECT_NEAR(value("echo.displ"), 0.5, 1e-6) << gain;
  }
  EXPECT_EQ(value("monitor.echo.host.stale"), 3);

  tune_gain(100.3);  // as a float, it is above the bound
  EXPECT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);
  EXPECT_NEAR(value("echo.displ"), 10.03, 1e-5);
}

TEST(AdapterRunner, RefusesAPortInAnotherUnitThanTheMap) {
  broker::Ring ring = broker::Ring::in_process(memmap::parse_map(bench_map(), "bench"));
  Echo echo;
  echo.list[2].unit = "N";

  EXPECT_EQ(test::error_of([&] { AdapterRunner(echo, ring, "echo", 0, {}); }),
            "node 'echo' writes 'echo.displ' in [N], the map gives [m]");
}

// A stale input does not revoke an adapter's Done.
TEST_F(AdapterRunnerTest, EndsDespiteAStaleInput) {
  send(std::nan(""));

  EXPECT_EQ(runner.tick(Duration{0}, true, {}), Status::Done);
}

TEST_F(AdapterRunnerTest, WritesItsHeartbeatWithEveryStep) {
  const std::uint64_t before = sender.beats_of(map.node("echo"));

  static_cast<void>(runner.tick(Duration{0}, false, {}));

  EXPECT_EQ(sender.beats_of(map.node("echo")), before + 1);
}

TEST_F(AdapterRunnerTest, TicksInRealTime) {
  send(0.1);
  Status status = Status::Ok;
  EXPECT_REALTIME(status = runner.tick(milliseconds{1}, false, {}));
  EXPECT_EQ(status, Status::Ok);
}

// The words are gone; zeros must not be taken for a command.
TEST(AdapterRunner, HoldsItsInputsAndStopsItsAdapterIfTheRingIsLost) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "SKIPPED: the thread sanitizer waits for itself at a fault within a store";
#endif
  broker::on_lost_memory(broker::OnLostMemory::Continue);
  const memmap::Map map = memmap::parse_map(bench_map(), "bench");
  const std::string name = test::unique_ring("lost");
  const test::RingRemoval removal{name};
  broker::Ring ring = broker::Ring::create(name, map);
  broker::Node sender = ring.join("sender", 0);
  Echo echo;
  AdapterRunner runner{echo, ring, "echo", map.hash(), {}};
  const auto& entry = map.entry(map.signal("sender.displ"));
  const std::uint32_t words[2] = {0, memmap::Codec{*entry.signal}.encode(0.5)};
  ASSERT_EQ(sender.write_group(ring.tear_group("sender"), words), Status::Ok);
  ASSERT_EQ(runner.tick(Duration{0}, false, {}), Status::Ok);
  ASSERT_NEAR(echo.input, 0.5, 1e-6);

  std::filesystem::resize_file("/dev/shm/rths." + name, 0);

  EXPECT_EQ(runner.tick(milliseconds{1}, false, {}), Status::Done);
  EXPECT_NEAR(echo.input, 0.5, 1e-6);
  EXPECT_TRUE(runner.node().is_ring_lost());
}

TEST(AdapterRunner, RefusesAnOutputThatBelongsToAnotherNode) {
  broker::Ring ring = broker::Ring::in_process(memmap::parse_map(bench_map(), "bench"));
  Echo echo;
  echo.list[2].name = "sender.displ";

  EXPECT_EQ(test::error_of([&] { AdapterRunner(echo, ring, "echo", 0, {}); }),
            "node 'echo' cannot write 'sender.displ', which belongs to 'sender'");
}

TEST(AdapterRunner, RefusesASignalThatTheRingLacks) {
  broker::Ring ring = broker::Ring::in_process(memmap::parse_map(bench_map(), "bench"));
  Echo echo;
  echo.list[0].name = "sender.dspl";

  EXPECT_EQ(test::error_of([&] { AdapterRunner(echo, ring, "echo", 0, {}); }),
            "node 'echo': map 'bench' has no signal 'sender.dspl' (did you mean 'sender.displ'?)");
}

TEST_F(AdapterRunnerTest, LoopsUntilTheAdapterIsDone) {
  VirtualClock clock;
  const std::atomic<bool> stopping{false};
  echo.ends_after = 10;

  const LoopEnd end = run_loop(runner, clock, TimePoint{0}, stopping);

  EXPECT_EQ(end.status, Status::Done);
  EXPECT_EQ(end.time, milliseconds{9});
  EXPECT_EQ(clock.now(), milliseconds{9});
}

TEST_F(AdapterRunnerTest, LoopsUntilItIsToldToStop) {
  WallClock clock;
  std::atomic<bool> stopping{false};
  LoopEnd end;
  std::thread loop{[&] { end = run_loop(runner, clock, clock.now(), stopping); }};
  while (sender.beats_of(map.node("echo")) < 5) std::this_thread::yield();

  stopping.store(true);
  loop.join();

  EXPECT_EQ(end.status, Status::Done);
}

TEST_F(AdapterRunnerTest, LoopsUntilTheAdapterIsAtFault) {
  VirtualClock clock;
  const std::atomic<bool> stopping{false};
  echo.result = Status::Fault;

  EXPECT_EQ(run_loop(runner, clock, TimePoint{0}, stopping).status, Status::Fault);
}

TEST_F(AdapterRunnerTest, LoopsInRealTime) {
  VirtualClock clock;
  const std::atomic<bool> stopping{false};
  echo.ends_after = 10;
  LoopEnd end;

  EXPECT_REALTIME(end = run_loop(runner, clock, TimePoint{0}, stopping));

  EXPECT_EQ(end.status, Status::Done);
}

// Missed steps are run afterwards, each with its own scheduled time.
TEST_F(AdapterRunnerTest, RunsMissedStepsAfterwards) {
  VirtualClock clock;
  clock.sleep_until(milliseconds{50});  // fifty steps late from the start
  const std::atomic<bool> stopping{false};
  echo.ends_after = 50;

  const LoopEnd end = run_loop(runner, clock, TimePoint{0}, stopping);

  EXPECT_EQ(end.time, milliseconds{49});
  EXPECT_EQ(clock.now(), milliseconds{50});
}

class SkippingRunnerTest : public AdapterRunnerTest {
 protected:
  SkippingRunnerTest() : AdapterRunnerTest{MissedSteps::Skip} {}
};

// Late by 5.4 steps, it goes on with the one that is due: five are left out and counted.
TEST_F(SkippingRunnerTest, GoesOnWithTheStepThatIsDue) {
  VirtualClock clock;
  clock.sleep_until(Duration{5'400'000});
  const std::atomic<bool> stopping{false};
  echo.ends_after = 1;

  const LoopEnd end = run_loop(runner, clock, TimePoint{0}, stopping);

  EXPECT_EQ(end.time, milliseconds{5});
  EXPECT_EQ(value("monitor.echo.host.step"), 1);
  EXPECT_EQ(value("monitor.echo.host.skipped"), 5);
}

TEST_F(SkippingRunnerTest, CountsAsOverrunsTheStepsThatLeaveOutAnother) {
  static_cast<void>(runner.tick(Duration{0}, false, {Duration{0}, Duration{1'900'000}}));
  EXPECT_EQ(runner.overruns(), 0U);

  static_cast<void>(runner.tick(Duration{0}, false, {Duration{0}, Duration{2'000'000}}));
  EXPECT_EQ(runner.overruns(), 1U);
}

class DueRunnerTest : public AdapterRunnerTest {
 protected:
  DueRunnerTest() : AdapterRunnerTest{MissedSteps::MakeDue} {}

  /// The sender writes and dates it, late or not.
  void send_at(TimePoint now, double displacement, Duration late = Duration{0}) {
    send(displacement);
    sender.beat(now, late);
  }

  /// Steps that are due at 1, 2 and 3 ms, made at 3.2 ms. @returns what each one read [m]
  std::vector<double> inputs_of_late_steps() {
    VirtualClock clock;
    clock.sleep_until(Duration{3'200'000});
    std::vector<double> inputs;
    for (const Duration due : {milliseconds{1}, milliseconds{2}, milliseconds{3}}) {
      Timing timing;
      timing.late = clock.now() - due;
      timing.clock = &clock;
      timing.due = due;
      static_cast<void>(runner.tick(due, false, timing));
      inputs.push_back(echo.input);
    }
    return inputs;
  }
};

// The sender writes at 0.5, 1.5 and 2.5 ms. The steps of 1 and 2 ms, which are missed, take what
// was there at their time; that of 3 ms takes the newest.
TEST_F(DueRunnerTest, MakesMissedStepsWithTheInputsOfTheirOwnTime) {
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  send_at(Duration{500'000}, 0.1);
  send_at(Duration{1'500'000}, 0.2);
  send_at(Duration{2'500'000}, 0.3);

  const auto inputs = inputs_of_late_steps();

  EXPECT_NEAR(inputs[0], 0.1, 1e-8);
  EXPECT_NEAR(inputs[1], 0.2, 1e-8);
  EXPECT_NEAR(inputs[2], 0.3, 1e-8);
}

// As if the whole host was stopped: the sender makes its missed steps, then this node.
TEST_F(DueRunnerTest, ReadsTheMissedStepsOfAnotherNodeAsOfTheirTime) {
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  send_at(Duration{3'200'000}, 0.1, Duration{2'700'000});
  send_at(Duration{3'200'000}, 0.2, Duration{1'700'000});
  send_at(Duration{3'200'000}, 0.3, Duration{700'000});

  const auto inputs = inputs_of_late_steps();

  EXPECT_NEAR(inputs[0], 0.1, 1e-8);
  EXPECT_NEAR(inputs[1], 0.2, 1e-8);
  EXPECT_NEAR(inputs[2], 0.3, 1e-8);
}

// What the sender writes after its heartbeat has no time yet.
TEST_F(DueRunnerTest, ReadsNothingUndatedInAMissedStep) {
  static_cast<void>(runner.tick(Duration{0}, false, {}));
  send_at(Duration{500'000}, 0.1);
  send(0.2);

  const auto inputs = inputs_of_late_steps();

  EXPECT_NEAR(inputs[1], 0.1, 1e-8);
  EXPECT_NEAR(inputs[2], 0.2, 1e-8);
}

TEST_F(DueRunnerTest, MakesMissedStepsInRealTime) {
  VirtualClock clock;
  clock.sleep_until(milliseconds{2});
  send_at(Duration{500'000}, 0.1);
  Timing timing;
  timing.late = milliseconds{1};
  timing.clock = &clock;
  timing.due = milliseconds{1};

  EXPECT_REALTIME(static_cast<void>(runner.tick(milliseconds{1}, false, timing)));
}

// The awaited node is this one itself, which makes no step meanwhile.
TEST_F(AdapterRunnerTest, AwaitsAStepForALimitedTime) {
  VirtualClock clock;
  const std::atomic<bool> stopping{false};
  runner.await_steps_of("echo", false, ring);
  EXPECT_TRUE(runner.is_awaiting());
  echo.ends_after = 1;

  EXPECT_REALTIME(static_cast<void>(run_loop(runner, clock, TimePoint{0}, stopping)));

  EXPECT_EQ(clock.now(), kLongestAwaited);
  EXPECT_FALSE(runner.is_awaiting());
}

TEST_F(AdapterRunnerTest, MakesTheFirstStepWithoutAwaitingAnother) {
  runner.await_steps_of("echo", true, ring);

  EXPECT_FALSE(runner.is_awaiting());
}

TEST_F(AdapterRunnerTest, KeepsTheTimesOfScheduledStepsUntilAsManyAreKept) {
  VirtualClock clock;
  clock.sleep_until(milliseconds{2});
  const std::atomic<bool> stopping{false};
  echo.ends_after = 5;
  runner.keep_times(4);

  static_cast<void>(run_loop(runner, clock, TimePoint{0}, stopping));
  Timing early;
  early.is_early = true;
  EXPECT_REALTIME(runner.keep(early));

  EXPECT_EQ(runner.times().late, (std::vector<float>{0.002F, 0.001F, 0, 0}));
  EXPECT_EQ(runner.times().duration, (std::vector<float>(4, 0.0F)));
}

/// Each reading of this clock advances it, as if the host stopped the process there.
class SlowClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const noexcept override { return now_ += milliseconds{3}; }
  void sleep_until(TimePoint time) noexcept override { now_ = std::max(now_, time); }

 private:
  mutable TimePoint now_{0};
};

// A pause between the start of a step and the reading of its inputs counts, too.
TEST_F(AdapterRunnerTest, MeasuresTheAgeOfTheInputsAfterTheyAreRead) {
  SlowClock clock;
  const std::atomic<bool> stopping{false};
  echo.ends_after = 1;

  static_cast<void>(run_loop(runner, clock, TimePoint{0}, stopping));

  EXPECT_EQ(value("monitor.echo.host.late"), 0.003F);
  EXPECT_EQ(echo.oldest, 0.006);
}

}  // namespace
}  // namespace rths::adapters
