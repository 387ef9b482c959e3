// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/noise.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/identification/constants.hpp>
#include <rths/maths/statistics.hpp>

#include "line_at_rest.hpp"

namespace rths::diagnosis {
namespace {

VectorXd stretch_of(const Channel& channel, std::size_t from, std::size_t to) {
  return Eigen::Map<const VectorXd>(channel.values.data() + from, static_cast<Index>(to - from));
}

// Standard deviation of the white noise on a smooth signal, from its third differences.
// Quantisation steps count as noise.
double jitter_of(const Channel& channel) {
  const auto& x = channel.values;
  std::vector<double> third;
  for (std::size_t i = 3; i < x.size(); ++i)
    third.push_back(std::abs(x[i] - 3 * x[i - 1] + 3 * x[i - 2] - x[i - 3]));
  if (third.empty()) return 0;
  return maths::median(std::move(third)) / kMedianOfGauss / std::sqrt(kVarianceOfThird);
}

// The same from the quietest tenth of the spectrum: motion fills only some bands.
double floor_of(const Channel& channel, double time_step) {
  if (channel.values.size() < kFloorWindows * kFloorWindow) return jitter_of(channel);
  const Spectrum spectrum =
      power_spectrum(stretch_of(channel, 0, channel.values.size()), kFloorWindow, time_step);
  std::vector<double> density(spectrum.density.begin() + kLeakageBins, spectrum.density.end());
  const double quiet = maths::of_rank(density, density.size() / 10);
  return std::sqrt(quiet / (2 * time_step));
}

// Samples of a channel at rest.
struct Rest {
  std::vector<Stretch> stretches;
  double square = 0, samples = 0;

  void add(const VectorXd& stretch, double time_step) {
    stretches.push_back({stretch.array() - stretch.mean(), time_step});
    square += stretches.back().samples.squaredNorm();
    samples += static_cast<double>(stretch.size());
  }
  // The frequency of a sine that is no noise; 0: there was none.
  double take_out_line() {
    const double frequency = remove_line(stretches);
    square = 0;
    for (const auto& stretch : stretches) square += stretch.samples.squaredNorm();
    return frequency;
  }
  [[nodiscard]] double deviation() const { return samples > 0 ? std::sqrt(square / samples) : 0; }
  [[nodiscard]] bool is_enough() const { return samples >= kFewestAtRest; }
};

// Sums of `width` neighbours, from running sums over blocks of that width, so that nothing is
// subtracted: a small signal beside a large one keeps its digits.
VectorXd running_sums(const VectorXd& x, Index width) {
  VectorXd from_begin = x, to_end = x;  // of the block
  for (Index i = 1; i < x.size(); ++i)
    if (i % width != 0) from_begin[i] += from_begin[i - 1];
  for (Index i = x.size() - 2; i >= 0; --i)
    if ((i + 1) % width != 0) to_end[i] += to_end[i + 1];
  VectorXd sums(x.size() - width + 1);
  for (Index i = 0; i < sums.size(); ++i)
    sums[i] = i % width == 0 ? to_end[i] : to_end[i] + from_begin[i + width - 1];
  return sums;
}

// Sums of weights 1 - |k|/(half + 1), times half + 1: two running means make a triangle.
VectorXd triangle_sums(const VectorXd& x, Index half) {
  VectorXd padded = VectorXd::Zero(x.size() + 2 * half);
  padded.segment(half, x.size()) = x;
  return running_sums(running_sums(padded, half + 1), half + 1);
}

VectorXd smoothed(const VectorXd& x, Index half) {
  return triangle_sums(x, half).cwiseQuotient(triangle_sums(VectorXd::Ones(x.size()), half));
}

VectorXd variance_of(const std::vector<VectorXd>& draws) {
  VectorXd variance = VectorXd::Zero(draws.empty() ? 0 : draws[0].size());
  for (const auto& draw : draws) variance += draw.cwiseAbs2() / static_cast<double>(draws.size());
  return variance;
}

// Sizes and colours fit the draws that they are estimated from better than other draws. Returns the
// factor on the variance that corrects this, from draws left out of the estimate.
double shrinkage(const std::vector<VectorXd>& draws, Index half, Index piece, Index first_row) {
  if (draws.size() < kDrawsForShrinkage) return 1;
  double sum = 0, count = 0;
  for (std::size_t first = 0; first + kDrawsLeftOut <= draws.size(); first += kDrawsLeftOut) {
    std::vector<VectorXd> kept, left;
    for (std::size_t i = 0; i < draws.size(); ++i)
      (i >= first && i < first + kDrawsLeftOut ? left : kept).push_back(draws[i]);
    const VaryingNoise noise{kept, half, piece, 1e-300};
    for (const auto& draw : left) {
      const VectorXd white = noise.whitened(draw);
      const Index rows = white.size() - first_row - kResidualOrder;
      if (rows <= 0) continue;
      sum += white.tail(rows).squaredNorm();
      count += static_cast<double>(rows);
    }
  }
  if (!(count > 0) || !std::isfinite(sum)) return 1;
  // The estimate from all draws is too small by less than that from the kept ones.
  const double share =
      static_cast<double>(draws.size() - kDrawsLeftOut) / static_cast<double>(draws.size());
  return std::max(1.0, 1 + share * (sum / count - 1));
}

std::map<std::string, Rest> rest_of(const std::vector<const Record*>& records) {
  std::map<std::string, Rest> at_rest;
  for (const Record* record : records)
    for (const auto& channel : record->channels)
      if (is_measured(channel.role) && record->quiet)
        at_rest[channel.role].add(stretch_of(channel, record->quiet->first, record->quiet->second),
                                  record->time_step);
  return at_rest;
}

bool is_seen(const std::map<std::string, Rest>& at_rest, const std::string& role) {
  const auto rest = at_rest.find(role);
  return rest != at_rest.end() && rest->second.is_enough();
}

// Stretches of all sensors of a family, divided by their deviations. Sensors of one family differ
// only in size, so that together they determine the colour better.
using Families = std::map<std::string, std::vector<Stretch>>;
Families families_of(const std::map<std::string, Rest>& at_rest) {
  Families families;
  for (const auto& [role, rest] : at_rest)
    for (const auto& [samples, time_step] : rest.stretches)
      if (rest.deviation() > 0)
        families[family_of(role)].push_back({samples / rest.deviation(), time_step});
  return families;
}

NoiseSpectrum spectrum_at_rest(const Rest& rest, const std::string& role,
                               const Families& families) {
  if (!(rest.deviation() > 0)) return {};
  return NoiseSpectrum{families.at(family_of(role))}.scaled(rest.deviation());
}

NoiseSpectrum spectrum_in_motion(const Channel& channel, double time_step) {
  return {std::min(jitter_of(channel), floor_of(channel, time_step)), time_step};
}

// By role of a measured channel: at rest, or else from the first record that has it.
std::map<std::string, NoiseSpectrum> spectra_of(const std::vector<const Record*>& records,
                                                const std::map<std::string, Rest>& at_rest) {
  const auto families = families_of(at_rest);
  std::map<std::string, NoiseSpectrum> by_role;
  for (const Record* record : records)
    for (const auto& channel : record->channels)
      if (is_measured(channel.role) && !by_role.contains(channel.role))
        by_role[channel.role] =
            is_seen(at_rest, channel.role)
                ? spectrum_at_rest(at_rest.at(channel.role), channel.role, families)
                : spectrum_in_motion(channel, record->time_step);
  return by_role;
}

// Standard deviation of each output. A constant output, of an axis at rest, has the largest of all.
VectorXd sizes_of(const MatrixXd& measured) {
  const VectorXd mean = measured.colwise().mean();
  VectorXd sizes(measured.cols());
  for (Index output = 0; output < measured.cols(); ++output)
    sizes[output] = std::sqrt((measured.col(output).array() - mean[output]).square().mean());
  const double largest = sizes.maxCoeff();
  for (Index output = 0; output < measured.cols(); ++output)
    if (sizes[output] <= kFilterRoundOff * std::abs(mean[output])) sizes[output] = largest;
  return sizes;
}

// The largest standard deviation of a channel in any record.
double largest_deviation(const std::vector<const Record*>& records, const std::string& role) {
  double largest = 0;
  for (const Record* record : records)
    if (const Channel* channel = record->find(role))
      largest = std::max(largest, maths::deviation(channel->values));
  return largest;
}

}  // namespace

SensorNoise::SensorNoise(const std::vector<const Record*>& records,
                         const std::vector<std::pair<std::string, double>>& stated,
                         const std::vector<std::pair<std::string, double>>& added)
    : added_{added} {
  auto at_rest = rest_of(records);
  for (auto& [role, rest] : at_rest)
    if (const double frequency = rest.take_out_line(); frequency > 0)
      lines_.push_back(fmt::format("{} has a sine of {:.2f} Hz at rest", role, frequency));
  by_role_ = spectra_of(records, at_rest);
  was_seen_at_rest_ = std::any_of(by_role_.begin(), by_role_.end(),
                                  [&](const auto& known) { return is_seen(at_rest, known.first); });
  source_ = was_seen_at_rest_ ? "intervals at rest"
                              : "differences between samples that motion cannot cause";
  if (!was_seen_at_rest_)
    for (const auto& [role, deviation] : stated) {
      stated_[role] = deviation;
      source_ = "the standard deviations stated in the case";
    }
  for (auto& [role, spectrum] : by_role_)
    if (!is_seen(at_rest, role) && !stated_.contains(role) &&
        spectrum.deviation() > kLargestGuess * largest_deviation(records, role)) {
      unknown_.push_back(role);
      spectrum = {};
    }
  if (!unknown_.empty())
    source_ = fmt::format("unknown for {}: the samples are too coarse to guess it",
                          fmt::join(unknown_, ", "));
}

double SensorNoise::deviation(const std::string& family) const {
  double most = 0;
  for (const auto& [role, spectrum] : by_role_)
    if (family_of(role) == family && !stated_.contains(role))
      most = std::max(most, spectrum.deviation());
  for (const auto& [role, deviation] : stated_)
    if (family_of(role) == family) most = std::max(most, deviation);
  return most;
}

NoiseGenerator SensorNoise::generator_like(const Record& record) const {
  NoiseGenerator generator;
  generator.empty_ = record;
  for (auto& channel : generator.empty_.channels) {
    NoiseGenerator::Drawn drawn;
    const auto samples = static_cast<Index>(channel.values.size());
    const auto stated = stated_.find(channel.role);
    const auto known = by_role_.find(channel.role);
    if (stated != stated_.end())
      drawn.generator =
          NoiseSpectrum{stated->second, record.time_step}.generator(samples, record.time_step);
    else if (known != by_role_.end())
      drawn.generator = known->second.generator(samples, record.time_step);
    for (const auto& [role, deviation] : added_)
      if (role == channel.role) drawn.white.push_back(deviation);
    generator.drawn_.push_back(std::move(drawn));
    std::fill(channel.values.begin(), channel.values.end(), 0.0);
  }
  return generator;
}

Record NoiseGenerator::draw(std::mt19937_64& random) const {
  Record noise = empty_;
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    auto& values = noise.channels[i].values;
    const VectorXd noisy = drawn_[i].generator.draw([&] { return normal(random); });
    std::copy(noisy.begin(), noisy.end(), values.begin());
    for (const double deviation : drawn_[i].white)
      for (double& value : values) value += deviation * normal(random);
  }
  return noise;
}

VaryingNoise::VaryingNoise(Index rows, double deviation)
    : deviation_{VectorXd::Constant(rows, deviation)}, piece_{rows}, colours_{{VectorXd{}, 1}} {}

VaryingNoise::VaryingNoise(const std::vector<VectorXd>& draws, Index half, Index piece,
                           double least)
    : deviation_{smoothed(variance_of(draws), half).cwiseSqrt().cwiseMax(least)}, piece_{piece} {
  std::vector<VectorXd> scaled;
  for (const auto& draw : draws) scaled.push_back(draw.cwiseQuotient(deviation_));
  for (Index first = 0; first == 0 || first + piece / 2 < deviation_.size(); first += piece) {
    const Index left = deviation_.size() - first;
    const Index size = left < piece + piece / 2 ? left : piece;
    std::vector<VectorXd> stretches;
    for (const auto& draw : scaled) stretches.push_back(draw.segment(first, size));
    colours_.push_back(auto_regression(stretches, kResidualOrder, kResidualRidge));
    // Without noise, whitening only divides by the least size.
    if (!(colours_.back().deviation > 0)) colours_.back().deviation = 1;
  }
}

Index VaryingNoise::order() const { return colours_.empty() ? 0 : colours_[0].coefficients.size(); }

double VaryingNoise::log_size() const {
  double sum = 0;
  for (const auto& colour : colours_) sum += std::log(colour.deviation);
  return deviation_.array().log().mean() + sum / static_cast<double>(colours_.size());
}

VaryingNoise VaryingNoise::steady(Index rows) const {
  // Sorted by the deviation of the innovations, by which whitening divides.
  std::vector<std::pair<double, std::size_t>> sizes;
  std::vector<double> deviations;
  for (std::size_t i = 0; i < colours_.size(); ++i) {
    const Index first = std::min(static_cast<Index>(i) * piece_, deviation_.size() - 1);
    const Index size = std::min(piece_, deviation_.size() - first);
    deviations.push_back(std::sqrt(deviation_.segment(first, size).cwiseAbs2().mean()));
    sizes.emplace_back(deviations.back() * colours_[i].deviation, i);
  }
  const std::size_t middle = maths::median(std::move(sizes)).second;
  VaryingNoise result{rows, deviations[middle]};
  result.colours_ = {colours_[middle]};
  return result;
}

VectorXd VaryingNoise::whitened(const VectorXd& noise) const {
  const VectorXd x = noise.cwiseQuotient(deviation_);
  VectorXd white(x.size());
  for (Index t = 0; t < x.size(); ++t) {
    const auto piece = std::min(static_cast<std::size_t>(t / piece_), colours_.size() - 1);
    const AutoRegression& colour = colours_[piece];
    const Index known = std::min(colour.coefficients.size(), t);
    white[t] = (x[t] - colour.coefficients.head(known).dot(x.segment(t - known, known).reverse())) /
               colour.deviation;
  }
  return white;
}

ResidualNoise::ResidualNoise(const std::vector<MatrixXd>& draws, const Drive& drive,
                             bool has_colour)
    : first_row_{drive.first_row} {
  const auto half = static_cast<Index>(std::max(1.0, kSmoothingTime / drive.time_step));
  const auto piece = std::max(kLeastPiece, static_cast<Index>(kPieceTime / drive.time_step));
  const VectorXd sizes = sizes_of(drive.measured);
  for (Index output = 0; output < drive.measured.cols(); ++output) {
    std::vector<VectorXd> noise;
    for (const auto& draw : draws) noise.push_back(draw.col(output));
    const double size = sizes[output];
    if (has_colour) {
      outputs_.emplace_back(noise, half, piece, 1e-6 * size + 1e-300);
      outputs_.back().grow(std::sqrt(shrinkage(noise, half, piece, first_row_)));
    } else {
      const double square = draws.empty() ? 0 : variance_of(noise).mean();
      outputs_.emplace_back(drive.rows(),
                            std::max(std::sqrt(square), kLeastErrorShare * size + 1e-300));
    }
  }
}

ResidualNoise ResidualNoise::steady(const Drive& drive) const {
  ResidualNoise result = *this;
  for (auto& output : result.outputs_) output = output.steady(drive.rows());
  result.first_row_ = drive.first_row;
  return result;
}

MatrixXd ResidualNoise::deviation() const {
  MatrixXd all(outputs_[0].deviation().size(), static_cast<Index>(outputs_.size()));
  for (Index output = 0; output < all.cols(); ++output)
    all.col(output) = outputs_[static_cast<std::size_t>(output)].deviation();
  return all;
}

double ResidualNoise::log_size() const {
  double sum = 0;
  for (const auto& output : outputs_) sum += output.log_size();
  return sum / static_cast<double>(outputs_.size());
}

MatrixXd ResidualNoise::whitened(const MatrixXd& residual) const {
  MatrixXd white(residual.rows(), residual.cols());
  for (Index output = 0; output < residual.cols(); ++output)
    white.col(output) = whitened(residual.col(output), output);
  return white;
}

VectorXd ResidualNoise::whitened(const VectorXd& residual, Index output) const {
  VectorXd white = outputs_[static_cast<std::size_t>(output)].whitened(residual);
  // The history before the first row is unknown.
  white.head(std::min(first_row_ + outputs_[0].order(), white.size())).setZero();
  return white;
}

}  // namespace rths::diagnosis
