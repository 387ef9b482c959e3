// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/problem.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/identification/constants.hpp>

namespace rths::diagnosis {
namespace {

// Of problems that report to nobody.
DiagnosisProgress& no_progress() {
  thread_local DiagnosisProgress progress;
  return progress;
}

// Removes the component along a constant.
void take_out(const VectorXd& constant, Eigen::Ref<VectorXd> x) {
  const double square = constant.squaredNorm();
  if (square > 0) x -= constant * (constant.dot(x) / square);
}

// Removes the mean of the compared rows of each output.
void take_out_offsets(const Drive& drive, MatrixXd& residual) {
  residual.rowwise() -= drive.compared_rows(residual).colwise().mean().eval();
}

// Appends the rows of a ridge to a residual and its derivatives.
void append_ridge(const VectorXd& ridge, const VectorXd& change, VectorXd& residual,
                  MatrixXd& jacobian) {
  if (ridge.size() == 0) return;
  const Index rows = residual.size();
  residual.conservativeResize(rows + ridge.size());
  residual.tail(ridge.size()) = ridge.cwiseProduct(change);
  if (jacobian.cols() == 0) return;
  jacobian.conservativeResize(residual.size(), Eigen::NoChange);
  jacobian.bottomRows(ridge.size()) = ridge.asDiagonal();
}

// ½ Σ w² of every block of a fold's rows.
std::vector<double> block_sums(const Problem& problem, const Fold& fold, const VectorXd& residual) {
  std::vector<double> sums;
  Index first = 0;
  for (const auto& share : fold.shares) {
    const Drive& drive = problem.drive(share.record);
    const Index rows = drive.rows(), outputs = drive.measured.cols();
    const double length = static_cast<double>(rows) * drive.time_step;
    // Short records are divided into some tens of blocks, for resampling.
    const double least = 8 * drive.time_step;
    const double seconds = std::clamp(length / 30, least, std::max(least, kScoreBlock));
    const auto size = std::max<Index>(1, static_cast<Index>(seconds / drive.time_step));
    for (Index row = 0; row < rows; row += size) {
      const Index count = std::min(size, rows - row);
      if (share.weight.size() > 0 && !(share.weight.segment(row, count) > 0).any()) continue;
      double sum = 0;
      for (Index output = 0; output < outputs; ++output)
        sum += residual.segment(first + output * rows + row, count).squaredNorm();
      sums.push_back(sum / 2);
    }
    first += rows * outputs;
  }
  return sums;
}

}  // namespace

Problem::Problem(const Relation& relation, const std::vector<const Record*>& records,
                 const SensorNoise& noise, std::uint64_t seed, std::size_t draws)
    : relation_{&relation},
      has_colour_{noise.was_seen_at_rest()},
      is_noise_known_{noise.is_known()},
      progress_{&no_progress()} {
  for (std::size_t i = 0; i < records.size(); ++i) {
    RecordData data{records[i], relation.prepare(*records[i]), {}, {}, nullptr};
    std::mt19937_64 random{seed * 1000 + i};
    const NoiseGenerator generator = noise.generator_like(*records[i]);
    while (data.disturbed.size() < draws)
      for (auto& drive : relation.disturbed(*data.drive, generator.draw(random)))
        data.disturbed.push_back(std::move(drive));
    // Few draws are enough for a first fit.
    data.draws = draws_of(data, relation.base(), kFewDraws);
    data.noise = std::make_unique<ResidualNoise>(data.draws, *data.drive, has_colour_);
    records_.push_back(std::move(data));
  }
}

Problem::Problem(const Problem& like, const std::vector<const Record*>& tests)
    : relation_{like.relation_},
      has_colour_{like.has_colour_},
      is_noise_known_{like.is_noise_known_},
      progress_{like.progress_} {
  for (const Record* test : tests) {
    RecordData data{test, relation_->prepare(*test), {}, {}, nullptr};
    data.noise = std::make_unique<ResidualNoise>(like.noise(0).steady(*data.drive));
    records_.push_back(std::move(data));
  }
}

Problem Problem::disturbed(std::size_t draw) const {
  Problem result;
  result.relation_ = relation_;
  result.has_colour_ = has_colour_;
  result.is_noise_known_ = is_noise_known_;
  result.progress_ = progress_;
  for (const auto& data : records_)
    result.records_.push_back(
        {data.record, data.disturbed[draw % data.disturbed.size()], {}, {}, data.noise});
  return result;
}

std::vector<MatrixXd> Problem::draws_of(const RecordData& data, const Hypothesis& hypothesis,
                                        std::size_t most) const {
  auto draws = possible_draws(data, hypothesis, most);
  if (!draws)
    throw Error{fmt::format("{}: the model has no prediction ({}): it diverges", data.record->name,
                            relation_->name())};
  return *std::move(draws);
}

std::optional<std::vector<MatrixXd>> Problem::possible_draws(const RecordData& data,
                                                             const Hypothesis& hypothesis,
                                                             std::size_t most) const {
  std::vector<MatrixXd> none;
  MatrixXd still, moved;
  if (!relation_->simulator(hypothesis, *data.drive)->run(hypothesis.values, {}, still, none))
    return std::nullopt;
  std::vector<MatrixXd> draws;
  for (const auto& drive : data.disturbed) {
    if (draws.size() == most) break;
    stop_if_interrupted();
    if (!relation_->simulator(hypothesis, *drive)->run(hypothesis.values, {}, moved, none))
      continue;
    draws.emplace_back((drive->measured - moved) - (data.drive->measured - still));
    // A residual has no offset if that is free, so its noise has none either.
    if (relation_->has_free_offsets()) take_out_offsets(*data.drive, draws.back());
  }
  return draws;
}

void Problem::renew_noise(const Hypothesis& hypothesis) {
  for (auto& data : records_) {
    auto draws = possible_draws(data, hypothesis, data.disturbed.size());
    if (!draws) continue;
    data.draws = *std::move(draws);
    data.noise = std::make_unique<ResidualNoise>(data.draws, *data.drive, has_colour_);
  }
}

std::vector<MatrixXd> Problem::draws_at(const Hypothesis& hypothesis, std::size_t record) const {
  return draws_of(records_[record], hypothesis, kFewDraws);
}

std::optional<double> Problem::log_noise(const Hypothesis& hypothesis) const {
  double sum = 0;
  for (const auto& data : records_) {
    const auto draws = possible_draws(data, hypothesis, kFewDraws);
    if (!draws) return std::nullopt;
    sum += ResidualNoise{*draws, *data.drive, has_colour_}.log_size();
  }
  return sum / static_cast<double>(records_.size());
}

TestedHypothesis::TestedHypothesis(const Problem& problem, Hypothesis hypothesis)
    : problem_{&problem}, hypothesis_{std::move(hypothesis)} {
  for (std::size_t i = 0; i < hypothesis_.free.size(); ++i) {
    double& value = hypothesis_.values[static_cast<Index>(i)];
    value = std::clamp(value, hypothesis_.free[i].low, hypothesis_.free[i].high);
  }
  for (std::size_t i = 0; i < problem.records(); ++i)
    simulators_.push_back(problem.relation().simulator(hypothesis_, problem.drive(i)));
}

TestedHypothesis::TestedHypothesis(const TestedHypothesis& like, Hypothesis hypothesis)
    : TestedHypothesis{like.problem(), std::move(hypothesis)} {
  for (std::size_t i = 0; i < simulators_.size(); ++i) simulators_[i]->share(*like.simulators_[i]);
}

void TestedHypothesis::keep(const Fold& fold) {
  for (const auto& share : fold.shares) simulators_[share.record]->keep(hypothesis_.values);
}

MatrixXd TestedHypothesis::prediction(std::size_t record) const {
  MatrixXd result;
  std::vector<MatrixXd> none;
  if (!simulators_[record]->run(hypothesis_.values, {}, result, none)) return {};
  return result;
}

MatrixXd TestedHypothesis::whitened(std::size_t record) const {
  const Drive& drive = problem_->drive(record);
  VectorXd residual;
  MatrixXd none;
  if (!evaluate(compared(*problem_, {record}), hypothesis_.values, {}, residual, none))
    throw Error{fmt::format("{}: the model has no prediction", problem_->record(record).name)};
  return Eigen::Map<const MatrixXd>(residual.data(), drive.rows(), drive.measured.cols());
}

bool TestedHypothesis::stack(const Fold::Share& share, const VectorXd& values,
                             const std::vector<Index>& wanted, Index first, VectorXd& residual,
                             MatrixXd& jacobian) const {
  const Drive& drive = problem_->drive(share.record);
  const ResidualNoise& noise = problem_->noise(share.record);
  MatrixXd prediction;
  std::vector<MatrixXd> derivatives;
  const Simulator& simulator = *simulators_[share.record];
  problem_->progress().add_steps(static_cast<double>(drive.rows() * simulator.work_per_row()) *
                                 static_cast<double>(1 + wanted.size()));
  if (!simulator.run(values, wanted, prediction, derivatives)) return false;
  const Index rows = drive.rows(), outputs = drive.measured.cols();
  const bool has_offsets = problem_->relation().has_free_offsets();
  const MatrixXd constants =
      has_offsets ? noise.whitened(MatrixXd::Ones(rows, outputs)) : MatrixXd{};
  const auto put = [&](const MatrixXd& white, auto column) {
    for (Index output = 0; output < outputs; ++output) {
      VectorXd x = white.col(output);
      if (share.weight.size() > 0) x.array() *= share.weight;
      if (has_offsets) {
        VectorXd constant = constants.col(output);
        if (share.weight.size() > 0) constant.array() *= share.weight;
        take_out(constant, x);
      }
      column.segment(first + output * rows, rows) = x;
    }
  };
  put(noise.whitened(drive.measured - prediction), residual.col(0));
  for (std::size_t i = 0; i < derivatives.size(); ++i)
    put(noise.whitened(-derivatives[i]), jacobian.col(static_cast<Index>(i)));
  return true;
}

bool TestedHypothesis::evaluate(const Fold& fold, const VectorXd& values,
                                const std::vector<Index>& wanted, VectorXd& residual,
                                MatrixXd& jacobian) const {
  stop_if_interrupted();
  Index size = 0;
  for (const auto& share : fold.shares) {
    const auto& measured = problem_->drive(share.record).measured;
    size += measured.size();
  }
  residual.resize(size);
  jacobian.resize(size, static_cast<Index>(wanted.size()));
  Index first = 0;
  for (const auto& share : fold.shares) {
    if (!stack(share, values, wanted, first, residual, jacobian)) return false;
    first += problem_->drive(share.record).measured.size();
  }
  return residual.allFinite() && jacobian.allFinite();
}

Fit TestedHypothesis::fit(const Fold& fold, int most_iterations, const VectorXd& ridge) const {
  FitProblem least;
  const auto all = all_of(hypothesis_);
  const auto count = static_cast<Index>(all.size());
  least.start = hypothesis_.values;
  least.low = least.high = least.scale = VectorXd(count);
  for (Index i = 0; i < count; ++i) {
    const auto& free = hypothesis_.free[static_cast<std::size_t>(i)];
    least.low[i] = free.low;
    least.high[i] = free.high;
    least.scale[i] = free.scale;
  }
  for (const auto& share : fold.shares) least.rows += problem_->drive(share.record).measured.size();
  least.most_iterations = most_iterations;
  least.tolerance = 1e-5;
  least.wants_jacobian = false;
  if (count == 0) {
    Fit fit;
    fit.parameters = hypothesis_.values;
    MatrixXd none;
    if (evaluate(fold, fit.parameters, {}, fit.residual, none)) {
      fit.sum_of_squares = fit.residual.squaredNorm();
      fit.converged = true;
    }
    return fit;
  }
  least.rows += ridge.size();
  least.residuals = [&](const VectorXd& values, VectorXd& residual, MatrixXd* jacobian) {
    MatrixXd slopes;
    if (!evaluate(fold, values, jacobian != nullptr ? all : std::vector<Index>{}, residual, slopes))
      return false;
    append_ridge(ridge, values - least.start, residual, slopes);
    if (jacobian != nullptr) *jacobian = std::move(slopes);
    return true;
  };
  Fit fit = least_squares(least);
  problem_->progress().count();
  return fit;
}

std::vector<double> TestedHypothesis::blocks(const Fold& fold) const {
  VectorXd residual;
  MatrixXd none;
  if (!evaluate(fold, hypothesis_.values, {}, residual, none)) return {};
  return block_sums(*problem_, fold, residual);
}

std::vector<double> TestedHypothesis::noise_blocks(const Fold& fold) const {
  std::vector<double> sums;
  for (const auto& share : fold.shares) {
    const auto draws = problem_->draws_at(hypothesis_, share.record);
    std::vector<double> mean;
    for (const auto& draw : draws) {
      MatrixXd white = problem_->noise(share.record).whitened(draw);
      if (share.weight.size() > 0) white.array().colwise() *= share.weight;
      const auto one = block_sums(*problem_, {{share}}, white.reshaped());
      mean.resize(one.size());
      for (std::size_t i = 0; i < one.size(); ++i)
        mean[i] += one[i] / static_cast<double>(draws.size());
    }
    sums.insert(sums.end(), mean.begin(), mean.end());
  }
  return sums;
}

double TestedHypothesis::variance(const Fold& fold) const {
  double sum = 0;
  for (const double block : blocks(fold)) sum += 2 * block;
  return sum / observations(*problem_, fold);
}

double observations(const Problem& problem, const Fold& fold) {
  double count = 0;
  for (const auto& share : fold.shares) {
    const Drive& drive = problem.drive(share.record);
    const double rows = share.weight.size() > 0
                            ? share.weight.tail(drive.rows() - drive.first_row).sum()
                            : static_cast<double>(drive.rows() - drive.first_row);
    count += rows * static_cast<double>(drive.measured.cols());
  }
  return count;
}

Fold compared(const Problem& problem, const std::vector<std::size_t>& records) {
  Fold fold;
  for (const std::size_t record : records)
    fold.shares.push_back({record, problem.drive(record).present});
  return fold;
}

}  // namespace rths::diagnosis
