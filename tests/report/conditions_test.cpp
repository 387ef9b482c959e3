// SPDX-License-Identifier: Apache-2.0
//
// Judgement and analysis of recordings of a few words.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/recording/foreign_stores.hpp>
#include <rths/report/report.hpp>

#include "report/src/companions.hpp"
#include "report/src/conditions.hpp"
#include "support/files.hpp"
#include "tiny_recording.hpp"

namespace rths::report {
namespace {

constexpr double kRowInterval = 0.01;  // [s]

std::string experiment(const std::string& solver, const std::string& controller,
                       const std::string& more = "") {
  return "name = \"tiny\"\nduration_s = 2\naxes = [\"long\"]\n" + more +
         "[node.opf]\nadapter = \"" + solver + "\"\n[node.xpc]\nadapter = \"" + controller + "\"\n";
}

// Counts the rows, up to a number.
std::function<double(double)> rows_up_to(double most, double interval = kRowInterval) {
  return [=](double time) { return std::min(most, std::round(time / interval) + 1); };
}

std::function<double(double)> sine(double amplitude, double frequency) {
  return [=](double time) { return amplitude * std::sin(2 * M_PI * frequency * time); };
}

/// A recording in a temporary folder.
class TinyRun {
 public:
  explicit TinyRun(const TinyRecording& recording) { recording.write(folder_.path() / kRunFile); }
  [[nodiscard]] recording::Reader reader() const {
    return recording::Reader{folder_.path() / kRunFile};
  }
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }
  /// The broken condition of this name; without a text if it holds.
  [[nodiscard]] Broken broken(const std::string& condition) const {
    const auto found = judge(reader());
    const auto at = std::find_if(found.begin(), found.end(),
                                 [&](const auto& one) { return one.condition == condition; });
    return at == found.end() ? Broken{} : *at;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(EndOfRun, IsEarlyIfOpenSeesLeavesEarly) {
  const TinyRun run{{experiment("opensees", "ideal_machine"),
                     {{"opf", "monitor.opf", "step", rows_up_to(49)}},
                     kRowInterval,
                     201}};

  EXPECT_EQ(run.broken("end").found, "0.50 s, ending: completed");
}

TEST(EndOfRun, IsReachedWithAllTargetsOfOpenSees) {
  const TinyRun run{{experiment("opensees", "ideal_machine"),
                     {{"opf", "monitor.opf", "step", rows_up_to(199)}},
                     kRowInterval,
                     201}};

  EXPECT_EQ(run.broken("end").found, "");
}

// Trials of a ground at rest repeat the one before and are not counted.
TEST(EndOfRun, IsReachedAfterAGroundAtRest) {
  const TinyRun run{
      {experiment("opensees", "ideal_machine"),
       {{"opf", "monitor.opf", "step", [](double time) { return std::max(0.0, 100 * time - 50); }},
        {"opf", "opf.1", "time.target", [](double time) { return std::min(2.0, time); }}},
       kRowInterval,
       201}};

  EXPECT_EQ(run.broken("end").found, "");
}

TEST(EndOfRun, IsThatOfTheTargetsThatTheControllerCounts) {
  const TinyRun run{{experiment("external", "simulink_like"),
                     {{"xpc", "monitor.xpc", "pc.targets", rows_up_to(100)}},
                     kRowInterval,
                     201}};

  EXPECT_EQ(run.broken("end").found, "1.00 s, ending: completed");
}

TEST(EndOfRun, IsInModelTimeAfterTheRest) {
  const TinyRun run{{experiment("external", "echo", "rate = 2\nrest_s = 0.5\n"),
                     {{"xpc", "daq", "long.force.fbk", sine(1, 1)}},
                     kRowInterval,
                     251,
                     "interrupted"}};

  EXPECT_EQ(run.broken("end").found, "1.00 s, ending: interrupted");
  EXPECT_NEAR(analyse(run.folder()).timing.duration, 1, 1e-9);
}

TEST(Owner, IsBrokenByAForeignStore) {
  const TinyRun run{{experiment("numerical", "echo"),
                     {{"xpc", "daq", "long.force.fbk", sine(1, 1)}},
                     kRowInterval,
                     201}};
  EXPECT_EQ(run.broken("owner").found, "");

  recording::add_meta(
      run.folder() / kRunFile,
      {{recording::kForeignStores,
        recording::to_text({{"daq.long.force.fbk", "xpc", 0.25, "12345 N", 812, "opf (process 12)"},
                            {"daq.atTarget", "xpc", 0.5, "1", 1, "opf (process 12)"}})}});

  const Broken found = run.broken("owner");
  EXPECT_EQ(found.text(),
            "owner at 0.250 s: daq.long.force.fbk: found 12345 N by opf (process 12), seen 812 "
            "times; and 1 more word, expected stores by its owner xpc alone");
}

TEST(LateHost, ExcusesFromOneControlPeriodOn) {
  constexpr double kPeriod = 0.002;  // [s]
  const auto found_with = [](double lateness) {
    const TinyRun run{{experiment("numerical", "simulink_like"),
                       {{"xpc", "monitor.xpc", "host.step", rows_up_to(1e6, kPeriod)},
                        {"opf", "monitor.opf", "step", rows_up_to(1e6, kPeriod)}},
                       kPeriod,
                       1001}};
    recording::add_meta(run.folder() / kRunFile, {},
                        {{"host_late", {0.01, std::vector<double>(200, lateness)}}});
    return run.broken("host").found;
  };

  EXPECT_EQ(found_with(0.0015), "");
  EXPECT_NE(found_with(0.0025), "");
}

TEST(WindowedTracking, EndsWithRowsWiderThanItsStep) {
  const TinyRun run{{experiment("numerical", "ideal_machine", "[motion]\nname = \"slow\"\n"),
                     {{"opf", "opf", "long.displ.target", sine(0.1, 0.1)},
                      {"xpc", "daq", "long.displ.fbk", sine(0.1, 0.1)},
                      {"xpc", "daq", "long.force.fbk", sine(1e6, 0.1)}},
                     0.5,
                     101}};

  const Analysis analysis = analyse(run.folder());

  ASSERT_EQ(analysis.axes.size(), 1U);
  const Series& nrms = analysis.axes[0].tracking.nrms;
  EXPECT_NEAR(nrms.interval, 0.5, 1e-9);
  EXPECT_GT(nrms.values.size(), 90U);
}

/// Force of the model of a sliding specimen, at the end of a second.
double model_force_under(const std::function<double(double)>& load_reference) {
  constexpr double kTick = 1e-3;  // [s]
  const std::string nodes =
      experiment("numerical", "simulink_like", "[node.srmd]\nadapter = \"srmd\"\n");
  const TinyRun run{{nodes,
                     {{"srmd", "monitor.srmd", "host.step", rows_up_to(1e6, kTick)},
                      {"xpc", "monitor.xpc", "host.step", rows_up_to(1e6, kTick)},
                      {"xpc", "monitor.xpc", "pc.command.long", sine(0.05, 1.25)},
                      {"opf", "opf", "newTarget", [](double) { return 1; }},
                      {"srmd", "srmd", "long.displ.fbk", sine(0.05, 1.25)},
                      {"srmd", "srmd", "compression.force.fbk", [](double) { return 5e6; }},
                      {"xpc", "xpc", "compression.force.ref", load_reference}},
                     kTick,
                     1001,
                     "completed",
                     "bearing = 1\n[flat_slider]\nfriction_coefficient = 0.1\n"
                     "initial_stiffness_N_per_m = 1e9\n"}};
  const auto reader = run.reader();
  const auto recorded = recording::experiment_in(reader);
  const Evidence evidence = gather(reader, *recorded);
  return evidence.axes.empty() || evidence.axes[0].model_force.empty()
             ? std::nan("")
             : std::abs(evidence.axes[0].model_force.back());
}

TEST(ModelForce, HasTheLoadAtRestUntilTheFirstReference) {
  EXPECT_NEAR(model_force_under([](double) { return 0; }), 5e5, 1);
}

TEST(ModelForce, IsZeroInUplift) {
  const auto lifted_off = [](double time) { return time < 0.5 ? 4e6 : -1e5; };

  EXPECT_NEAR(model_force_under(lifted_off), 0, 1);
  EXPECT_NEAR(model_force_under([](double time) { return time < 0.5 ? 4e6 : 0; }), 0, 1);
}

/// Evidence of some ticks of 1 ms.
Evidence evidence_of(std::size_t ticks) {
  Evidence evidence;
  evidence.interval = 1e-3;
  for (std::size_t i = 0; i < ticks; ++i) evidence.time.push_back(1e-3 * static_cast<double>(i));
  return evidence;
}

TEST(Tracking, StatesAnErrorWithoutACommandInMillimetres) {
  const Evidence evidence = evidence_of(3000);
  AxisEvidence axis;
  axis.command.values.assign(3000, 0.0);
  axis.displacement = {"srmd.long.displ.fbk", std::vector<double>(3000, 0.005)};

  const Break found = tracking_of(axis, evidence, Bounds{});

  ASSERT_TRUE(found);
  EXPECT_EQ(found->found.rfind("an RMS error of 5.0 mm in 2 s", 0), 0U) << found->found;
  EXPECT_EQ(found->expected, "at most 1 mm");
}

// Whatever the machine then does: no bound of [conclusive] permits it.
TEST(Limit, NamesALoadReferenceBeyondTheVerticalCapacity) {
  Evidence evidence = evidence_of(100);
  evidence.load_reference = {"xpc.compression.force.ref", std::vector<double>(100, 53.4e6)};
  EXPECT_FALSE(load_limit_of(evidence));

  evidence.load_reference.values[40] = 112e6;
  const Break found = load_limit_of(evidence);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->text(),
            "limit at 0.040 s: xpc.compression.force.ref: found up to 112 MN, which the machine "
            "clamps, expected at most 53.4 MN, its vertical capacity");
}

TEST(Jump, NeedsADepartureBeyondABoundOfZero) {
  const Evidence evidence = evidence_of(100);
  const RecordedSignal still{"srmd.long.force.fbk", std::vector<double>(100, 7.0)};
  const std::vector<double> command(100, 0.0);

  EXPECT_FALSE(jump_of({&still, &command, 1, 0}, evidence));

  RecordedSignal jumping = still;
  jumping.values[50] = 8;
  EXPECT_TRUE(jump_of({&jumping, &command, 1, 0}, evidence));
}

// A test whose displacement is a function of model time, at targets of an interval.
TinyRecording test_at_targets(double interval, const std::function<double(double)>& displacement) {
  const auto time = [=](double row_time) { return row_time + interval; };
  return {experiment("numerical", "ideal_machine"),
          {{"opf", "monitor.opf", "step", rows_up_to(1e6, interval)},
           {"opf", "opf.1", "time.target", time},
           {"opf", "opf", "long.displ.target",
            [=](double row_time) { return displacement(time(row_time)); }}},
          interval,
          199};
}

// The same as a numerical result.
TinyRecording result_at(double interval, const std::function<double(double)>& displacement) {
  const auto at = [=](double row_time) { return displacement(row_time + interval); };
  return {"",
          {{"opf", "result", "displ.long", at}, {"opf", "result", "force.long", at}},
          interval,
          199};
}

double difference_between(const TinyRecording& recorded, const TinyRecording& computed,
                          double step) {
  const TinyRun test{recorded}, result{computed};
  std::vector<AxisAnalysis> axes(1);
  axes[0].name = "long";
  const auto reader = test.reader(), numerical = result.reader();
  const auto found =
      analyse_companions(reader, recording::roles_of(reader), step, axes, {&numerical, nullptr});
  return found.numerical.empty() ? std::nan("") : found.numerical[0].difference;
}

TEST(Difference, IsTakenAtTheSameModelTime) {
  const auto ramp = [](double time) { return 0.1 * time; };

  EXPECT_NEAR(difference_between(test_at_targets(0.01, ramp), result_at(0.02, ramp), 0.01), 0,
              1e-9);
}

TEST(Difference, ReadsTheSameRowsOfAnEqualInterval) {
  // Recorded times are rounded: they lie beside those of the rows.
  const auto early = [](double time) { return std::sin(time); };
  TinyRecording recorded = test_at_targets(0.01, early);
  const auto exact = recorded.words[1].value;
  recorded.words[1].value = [=](double time) { return exact(time) + 5e-5; };

  EXPECT_EQ(difference_between(recorded, result_at(0.01, early), 0.01), 0);
}

TEST(Models, AreUnknownWithoutAnExperiment) {
  const TinyRun run{{"", {{"srmd", "srmd", "long.displ.fbk", sine(0.1, 1)}}, kRowInterval, 10}};

  EXPECT_FALSE(is_of_models(run.reader()).has_value());
}

}  // namespace
}  // namespace rths::report
