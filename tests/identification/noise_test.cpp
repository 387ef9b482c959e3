// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/noise.hpp>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoiseStep = 0.01;

Channel channel_of(const std::string& role, const VectorXd& values) {
  return {role, "m", {values.begin(), values.end()}};
}

Record record_of_channels(const std::vector<Channel>& channels) {
  Record record;
  record.name = "one";
  record.time_step = kNoiseStep;
  record.channels = channels;
  return record;
}

// A deviation of n samples has a relative error of 1/√(2n). Three of these; the spectrum of the
// rest is scaled to it.
TEST(SensorNoise, IsThatOfQuietIntervals) {
  constexpr Index kQuiet = 4000;
  VectorXd force = 50 * sine_of(4, 8000);
  force.head(kQuiet) = (3 * gauss(kQuiet, 1, 1)).array() + 20;
  Record record = record_of_channels({channel_of("force.long", force)});
  record.quiet = {0, kQuiet};

  const SensorNoise noise{{&record}, {{"force.long", 99}}};

  EXPECT_TRUE(noise.was_seen_at_rest());
  EXPECT_EQ(noise.source(), "intervals at rest");
  EXPECT_NEAR(noise.deviation("force") / 3, 1, 3 / std::sqrt(2.0 * kQuiet));
}

// A path of few rows a cycle has large third differences without any noise.
TEST(SensorNoise, IsNotKnownWhereTheSamplesAreTooCoarse) {
  VectorXd coarse(400);
  for (Index i = 0; i < coarse.size(); ++i) coarse[i] = std::sin(2.0 * static_cast<double>(i));
  const Record record = record_of_channels({channel_of("force.long", coarse)});

  const SensorNoise guessed{{&record}, {}};
  EXPECT_FALSE(guessed.is_known());
  EXPECT_EQ(guessed.unknown(), std::vector<std::string>{"force.long"});
  EXPECT_EQ(guessed.deviation("force"), 0);
  EXPECT_EQ(guessed.source(), "unknown for force.long: the samples are too coarse to guess it");

  const SensorNoise stated{{&record}, {{"force.long", 0.01}}};
  EXPECT_TRUE(stated.is_known());
}

TEST(SensorNoise, IsGuessedWhereTheSamplesAreDense) {
  const Record record = record_of_channels(
      {channel_of("force.long", 50 * sine_of(4, 4000) + 0.5 * gauss(4000, 1, 1))});

  EXPECT_TRUE((SensorNoise{{&record}, {}}.is_known()));
}

// Noise of deviation 1 and a sine of deviation 2 and 3.1 Hz, with other phases in each record.
Record record_with_line(double phase, unsigned seed, double frequency = 3.1,
                        double time_step = kNoiseStep) {
  const auto samples = static_cast<Index>(std::lround(400 * kNoiseStep / time_step));
  VectorXd force = gauss(samples, 1, seed);
  for (Index i = 0; i < samples; ++i)
    force[i] +=
        2 * std::numbers::sqrt2 *
        std::sin(2 * std::numbers::pi * frequency * time_step * static_cast<double>(i) + phase);
  Record record = record_of_channels({channel_of("force.long", force)});
  record.time_step = time_step;
  record.quiet = {0, static_cast<std::size_t>(samples)};
  return record;
}

// The relative error of a deviation of n samples is 1/√(2n).
TEST(SensorNoise, HasNoLineThatAllRestsShare) {
  const Record one = record_with_line(0.4, 1), other = record_with_line(2, 2);

  const SensorNoise noise{{&one, &other}, {}};

  EXPECT_NEAR(noise.deviation("force"), 1, 3 / std::sqrt(2.0 * 800));
  ASSERT_EQ(noise.lines().size(), 1U);
  EXPECT_EQ(noise.lines()[0].substr(0, 35), "force.long has a sine of 3.10 Hz at");
}

// √(1 + 2²)
TEST(SensorNoise, KeepsALineOfOneRestOrOfDifferentFrequencies) {
  const Record one = record_with_line(0.4, 1), other = record_with_line(2, 2, 5.3);

  for (const SensorNoise& noise : {SensorNoise{{&one}, {}}, SensorNoise{{&one, &other}, {}}}) {
    EXPECT_NEAR(noise.deviation("force") / std::sqrt(5.0), 1, 3 / std::sqrt(2.0 * 400));
    EXPECT_TRUE(noise.lines().empty());
  }
}

// White noise of deviation 1 at rest, at 1 kHz, of density 2 Δt. A record at 100 Hz sees a tenth of
// its band: its samples have the variance 1/10, whichever record comes first. The error of a mean
// square of n samples is √(2/n); the smoothed spectrum is allowed as much again.
TEST(SensorNoise, HasOneDensityAtEverySamplingRate) {
  constexpr Index kRest = 20'000, kMoving = 4000;
  Record rest = record_of_channels({channel_of("force.long", gauss(kRest, 1, 1))});
  rest.time_step = kNoiseStep / 10;
  rest.quiet = {0, kRest};
  const Record moving = record_of_channels({channel_of("force.long", 50 * sine_of(4, kMoving))});

  for (const auto& records :
       {std::vector<const Record*>{&rest, &moving}, std::vector<const Record*>{&moving, &rest}}) {
    std::mt19937_64 random{1};
    const SensorNoise noise{records, {}};
    const VectorXd drawn = values_of(noise.generator_like(moving).draw(random).channels[0]);

    EXPECT_NEAR(drawn.squaredNorm() / kMoving / 0.1, 1, 6 * std::sqrt(2.0 / kMoving));
  }
}

TEST(SensorNoise, HasNoLineThatRestsOfDifferentRatesShare) {
  const Record one = record_with_line(0.4, 1);
  const Record other = record_with_line(2, 2, 3.1, kNoiseStep / 4);

  for (const SensorNoise& noise :
       {SensorNoise{{&one, &other}, {}}, SensorNoise{{&other, &one}, {}}}) {
    EXPECT_NEAR(noise.deviation("force"), 1, 3 / std::sqrt(2.0 * 2000));
    ASSERT_EQ(noise.lines().size(), 1U);
    EXPECT_EQ(noise.lines()[0].substr(0, 35), "force.long has a sine of 3.10 Hz at");
  }
}

TEST(SensorNoise, HasTheStatedDeviationAtEverySamplingRate) {
  constexpr Index kSamples = 5000;
  const VectorXd x = sine_of(4, kSamples);
  Record slow = record_of_channels({channel_of("force.long", x)});
  Record fast = slow;
  fast.time_step = kNoiseStep / 10;
  const SensorNoise noise{{&slow, &fast}, {{"force.long", 3}}};

  for (const Record* record : {&slow, &fast}) {
    std::mt19937_64 random{1};
    const VectorXd drawn = values_of(noise.generator_like(*record).draw(random).channels[0]);

    EXPECT_NEAR(std::sqrt(drawn.squaredNorm() / kSamples) / 3, 1, 3 / std::sqrt(2.0 * kSamples));
  }
}

TEST(SensorNoise, IsTheLargestOfAFamily) {
  const VectorXd x = sine_of(4, 200);
  const Record record = record_of_channels({channel_of("force.long", x), channel_of("force.lat", x),
                                            channel_of("displacement.long", x)});

  const SensorNoise noise{{&record}, {{"force.long", 2}, {"force.lat", 5}}};

  EXPECT_FALSE(noise.was_seen_at_rest());
  EXPECT_EQ(noise.deviation("force"), 5);
  EXPECT_EQ(noise.deviation("acceleration"), 0);
}

// The median of third differences. Their correlations -15/20, 6/20, -1/20 cost a factor of at most
// √(1 + 2 Σρ²) = 1.52 on the error of a median deviation of Gaussian samples, 1.17/√n.
TEST(SensorNoise, IsFoundOnASmoothSignal) {
  constexpr Index kSamples = 2000;
  const VectorXd x = 10 * sine_of(4, kSamples) + 0.2 * gauss(kSamples, 1, 3);
  const Record record = record_of_channels({channel_of("displacement.long", x)});

  const SensorNoise noise{{&record}, {}};

  EXPECT_NEAR(noise.deviation("displacement") / 0.2, 1, 3 * 1.52 * 1.17 / std::sqrt(kSamples));
}

TEST(SensorNoise, IsNotInCommandsAndInputs) {
  const VectorXd x = gauss(500, 1, 1);
  Record record = record_of_channels({channel_of("command.long", x), channel_of("input.voltage", x),
                                      channel_of("displacement.long", x)});
  record.quiet = {0, 400};
  const SensorNoise noise{{&record}, {}};
  std::mt19937_64 random{1};

  const Record drawn = noise.generator_like(record).draw(random);

  EXPECT_EQ(noise.deviation("command"), 0);
  EXPECT_EQ(values_of(drawn.channels[0]).norm(), 0);
  EXPECT_EQ(values_of(drawn.channels[1]).norm(), 0);
  EXPECT_GT(values_of(drawn.channels[2]).norm(), 0);
}

TEST(SensorNoise, AddsRoundingToItsDraws) {
  const VectorXd x = sine_of(4, 5000);
  const Record record = record_of_channels({channel_of("force.long", x)});
  const SensorNoise noise{{&record}, {{"force.long", 3}}, {{"force.long", 4}}};
  std::mt19937_64 random{1};

  const VectorXd drawn = values_of(noise.generator_like(record).draw(random).channels[0]);

  EXPECT_NEAR(std::sqrt(drawn.squaredNorm() / 5000) / 5, 1, 3 / std::sqrt(2.0 * 5000));
}

Drive drive_of(Index rows, Index outputs) {
  Drive drive;
  drive.time_step = kNoiseStep;
  drive.measured = MatrixXd::Zero(rows, outputs);
  return drive;
}

double lag_one(const VectorXd& x) {
  return x.tail(x.size() - 1).dot(x.head(x.size() - 1)) / x.squaredNorm();
}

TEST(ResidualNoise, DividesByTheRootMeanSquareIfItHasNoColour) {
  std::vector<MatrixXd> draws;
  for (unsigned seed = 1; seed <= 4; ++seed) draws.push_back(gauss(500, 2, seed) * 3);
  double square = 0;
  for (const auto& draw : draws) square += draw.col(1).squaredNorm() / 2000;

  const ResidualNoise noise{draws, drive_of(500, 2), false};

  const MatrixXd other = gauss(500, 2, 9);
  EXPECT_LT((noise.whitened(other).col(1) - other.col(1) / std::sqrt(square)).norm(), 1e-12);
  EXPECT_LT((noise.deviation().col(1).array() - std::sqrt(square)).abs().maxCoeff(), 1e-12);
}

// A recording cannot be more exact than 0.2 % of its own deviation.
TEST(ResidualNoise, HasALeastSizeIfItHasNoColour) {
  Drive drive = drive_of(500, 1);
  drive.measured = 50 * sine_of(3, 500);

  const ResidualNoise noise{{1e-9 * gauss(500, 1, 1)}, drive, false};

  EXPECT_NEAR(noise.deviation()(0, 0), 2e-3 * 50, 1e-12);
}

// An axis at rest: its error counts like that of the axis that moves.
TEST(ResidualNoise, OfAConstantOutputHasTheSizeOfTheOthers) {
  Drive drive = drive_of(500, 2);
  drive.measured.col(0) = sine_of(3, 500);
  drive.measured.col(1).setConstant(7);
  MatrixXd draw = gauss(500, 2, 1);
  draw.col(1).setZero();

  for (const bool has_colour : {true, false}) {
    const ResidualNoise noise{{1e-9 * draw, -1e-9 * draw}, drive, has_colour};

    // 1e-6 or 2e-3 of the sine, of standard deviation 1.
    const VectorXd white = noise.whitened(VectorXd::Constant(500, 1e-3), 1);
    EXPECT_NEAR(white.tail(400).mean(), has_colour ? 1e3 : 0.5, has_colour ? 1 : 1e-3);
  }
}

// Red noise, x(t) = 0.9 x(t-1) + e(t), in 16 draws of 3000 rows each. A draw that was not seen is
// white and of variance 1: the relative error of a mean square of n numbers is √(2/n), that of a
// correlation 1/√n. The size is smoothed over 25 correlated rows of 16 draws, with an error that
// the shrinkage corrects in the mean; it is allowed as much as the scatter.
TEST(ResidualNoise, WhitensNoiseOfItsColour) {
  constexpr Index kRows = 3000;
  const auto red = [](unsigned seed) {
    MatrixXd x = gauss(kRows, 1, seed);
    for (Index i = 1; i < kRows; ++i) x(i, 0) += 0.9 * x(i - 1, 0);
    return x;
  };
  std::vector<MatrixXd> draws;
  for (unsigned seed = 1; seed <= 16; ++seed) draws.push_back(red(seed));
  Drive drive = drive_of(kRows, 1);
  drive.first_row = 100;

  const VectorXd white = ResidualNoise{draws, drive, true}.whitened(red(99));

  const VectorXd rows = white.tail(kRows - 112);
  EXPECT_NEAR(rows.squaredNorm() / double(rows.size()), 1, 6 * std::sqrt(2.0 / kRows));
  EXPECT_LT(std::abs(lag_one(rows)), 3 / std::sqrt(kRows));
  EXPECT_EQ(white.head(112).norm(), 0);  // the first compared row, and the order of the colour
}

// The size changes tenfold in the middle. The mean square of 500 numbers is known to √(2/500), and
// their estimated size to about as much of the 16 draws' window of 50 rows: √(2/800).
TEST(VaryingNoise, EqualisesASizeThatChanges) {
  constexpr Index kRows = 1200, kHalfWidth = 25;
  const auto growing = [](unsigned seed) -> VectorXd {
    VectorXd x = gauss(kRows, 1, seed);
    x.tail(kRows / 2) *= 10;
    return x;
  };
  std::vector<VectorXd> draws;
  for (unsigned seed = 1; seed <= 16; ++seed) draws.push_back(growing(seed));

  const VectorXd white = VaryingNoise{draws, kHalfWidth, kRows / 2, 0}.whitened(growing(99));

  const double error = 3 * std::sqrt(2.0 / 500 + 2.0 / 800);
  EXPECT_NEAR(white.segment(50, 500).squaredNorm() / 500, 1, error);
  EXPECT_NEAR(white.segment(650, 500).squaredNorm() / 500, 1, error);
}

// A triangle of weights, also at the ends and beside a signal that is a million times as large: the
// sums have only positive parts, so that each has a relative error of a few round-offs.
TEST(VaryingNoise, HasASizeThatIsSmoothedByATriangle) {
  for (const Index half : {1, 4, 25, 90}) {
    VectorXd draw = gauss(70, 1, 3);
    draw.segment(20, 10) *= 1e6;

    const VectorXd deviation = VaryingNoise{{draw}, half, 70, 0}.deviation();

    for (Index i = 0; i < draw.size(); ++i) {
      double sum = 0, weights = 0;
      for (Index k = std::max<Index>(0, i - half); k < std::min<Index>(70, i + half + 1); ++k) {
        const double weight = 1 - std::abs(double(k - i)) / double(half + 1);
        sum += weight * draw[k] * draw[k];
        weights += weight;
      }
      EXPECT_NEAR(deviation[i] / std::sqrt(sum / weights), 1, 1e-13) << half << " " << i;
    }
  }
}

TEST(VaryingNoise, OfOneSizeDividesByIt) {
  const VaryingNoise noise{50, 4};

  EXPECT_EQ(noise.whitened(VectorXd::Constant(50, 8)), VectorXd::Constant(50, 2));
  EXPECT_DOUBLE_EQ(noise.log_size(), std::log(4));
  EXPECT_EQ(noise.order(), 0);
}

// Three pieces of sizes 1, 3 and 10: the median is 3, within the error of 16 draws of 300 rows.
TEST(VaryingNoise, IsSteadyAtItsMedianSize) {
  const auto steps = [](unsigned seed) -> VectorXd {
    VectorXd x = gauss(900, 1, seed);
    x.segment(300, 300) *= 3;
    x.tail(300) *= 10;
    return x;
  };
  std::vector<VectorXd> draws;
  for (unsigned seed = 1; seed <= 16; ++seed) draws.push_back(steps(seed));

  const VaryingNoise steady = VaryingNoise{draws, 1, 300, 0}.steady(70);

  ASSERT_EQ(steady.deviation().size(), 70);
  // One row beside the tenfold step has a share of the larger size: less than 100/4/300 of 9.
  EXPECT_NEAR(steady.deviation()[0] / 3, 1, 3 / std::sqrt(2.0 * 16 * 300) + 0.5 * 25.0 / 300 / 9);
  EXPECT_EQ(steady.deviation().maxCoeff(), steady.deviation().minCoeff());
}

}  // namespace
}  // namespace rths::diagnosis
