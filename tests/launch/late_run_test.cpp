// SPDX-License-Identifier: Apache-2.0
//
// Late nodes and late targets, made on purpose in virtual time.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/companions.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"

namespace rths::launch {
namespace {

using Lateness = std::function<Duration(const std::string& node, Duration due)>;

constexpr const char* kExamples[] = {"platen_2d", "lprb_2d", "lprb_3d", "eqsb_2d",
                                     "eqsb_3d",   "tpfb_2d", "tpfb_3d", "lprb_2d_ats"};
constexpr double kDuration = 8;  // up to the strong motion [s]

Experiment example(const std::string& name, const Overrides& changes, double duration = kDuration) {
  Overrides all{{"duration_s", fmt::format("{}", duration)}, {"held_out", "{}"}};
  all.insert(all.end(), changes.begin(), changes.end());
  return app::load_experiment(test::source_tree() / "examples" / ("srmd_" + name + ".toml"), all);
}

/// What a disturbance did to a test.
struct Ran {
  std::string trouble;
  double largest_step = 0;                        ///< of a horizontal reference in 1 ms [m]
  std::array<std::vector<double>, 2> response{};  ///< targets of each axis [m]
};

Ran ran(const Experiment& experiment, const Lateness& lateness) {
  const test::TemporaryFolder folder;
  RunOptions options;
  options.clock = ClockKind::Virtual;
  options.recording = folder.path() / "run.h5";
  options.lateness = lateness;
  Ran ran;
  ran.trouble = run(experiment, options).trouble;
  const recording::Reader recorded{options.recording};
  for (std::size_t i = 0; i < experiment.roles.axes.size(); ++i) {
    const auto& axis = experiment.roles.axes[i];
    const auto reference = recorded.signal(axis.reference_echo);
    for (std::size_t row = 1; row < reference.size(); ++row)
      ran.largest_step = std::max(ran.largest_step, std::abs(reference[row] - reference[row - 1]));
    ran.response[i] =
        recording::at_each_count(recorded.signal("monitor." + experiment.roles.solver + ".step"),
                                 recorded.signal(axis.target));
  }
  return ran;
}

/// RMS of the vectors of both axes.
double rms(const std::array<std::vector<double>, 2>& values) {
  double sum = 0;
  std::size_t count = 1;
  for (const auto& axis : values) {
    for (const double value : axis) sum += value * value;
    count = std::max(count, axis.size());
  }
  return std::sqrt(sum / static_cast<double>(count));
}

/// Relative difference of two responses, RMS.
double apart(const Ran& a, const Ran& b) {
  std::array<std::vector<double>, 2> difference;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < std::min(a.response[i].size(), b.response[i].size()); ++k)
      difference[i].push_back(a.response[i][k] - b.response[i][k]);
  return rms(difference) / rms(b.response);
}

/// The purely numerical response, at the times of the targets.
Ran numerical(const Experiment& experiment) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(session::run_numerical(experiment, folder.path() / "numerical.h5", ""));
  const recording::Reader recorded{folder.path() / "numerical.h5"};
  const double interval = recorded.time()[1] - recorded.time()[0];
  const auto rows =
      static_cast<std::size_t>(std::lround(experiment.time.integration_step / interval));
  Ran result;
  for (std::size_t i = 0; i < experiment.roles.axes.size(); ++i) {
    const auto values = recorded.signal("result.displ." + experiment.roles.axes[i].axis);
    for (std::size_t row = rows; row <= values.size(); row += rows)
      result.response[i].push_back(values[row - 1]);
  }
  return result;
}

/// The nodes that a host stops; empty: all.
struct Stalls {
  std::string node;
};
void PrintTo(const Stalls& stalls, std::ostream* out) {
  *out << (stalls.node.empty() ? "all" : stalls.node);
}

class StalledNode : public ::testing::TestWithParam<Stalls> {};

// Five stops a second in strong motion, of 3 to 50 ms. After a stop of all nodes, each starts again
// a little after the one before, in an order that changes.
TEST_P(StalledNode, NeitherTripsNorMovesTheReferenceFaster) {
  constexpr double kLengths[] = {0.003, 0.0082, 0.0113, 0.0204, 0.0501};
  const std::vector<std::string> nodes{"srmd", "xpc", "opf", "recorder"};
  const auto stalls = [&](const std::string& node, Duration due) {
    const double time = to_seconds(due);
    const auto number = static_cast<std::size_t>(time / 0.2);
    const double from = 0.2 * static_cast<double>(number) + 0.0501;
    const auto place =
        static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
    const double end =
        from + kLengths[number % 5] + 5e-5 * static_cast<double>((place + number) % nodes.size());
    const bool stops = GetParam().node.empty() || GetParam().node == node;
    return from_seconds(stops && time > 4 && time >= from && time < end ? end - time : 0);
  };
  const Experiment experiment = example("platen_2d", {});
  const Ran undisturbed = ran(experiment, nullptr);

  const Ran disturbed = ran(experiment, stalls);

  EXPECT_EQ(disturbed.trouble, "");
  EXPECT_LE(disturbed.largest_step, 1.5 * undisturbed.largest_step);
  EXPECT_LT(apart(disturbed, undisturbed), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Nodes, StalledNode,
                         ::testing::Values(Stalls{"srmd"}, Stalls{"xpc"}, Stalls{"opf"},
                                           Stalls{""}));

class LateTargets : public ::testing::TestWithParam<const char*> {};

// Targets of the solver that come too late, without a stop of the host. The response is at most
// half as far again from the numerical one, and 2 %.
TEST_P(LateTargets, NeitherTripNorChangeTheResponse) {
  const std::vector<std::pair<double, double>> all{{0.01, 0.004}, {0.01, 0.011}, {0.01, 0.05},
                                                   {0.05, 0.004}, {0.05, 0.011}, {0.05, 0.05}};
  const std::vector<std::pair<double, double>> some{{0.01, 0.05}, {0.05, 0.011}};
  const Experiment experiment = example(GetParam(), {});
  const Ran reference = numerical(experiment);
  const double usual = apart(ran(experiment, nullptr), reference);

  // The demo with seed 6 tripped in both of the some.
  const int first = test::is_long() ? 1 : 6, last = test::is_long() ? 10 : 6;
  for (const auto& [fraction, overrun] : test::is_long() ? all : some)
    for (int seed = first; seed <= last; ++seed) {
      const Ran late =
          ran(example(GetParam(), {{"solver.overrun_fraction", fmt::format("{}", fraction)},
                                   {"solver.overrun_s", fmt::format("{}", overrun)},
                                   {"seed", fmt::format("{}", seed)}}),
              nullptr);
      const auto of = fmt::format("{:g} of {:g} s, seed {}", fraction, overrun, seed);
      EXPECT_EQ(late.trouble, "") << of;
      EXPECT_LT(apart(late, reference), 1.5 * usual + 0.02) << of;
    }
}

INSTANTIATE_TEST_SUITE_P(Examples, LateTargets, ::testing::ValuesIn(kExamples));

}  // namespace
}  // namespace rths::launch
