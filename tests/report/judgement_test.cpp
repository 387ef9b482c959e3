// SPDX-License-Identifier: Apache-2.0
//
// Faults of sensors, actuator and motion: each is found and named. Undisturbed tests are
// conclusive.
#include <rths/report/judgement.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "faulty_laboratory.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

constexpr double kLate = 5;  // start of a fault in mid-test [s]

std::string text_of(const std::vector<Broken>& conditions) {
  std::string text;
  for (const auto& broken : conditions) text += broken.text() + "\n";
  return text;
}

using Change = decltype(Fault::change);

Change gain(double factor) {
  return [=](double value, double, double) { return factor * value; };
}
Change offset(double by) {
  return [=](double value, double, double) { return value + by; };
}
Change drift(double per_second) {
  return [=](double value, double, double since) { return value + per_second * since; };
}
Change clipped(double most) {
  return [=](double value, double, double) { return std::clamp(value, -most, most); };
}
Change rounded(double step) {
  return [=](double value, double, double) { return step * std::round(value / step); };
}
Change replaced() {
  return [](double, double other, double) { return other; };
}
Change constant(double value) {
  return [=](double, double, double) { return value; };
}
Change noisy(double deviation) {
  auto random = std::make_shared<std::mt19937_64>(1);
  return [=](double value, double, double) {
    return value + std::normal_distribution<double>{0, deviation}(*random);
  };
}
Change frozen() {
  auto held = std::make_shared<double>(std::nan(""));
  return [=](double value, double, double) { return *held = std::isnan(*held) ? value : *held; };
}
/// Repeats the last value for some of the time.
Change held(double period, double duration) {
  auto last = std::make_shared<double>(0);
  return [=](double value, double, double since) {
    if (std::fmod(since, period) >= duration) *last = value;
    return *last;
  };
}
/// Another value for some of the time.
Change interrupted(double period, double duration, double by) {
  return [=](double value, double, double since) {
    return std::fmod(since, period) < duration ? by : value;
  };
}
Change late(double delay) {
  auto line = std::make_shared<std::vector<double>>();
  const auto ticks = static_cast<std::size_t>(std::lround(delay * 1e3));
  return [=](double value, double, double) {
    line->push_back(value);
    return (*line)[line->size() > ticks ? line->size() - 1 - ticks : 0];
  };
}
Change slow(double most_per_second) {
  auto last = std::make_shared<double>(0);
  return [=](double value, double, double) {
    const double most = most_per_second * 1e-3;
    return *last += std::clamp(value - *last, -most, most);
  };
}

struct FaultRow {
  const char* name;
  std::vector<std::string> words;  ///< faulty; two words: exchanged with each other
  std::function<Change()> change;
  double from;                          ///< [s]
  std::vector<std::string> conditions;  ///< one of these names the fault
  std::string signal;                   ///< the one that has to be named; empty: the first word
};

const std::string kForce = "srmd.long.force.fbk", kForceLat = "srmd.lat.force.fbk",
                  kDisplacement = "srmd.long.displ.fbk", kDisplacementLat = "srmd.lat.displ.fbk",
                  kAcceleration = "srmd.long.accel.fbk", kReference = "xpc.long.displ.ref",
                  kReferenceLat = "xpc.lat.displ.ref", kEcho = "srmd.long.displ.ref_echo",
                  kLoad = "srmd.compression.force.fbk";

template <class Make, class... Arguments>
std::function<Change()> with(Make make, Arguments... arguments) {
  return [=] { return make(arguments...); };
}

std::vector<FaultRow> rows() {
  const std::vector<std::string> force{"force"}, live{"live"}, jump{"jump"}, noise{"noise"};
  const std::vector<std::string> motion{"motion", "tracking"};
  return {
      {"force_dead", {kForce}, with(gain, 0.0), 0, {"force", "live"}, ""},
      {"force_dead_late", {kForceLat}, with(gain, 0.0), kLate, {"force", "live"}, ""},
      {"force_tenfold", {kForce}, with(gain, 10.0), 0, force, ""},
      {"force_tenfold_late", {kForce}, with(gain, 10.0), kLate, {"force", "jump"}, ""},
      {"force_tenth", {kForce}, with(gain, 0.1), 0, force, ""},
      {"force_flipped", {kForce}, with(gain, -1.0), 0, force, ""},
      {"force_flipped_late", {kForceLat}, with(gain, -1.0), kLate, force, ""},
      {"force_in_kilonewtons", {kForce}, with(gain, 1e-3), 0, force, ""},
      {"force_saturated", {kForce}, with(clipped, 5e5), 0, force, ""},
      {"force_frozen", {kForce}, with(frozen), kLate, live, ""},
      {"force_drops_out", {kForce}, with(interrupted, 0.2, 0.02, 0.0), kLate, jump, ""},
      {"force_holds", {kForce}, with(held, 0.1, 0.02), kLate, live, ""},
      {"force_spikes", {kForce}, with(interrupted, 0.5, 1e-3, 3e6), kLate, jump, ""},
      {"force_offset", {kForce}, with(offset, 5e5), kLate, {"force", "jump"}, ""},
      {"force_negative_offset", {kForce}, with(offset, -5e5), 0, force, ""},
      {"force_drifts", {kForce}, with(drift, 2e5), 0, force, ""},
      {"force_noisy", {kForce}, with(noisy, 5e5), kLate, {"noise", "jump"}, ""},
      {"force_coarse", {kForce}, with(rounded, 3e5), 0, {"jump", "noise"}, ""},
      {"force_late", {kForce}, with(late, 0.1), 0, force, ""},
      {"force_at_half_the_rate", {kForce}, with(held, 2e-3, 1e-3), 0, live, ""},
      {"forces_exchanged", {kForce, kForceLat}, with(replaced), 0, force, ""},
      {"displacement_dead", {kDisplacement}, with(gain, 0.0), 0, {"live"}, ""},
      {"displacement_flipped", {kDisplacement}, with(gain, -1.0), 0, motion, ""},
      {"displacement_flipped_late",
       {kDisplacementLat},
       with(gain, -1.0),
       kLate,
       {"jump", "motion", "tracking"},
       ""},
      {"displacement_in_millimetres", {kDisplacement}, with(gain, 1e3), 0, motion, ""},
      {"displacement_halved", {kDisplacement}, with(gain, 0.5), 0, motion, ""},
      {"displacement_too_large", {kDisplacement}, with(gain, 1.5), 0, motion, ""},
      {"displacement_offset", {kDisplacement}, with(offset, 0.01), 0, {"offset"}, ""},
      {"displacement_offset_late",
       {kDisplacement},
       with(offset, -0.01),
       kLate,
       {"offset", "jump"},
       ""},
      {"displacement_drifts", {kDisplacementLat}, with(drift, 2e-3), 0, {"offset"}, ""},
      {"displacement_frozen", {kDisplacement}, with(frozen), kLate, live, ""},
      {"displacement_drops_out",
       {kDisplacement},
       with(interrupted, 0.2, 0.02, 0.0),
       kLate,
       jump,
       ""},
      {"displacement_spikes", {kDisplacement}, with(interrupted, 0.5, 1e-3, 0.05), kLate, jump, ""},
      {"displacement_noisy", {kDisplacement}, with(noisy, 5e-3), kLate, {"noise", "jump"}, ""},
      {"displacement_coarse", {kDisplacement}, with(rounded, 0.02), 0, {"jump", "noise"}, ""},
      {"displacement_late", {kDisplacement}, with(late, 0.05), 0, {"motion", "tracking"}, ""},
      {"displacement_at_half_the_rate", {kDisplacement}, with(held, 2e-3, 1e-3), 0, live, ""},
      {"displacements_exchanged", {kDisplacement, kDisplacementLat}, with(replaced), 0, motion, ""},
      {"acceleration_dead", {kAcceleration}, with(gain, 0.0), 0, {"live", "motion"}, ""},
      {"acceleration_flipped", {kAcceleration}, with(gain, -1.0), 0, {"motion"}, ""},
      {"acceleration_in_g", {kAcceleration}, with(gain, 1 / 9.80665), kLate, {"motion"}, ""},
      {"acceleration_doubled", {kAcceleration}, with(gain, 2.0), 0, {"motion"}, ""},
      {"acceleration_frozen", {kAcceleration}, with(frozen), kLate, live, ""},
      {"acceleration_noisy", {kAcceleration}, with(noisy, 5.0), kLate, noise, ""},
      {"reference_flipped", {kReference}, with(gain, -1.0), 0, {"wire"}, kEcho},
      {"reference_frozen", {kReference}, with(frozen), kLate, {"wire"}, kEcho},
      {"reference_late", {kReference}, with(late, 0.2), 0, {"wire"}, kEcho},
      {"reference_slow", {kReference}, with(slow, 0.1), 0, {"wire"}, kEcho},
      {"reference_short", {kReference}, with(clipped, 0.03), 0, {"wire"}, kEcho},
      {"reference_halved", {kReference}, with(gain, 0.5), 0, {"wire"}, kEcho},
      {"references_exchanged", {kReference, kReferenceLat}, with(replaced), 0, {"wire"}, kEcho},
      {"force_saturated_late", {kForceLat}, with(clipped, 1e6), kLate, {"force", "live"}, ""},
      {"load_lost", {kLoad}, with(constant, 0.0), kLate, {"load"}, ""},
  };
}

std::vector<Fault> faults_of(const FaultRow& row) {
  std::vector<Fault> faults;
  for (std::size_t i = 0; i < row.words.size(); ++i)
    faults.push_back(
        {row.words[i], row.change(), row.words.size() > 1 ? row.words[1 - i] : std::string{}});
  return faults;
}

bool names(const std::vector<Broken>& conditions, const FaultRow& row) {
  const std::string signal = row.signal.empty() ? row.words.front() : row.signal;
  return std::any_of(conditions.begin(), conditions.end(), [&](const Broken& broken) {
    // Displacement and acceleration contradict each other: the line names both.
    return (broken.signal == signal || broken.found.find(signal) != std::string::npos) &&
           std::count(row.conditions.begin(), row.conditions.end(), broken.condition) > 0;
  });
}

class EveryFault : public ::testing::TestWithParam<FaultRow> {};

TEST_P(EveryFault, IsFoundAndNamed) {
  const auto found =
      judge_with(short_experiment("srmd_lprb_2d"), faults_of(GetParam()), GetParam().from);

  EXPECT_TRUE(names(found, GetParam())) << text_of(found);
  if (std::getenv("RTHS_PRINT") != nullptr) std::fputs(text_of(found).c_str(), stdout);
}

INSTANTIATE_TEST_SUITE_P(OfTheMachine, EveryFault, ::testing::ValuesIn(rows()),
                         [](const auto& instance) { return std::string{instance.param.name}; });

/// Sizes of a fault from small to large.
struct Ladder {
  const char* name;
  std::string word;
  std::function<Change(double)> change;
  std::vector<double> sizes;
  double found_from;  ///< size from which the fault is found
};

std::vector<Ladder> ladders() {
  const auto spikes = [](double size) {
    return Change{[=](double value, double, double since) {
      return value + (std::fmod(since, 0.5) < 1e-3 ? size : 0);
    }};
  };
  const auto holds = [](double size) { return held(0.5, size); };
  return {{"force_gain_below_one", kForce, gain, {0.9, 0.8, 0.7, 0.6, 0.5}, 0.6},
          {"force_gain_above_one", kForce, gain, {1.1, 1.3, 1.5, 1.7, 2}, 1.7},
          {"force_offset", kForce, offset, {1e5, 2e5, 3e5, 4e5, 5e5}, 4e5},
          {"force_delay", kForce, late, {0.003, 0.005, 0.01, 0.02, 0.05}, 0.01},
          {"force_range", kForce, clipped, {2e6, 1.6e6, 1.3e6, 1e6}, 1.6e6},
          {"force_noise", kForce, noisy, {1e4, 2e4, 5e4, 1e5}, 5e4},
          {"force_spikes", kForce, spikes, {5e4, 1e5, 2e5, 5e5}, 2e5},
          {"force_held", kForce, holds, {0.002, 0.005, 0.01, 0.02}, 0.01},
          {"displacement_gain_below_one", kDisplacement, gain, {0.95, 0.92, 0.88, 0.85}, 0.88},
          {"displacement_gain_above_one", kDisplacement, gain, {1.05, 1.1, 1.15, 1.2}, 1.15},
          {"displacement_offset", kDisplacement, offset, {5e-4, 2e-3, 5e-3, 1e-2}, 2e-3},
          {"displacement_delay", kDisplacement, late, {0.003, 0.01, 0.02, 0.05}, 0.01},
          {"displacement_noise", kDisplacement, noisy, {2e-4, 5e-4, 2e-3, 5e-3}, 5e-4},
          {"displacement_spikes", kDisplacement, spikes, {1e-3, 2.5e-3, 5e-3, 1e-2}, 2.5e-3},
          {"displacement_held", kDisplacement, holds, {0.002, 0.005, 0.01, 0.02}, 0.005},
          {"acceleration_gain_below_one", kAcceleration, gain, {0.95, 0.92, 0.88, 0.85}, 0.88},
          {"acceleration_gain_above_one", kAcceleration, gain, {1.05, 1.1, 1.15, 1.2}, 1.15}};
}

class Smallest : public ::testing::TestWithParam<Ladder> {};

TEST_P(Smallest, FaultThatIsFoundIsAsStated) {
  const Ladder& ladder = GetParam();
  const bool grows = ladder.sizes.back() > ladder.sizes.front();
  for (const double size : ladder.sizes) {
    const auto found = judge_with(short_experiment("srmd_lprb_2d_ats"),
                                  {{ladder.word, ladder.change(size), ""}}, 0);
    const bool expected = grows ? size >= ladder.found_from : size <= ladder.found_from;
    EXPECT_EQ(!found.empty(), expected) << size << "\n" << text_of(found);
    if (std::getenv("RTHS_PRINT") != nullptr)
      std::printf("%s %g: %s\n", ladder.name, size, text_of(found).c_str());
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Smallest, ::testing::ValuesIn(ladders()),
                         [](const auto& instance) { return std::string{instance.param.name}; });

class EveryExample : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryExample, IsConclusiveUndisturbed) {
  EXPECT_EQ(text_of(judge_with(short_experiment(GetParam()), {}, 0)), "");
}

INSTANTIATE_TEST_SUITE_P(Examples, EveryExample,
                         ::testing::Values("srmd_lprb_2d", "srmd_eqsb_2d", "srmd_tpfb_2d",
                                           "mismatch_tracking_2d"),
                         [](const auto& instance) { return std::string{instance.param}; });

/// A recording without faults, edited.
class Recording : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    run_with(short_experiment("srmd_lprb_2d"), {}, 0, file());
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::filesystem::path file() { return folder_->path() / "run.h5"; }

  using Edit = std::function<bool(double, Row&)>;
  static std::string judged_with(const Edit& edit) {
    const test::TemporaryFolder folder;
    copy(file(), folder.path() / "run.h5", edit);
    return text_of(judge(recording::Reader{folder.path() / "run.h5"}));
  }

 private:
  inline static std::unique_ptr<test::TemporaryFolder> folder_;
};

TEST_F(Recording, IsConclusiveUnchanged) {
  EXPECT_EQ(judged_with([](double, Row&) { return true; }), "");
}

// A node that is late by part of a tick reads the word of the tick before. The reference is rough:
// here it also jumps by up to 0.5 mm from tick to tick.
TEST_F(Recording, IsConclusiveIfTheEchoOfTheReferenceIsATickLateAtTimes) {
  std::deque<double> sent{0, 0};
  const auto found = judged_with([&](double time, Row& row) {
    row[kReference] += 5e-4 * std::sin(2.1 * std::round(1e3 * time));
    sent.push_back(row[kReference]);
    sent.pop_front();
    row[kEcho] = std::fmod(time, 0.5) < 0.25 ? sent.front() : sent.back();
    return true;
  });

  EXPECT_EQ(found, "");
}

TEST_F(Recording, IsNotConclusiveIfItEndsEarly) {
  EXPECT_NE(judged_with([](double time, Row&) { return time < 8; }).find("end at "),
            std::string::npos);
}

TEST_F(Recording, IsNotConclusiveWithoutMoreThanAHundredthOfItsRows) {
  const auto without_rows = [](double seconds) {
    return judged_with([=](double time, Row&) { return time < 6 || time > 6 + seconds; });
  };

  EXPECT_EQ(without_rows(0.1), "");
  EXPECT_NE(without_rows(0.2).find("rows at "), std::string::npos);
}

TEST_F(Recording, IsNotConclusiveIfANodeWasReplaced) {
  const auto found = judged_with([](double time, Row& row) {
    if (time > 6) row["monitor.srmd.host.step"] -= 5000;
    return true;
  });

  EXPECT_NE(found.find(": srmd: found its step count fell"), std::string::npos) << found;
}

TEST_F(Recording, IsNotConclusiveWithAnInvalidInput) {
  const auto found = judged_with([](double time, Row& row) {
    row["monitor.xpc.host.stale"] = time > 6 ? 1 : 0;
    return true;
  });

  EXPECT_NE(found.find("stale at 6.00"), std::string::npos) << found;
}

TEST_F(Recording, IsNotConclusiveIfTheHostWasLateInMoreThanAHundredthOfTheSteps) {
  const auto with_lateness = [](std::size_t intervals) {
    const test::TemporaryFolder folder;
    copy(file(), folder.path() / "run.h5", [](double, Row&) { return true; });
    std::vector<double> late(1300, 0.0);
    for (std::size_t i = 0; i < intervals; ++i) late[300 + 10 * i] = 0.002;
    recording::add_meta(folder.path() / "run.h5", {}, {{"host_late", {0.01, late}}});
    return text_of(judge(recording::Reader{folder.path() / "run.h5"}));
  };

  EXPECT_EQ(with_lateness(5), "");
  EXPECT_NE(with_lateness(13).find("host at "), std::string::npos);
}

TEST(Bounds, AreThoseOfTheExperiment) {
  EXPECT_EQ(read_bounds(Config::parse("nrms = 0.1", "conclusive")).nrms, 0.1);
  EXPECT_NE(test::error_of([] {
              static_cast<void>(read_bounds(Config::parse("nrsm = 0.1", "conclusive")));
            }).find("did you mean 'nrms'"),
            std::string::npos);
}

/// The model of the simulation may be wrong by 30 %.
class WrongModel : public ::testing::TestWithParam<double> {};

TEST_P(WrongModel, IsNoFault) {
  const auto found = judge_with(
      short_experiment("srmd_lprb_2d", {{"model.specimen.bouc_wen.characteristic_strength_N",
                                         std::to_string(GetParam() * 1'010'000)},
                                        {"model.specimen.bouc_wen.post_yield_stiffness_N_per_m",
                                         std::to_string(GetParam() * 4'238'095)}}),
      {}, 0);

  EXPECT_EQ(text_of(found), "");
}

INSTANTIATE_TEST_SUITE_P(ByThirtyPercent, WrongModel, ::testing::Values(0.7, 1.3));

}  // namespace
}  // namespace rths::report
