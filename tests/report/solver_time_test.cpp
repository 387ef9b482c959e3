// SPDX-License-Identifier: Apache-2.0
//
// The solver's time at each move, and the number of targets of a test.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/report/report.hpp>

#include "report/src/solver_time.hpp"
#include "support/files.hpp"
#include "tiny_recording.hpp"

namespace rths::report {
namespace {

constexpr double kRow = 0.001, kStep = 0.01;  // [s]
constexpr int kMoves = 200;                   // of 10 rows each

using TimeOfMove = std::function<double(int move)>;

std::string experiment_of(const std::string& solver, const std::string& controller) {
  return "name = \"tiny\"\nduration_s = 2\naxes = [\"long\"]\n[node.opf]\nadapter = \"" + solver +
         "\"\n[node.xpc]\nadapter = \"" + controller + "\"\n";
}

/// Number of moves until a row; the first comes after 5 rows.
int moves_at(double row_time) {
  return std::clamp(static_cast<int>(std::floor((row_time / kRow + 5.5) / 10)), 0, kMoves);
}

double steady(int move) { return move * kStep; }
double moving(int move) { return 0.1 * std::sin(0.1 * move); }

TinyRecording recording_of(const TimeOfMove& time, const TimeOfMove& target = moving) {
  const auto at_move = [](const TimeOfMove& value) {
    return [value](double row_time) {
      const int move = moves_at(row_time);
      return move == 0 ? 0.0 : value(move);
    };
  };
  return {experiment_of("opensees", "ideal_machine"),
          {{"opf", "monitor.opf", "step", [](double t) { return moves_at(t); }},
           {"opf", "monitor.opf", "time", at_move(time)},
           {"opf", "opf", "long.displ.target", at_move(target)}},
          kRow,
          2000};
}

/// The broken condition of this name; without a text if it holds.
Broken broken_in(const TinyRecording& recording, const std::string& condition) {
  const test::TemporaryFolder folder;
  recording.write(folder.path() / kRunFile);
  for (const auto& broken : judge(recording::Reader{folder.path() / kRunFile}))
    if (broken.condition == condition) return broken;
  return {};
}

TEST(SolverTime, HoldsIfEachMoveIsOneStep) {
  EXPECT_EQ(broken_in(recording_of(steady), "time").found, "");
  // The trials of an α-method.
  const auto early = [](int move) { return (move - 0.3) * kStep; };
  EXPECT_EQ(broken_in(recording_of(early), "time").found, "");
}

TEST(SolverTime, IsBrokenByIterations) {
  const auto iterating = [](int move) { return (1 + (move - 1) / 2) * kStep; };

  const Broken found = broken_in(recording_of(iterating), "time");

  EXPECT_EQ(found.found, "of 200 moves, 100 repeat the time (iterations)");
  EXPECT_EQ(found.expected, "each advances it by 0.01 s");
  EXPECT_EQ(found.signal, "monitor.opf.time");
}

TEST(SolverTime, IsBrokenByAStepThatIsRepeatedInParts) {
  const auto halving = [](int move) {
    if (move <= 100) return move * kStep;
    if (move <= 102) return (99 + 0.5 * (move - 101)) * kStep;
    return (move - 3) * kStep;
  };

  const Broken found = broken_in(recording_of(halving), "time");

  EXPECT_EQ(found.found, "of 200 moves, 1 go back, 2 advance it by less (parts of a step)");
  EXPECT_NEAR(found.time, 1.005, 0.002);
}

TEST(SolverTime, IsBrokenByAMoveOfTwoSteps) {
  const auto skipping = [](int move) { return (move + (move > 50 ? 1 : 0)) * kStep; };

  EXPECT_EQ(broken_in(recording_of(skipping), "time").found, "of 200 moves, 1 advance it by more");
}

TEST(SolverTime, RestartsAfterAStaticAnalysis) {
  const auto gravity_first = [](int move) { return move <= 10 ? 0.1 * move : (move - 10) * kStep; };
  const auto rest_first = [](int move) { return move <= 10 ? 1e-12 * move : moving(move - 10); };

  EXPECT_EQ(broken_in(recording_of(gravity_first, rest_first), "time").found, "");
  EXPECT_NE(broken_in(recording_of(gravity_first, moving), "time").found, "");
}

TEST(SolverTime, GivesTheRateThatWasAchieved) {
  const test::TemporaryFolder folder;
  recording_of([](int move) {
    return (1 + (move - 1) / 2) * kStep;
  }).write(folder.path() / kRunFile);

  const auto rate =
      achieved_rate(solver_time_of(recording::Reader{folder.path() / kRunFile}), kStep);

  ASSERT_TRUE(rate);
  EXPECT_NEAR(*rate, 2, 0.03);  // the last iteration of two counts half a step
}

TEST(EndOfRun, IsInTheSolversTimeIfItIterates) {
  const auto iterating = [](int move) { return (1 + (move - 1) / 2) * kStep; };

  EXPECT_EQ(broken_in(recording_of(iterating), "end").found, "1.00 s, ending: completed");
}

struct Contradiction {
  const char* name;
  const char* condition;
  TimeOfMove time;
};

class OfTime : public ::testing::TestWithParam<Contradiction> {};

TEST_P(OfTime, IsNamedWithItsSignal) {
  const Broken found = broken_in(recording_of(GetParam().time), GetParam().condition);

  EXPECT_EQ(found.condition, GetParam().condition) << "conclusive";
  EXPECT_NE(found.found, "");
  EXPECT_NE(found.signal, "");
}

INSTANTIATE_TEST_SUITE_P(
    Contradictions, OfTime,
    ::testing::Values(
        Contradiction{"RestartsHalfway", "time", [](int move) { return move % 101 * kStep; }},
        Contradiction{"RestartedTestEndsEarly", "end", [](int move) { return move % 101 * kStep; }},
        Contradiction{"InMilliseconds", "time", [](int move) { return 1e3 * move * kStep; }},
        Contradiction{"DoubleStep", "time", [](int move) { return 2 * move * kStep; }},
        Contradiction{"HalfStep", "time", [](int move) { return 0.5 * move * kStep; }},
        Contradiction{"HalfStepEndsEarly", "end", [](int move) { return 0.5 * move * kStep; }},
        Contradiction{"RunsAhead", "rate", [](int move) { return 1.2 * move * kStep; }},
        Contradiction{"FallsBehind", "rate", [](int move) { return 0.7 * move * kStep; }},
        Contradiction{"StandsStill", "time", [](int move) { return std::min(move, 100) * kStep; }},
        Contradiction{"JumpsOnce", "time",
                      [](int move) { return (move > 80 ? move + 100 : move) * kStep; }},
        Contradiction{"SwingsBackAndForth", "time",
                      [](int move) { return (move + (move % 2 == 0 ? 2 : 0)) * kStep; }},
        Contradiction{"RunsBackwards", "time", [](int move) { return (kMoves - move) * kStep; }},
        Contradiction{"OnePercentTooFast", "time", [](int move) { return 1.01 * move * kStep; }}),
    [](const auto& one) { return std::string{one.param.name}; });

// Rows see each of these moves, so a longer advance is not that of several moves.
TEST(SolverTime, IsBrokenByDoubleStepsThatNobodyCounts) {
  TinyRecording recording{
      experiment_of("plugin", "ideal_machine"),
      {{"opf", "opf", "newTarget", [](double t) { return moves_at(t) % 2; }},
       {"opf", "opf", "1.time.target", [](double t) { return 2 * moves_at(t) * kStep; }},
       {"opf", "opf", "long.displ.target", [](double t) { return moving(moves_at(t)); }}},
      kRow,
      2000};

  const Broken found = broken_in(recording, "time");

  EXPECT_NE(found.found.find("advance it by more"), std::string::npos) << found.found;
  EXPECT_EQ(found.signal, "opf.1.time.target");
}

TEST(TargetsOfASolver, AreNeitherHugeNorFrozen) {
  EXPECT_EQ(broken_in(recording_of(steady), "live").found, "");
  EXPECT_EQ(broken_in(recording_of(steady), "limit").found, "");
  const auto frozen = [](int move) { return moving(std::min(move, 120)); };
  EXPECT_EQ(broken_in(recording_of(steady, frozen), "live").signal, "opf.long.displ.target");
  const auto in_millimetres = [](int move) { return 1e3 * moving(move); };
  EXPECT_EQ(broken_in(recording_of(steady, in_millimetres), "limit").signal,
            "opf.long.displ.target");
  // A structure that comes to rest.
  const auto settling = [](int move) {
    return move < 100 ? std::exp(-0.2 * move) * moving(move) : 0.0;
  };
  EXPECT_EQ(broken_in(recording_of(steady, settling), "live").found, "");
}

// Its time runs on, but it sends no more targets.
TEST(EndOfRun, IsNotReachedByATimeWithoutMoves) {
  TinyRecording recording = recording_of(steady);
  recording.words[0].value = [](double t) { return std::min(moves_at(t), 100); };

  EXPECT_EQ(broken_in(recording, "end").found, "1.00 s, ending: completed");
}

/// A solver of another program, without a count and without its time.
TinyRecording uncounted(const std::function<double(double)>& flag,
                        const std::function<double(double)>& target) {
  return {experiment_of("external", "echo"),
          {{"opf", "opf", "newTarget", flag},
           {"opf", "opf", "long.displ.target", target},
           {"xpc", "daq", "long.force.fbk", target}},
          kRow,
          2000};
}

double flag_of_steps(double t) { return std::fmod(t / kRow + 0.5, 10) < 3 ? 1 : 0; }

TEST(EndOfRun, CountsTheTargetsOfASolverWithoutATime) {
  const auto target = [](double t) { return moving(moves_at(t)); };

  EXPECT_EQ(broken_in(uncounted(flag_of_steps, target), "end").found, "");
}

TEST(EndOfRun, IsNotReachedByASolverThatHangsAfterItsFirstFlag) {
  const auto slowly = [](double t) { return std::floor(t / 0.1) * 1e-3; };
  const auto quickly = [](double t) { return std::sin(t); };
  for (const auto& target : {std::function<double(double)>{slowly}, {quickly}}) {
    const Broken found =
        broken_in(uncounted([](double t) { return t > 0.1 ? 1 : 0; }, target), "end");

    EXPECT_EQ(found.found.substr(0, 3), "0.0") << found.found;
    EXPECT_EQ(found.expected, "2 s, ending: completed");
  }
}

}  // namespace
}  // namespace rths::report
