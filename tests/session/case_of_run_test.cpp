// SPDX-License-Identifier: Apache-2.0
//
// The diagnosis case that a recorded run becomes.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/cases/case.hpp>
#include <rths/identification/signal.hpp>
#include <rths/recording/recording.hpp>
#include <rths/sim/composition.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::diagnosis {
namespace {

constexpr const char* kAxes[] = {"long", "lat"};
constexpr double kFusedBelow = 8;     // [Hz], from the noise of both sensors
constexpr double kComparedUpTo = 10;  // [Hz]

/// The example for twelve seconds, in virtual time.
Case case_with(const std::filesystem::path& folder, const std::vector<std::string>& changes) {
  const auto example = (test::source_tree() / "examples/srmd_lprb_2d.toml").string();
  std::vector<std::string> arguments{
      "run",           example, "--clock",       "virtual", "--no-diagnosis",  "--out",
      folder.string(), "--set", "duration_s=12", "--set",   "uncompensated={}"};
  for (const auto& change : changes) arguments.insert(arguments.end(), {"--set", change});
  const test::Finished run = test::run_rths(arguments, 120);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return load_case(folder / "run.h5");
}

Eigen::VectorXd channel(const Record& record, const std::string& role) {
  const auto& values = record.find(role)->values;
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

struct Fused {
  Eigen::VectorXd displacement, velocity, acceleration;
};

/// Measured minus predicted force under the measured motion: rms below 10 Hz, on each axis [N].
Eigen::Vector2d residual(const Case& c) {
  const Record& record = c.records[0];
  const double step = record.time_step;
  std::vector<Fused> motion;
  std::vector<Eigen::VectorXd> force;
  for (const char* axis : kAxes) {
    const auto a = channel(record, std::string{"acceleration."} + axis);
    const auto u =
        fused(channel(record, std::string{"displacement."} + axis), a, kFusedBelow, step);
    motion.push_back({u, rate_of(u, step), a});
    force.push_back(channel(record, std::string{"force."} + axis));
  }
  const sim::Composition composition{sim::read_terms(c.model.table), step};
  std::vector<double> state(composition.states());
  const auto load = channel(record, "vertical_force");
  Eigen::MatrixXd error{load.size(), 2};
  for (Eigen::Index k = 0; k < load.size(); ++k) {
    sim::Quantities<double> q;
    for (std::size_t i = 0; i < 2; ++i) {
      const Fused& m = motion[i];
      q.displacement[i] = m.displacement[k];
      q.velocity[i] = m.velocity[k];
      q.acceleration[i] = m.acceleration[k];
    }
    q.axial_load = load[k];
    composition.advance(state, q);
    for (std::size_t i = 0; i < 2; ++i)
      error(k, static_cast<Eigen::Index>(i)) = force[i][k] - q.force[i];
  }
  Eigen::Vector2d result;
  for (int i = 0; i < 2; ++i) {
    const auto slow = low_passed(error.col(i), 4, kComparedUpTo, step);
    result[i] = std::sqrt(slow.segment(2000, slow.size() - 4000).squaredNorm() /
                          static_cast<double>(slow.size() - 4000));
  }
  return result;
}

TEST(CaseOfARun, HoldsTheMeasurementsUnderBothEarthquakes) {
  const test::TemporaryFolder folder;
  const Case c = case_with(folder.path(), {});

  EXPECT_EQ(c.name, "srmd_lprb_2d");
  EXPECT_EQ(c.model.kind, ModelKind::Platen);
  EXPECT_EQ(c.model.fitted.size(), 4U);
  EXPECT_FALSE(c.model.table.has("lead_heating"));
  ASSERT_EQ(c.records.size(), 2U);
  EXPECT_EQ(c.records[0].use, Use::Fit);
  EXPECT_EQ(c.records[1].use, Use::HeldOut);
  EXPECT_EQ(c.records[1].name, "held_out.h5");
  for (const auto& record : c.records) {
    EXPECT_NEAR(record.time_step, 1e-3, 1e-9);
    EXPECT_NEAR(static_cast<double>(record.samples()), 14e3, 50);
    ASSERT_TRUE(record.quiet);
    EXPECT_NEAR(static_cast<double>(record.quiet->second), 2000, 30);
    ASSERT_EQ(record.channels.size(), 9U);
    // The weight, and the vertical motion that the machine's slow vertical axis follows.
    const auto load = channel(record, "vertical_force");
    EXPECT_NEAR(load.mean(), 9.6856e6, 1e4);
    EXPECT_GT((load.array() - load.mean()).abs().maxCoeff(), 0.05 * load.mean());
    for (const char* axis : kAxes) {
      // The compensated machine lags its command by a few milliseconds.
      const auto command = channel(record, std::string{"command."} + axis);
      const auto measured = channel(record, std::string{"displacement."} + axis);
      EXPECT_LT((measured - command).norm(), 0.1 * command.norm()) << axis;
      EXPECT_GT((measured - command).norm(), 0) << axis;
    }
  }
  // The two earthquakes differ.
  const auto first = channel(c.records[0], "force.long");
  const auto second = channel(c.records[1], "force.long");
  const auto shared = std::min(first.size(), second.size());
  EXPECT_GT((first.head(shared) - second.head(shared)).norm(), first.head(shared).norm() / 2);
}

TEST(CaseOfARun, IsExplainedByItsModelUnlessAnEffectIsOmitted) {
  const test::TemporaryFolder complete_folder;
  const test::TemporaryFolder incomplete_folder;
  const Case complete =
      case_with(complete_folder.path(), {"model.specimen.lead_heating.enabled=true",
                                         "model.machine.load_dependent_friction.enabled=true"});
  const Case incomplete = case_with(incomplete_folder.path(), {});

  // From 50 µm of noise on a bearing of 358 MN/m, most of which the sensor fusion removes.
  const Eigen::Vector2d explained = residual(complete), unexplained = residual(incomplete);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(explained[i], 6e3) << kAxes[i];
    EXPECT_GT(unexplained[i], 5 * explained[i]) << kAxes[i];
  }
}

// A copy of a recording without the rows of a span [s].
void copy_without(const std::filesystem::path& from, const std::filesystem::path& to, double begin,
                  double end) {
  const recording::Reader run{from};
  std::vector<SignalId> signals;
  std::vector<std::vector<double>> columns;
  for (const auto& name : run.names()) {
    signals.push_back(run.map().signal(name));
    columns.push_back(run.signal(name));
  }
  recording::RecordingInfo info;
  info.config = {{recording::kModelText, run.config(recording::kModelText)}};
  recording::Writer writer{to, run.map(), signals, info};
  std::vector<double> row(columns.size());
  for (std::size_t k = 0; k < run.rows(); ++k) {
    if (run.time()[k] > begin && run.time()[k] < end) continue;
    for (std::size_t i = 0; i < columns.size(); ++i) row[i] = columns[i][k];
    writer.append(from_seconds(run.time()[k]), row);
  }
  writer.close();
}

TEST(CaseOfARun, DoesNotCompareTheGapsOfTheRecorder) {
  const test::TemporaryFolder folder, short_gap, long_gap;
  const Case whole = case_with(folder.path(), {"duration_s=4", "held_out={}"});
  copy_without(folder.path() / "run.h5", short_gap.path() / "run.h5", 3.0005, 3.0035);
  copy_without(folder.path() / "run.h5", long_gap.path() / "run.h5", 3.0005, 3.0505);

  EXPECT_TRUE(whole.records[0].gaps.empty());
  EXPECT_TRUE(load_case(short_gap.path() / "run.h5").records[0].gaps.empty());
  const Case broken = load_case(long_gap.path() / "run.h5");
  ASSERT_EQ(broken.records[0].gaps.size(), 1U);
  const auto [last, next] = broken.records[0].gaps[0];
  EXPECT_EQ(next - last - 1, 50U);
  const auto measured = channel(whole.records[0], "force.long");
  const auto read = channel(broken.records[0], "force.long");
  const auto end = static_cast<Eigen::Index>(last) + 1, begin = static_cast<Eigen::Index>(next);
  EXPECT_EQ(read.head(end), measured.head(end));
  EXPECT_EQ(read.tail(read.size() - begin), measured.tail(measured.size() - begin));
}

TEST(CaseOfARun, NeedsARecordingWithTheAssumedModel) {
  const test::TemporaryFolder folder;
  const auto text = folder.write("none.h5", "no recording");

  EXPECT_EQ(test::error_of([&] { static_cast<void>(load_case(text)); }).find(text.string()), 0U);
  static_cast<void>(case_with(folder.path(), {"duration_s=2", "held_out={}"}));
  const auto numerical = folder.path() / "numerical.h5";
  EXPECT_EQ(test::error_of([&] { static_cast<void>(load_case(numerical)); }),
            numerical.string() +
                ": it contains no model of the simulation (/config/model): run the experiment "
                "again");
}

}  // namespace
}  // namespace rths::diagnosis
