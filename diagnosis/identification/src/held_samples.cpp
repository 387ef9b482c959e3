// SPDX-License-Identifier: Apache-2.0
#include "form_search.hpp"

#include <algorithm>
#include <cmath>

#include <rths/identification/constants.hpp>

namespace rths::diagnosis {
namespace {

// Sums of squares about the mean of any piece of a signal over the variance of its noise, from
// running sums.
class Scatter {
 public:
  Scatter(const VectorXd& signal, const VectorXd& deviation) {
    const double middle = signal.mean();
    for (Index i = 0; i < signal.size(); ++i) {
      const double weight = 1 / (deviation[i] * deviation[i]), x = signal[i] - middle;
      const Sums& last = sums_.back();
      sums_.push_back(
          {last.weight + weight, last.first + weight * x, last.second + weight * x * x});
    }
  }
  [[nodiscard]] double operator()(Index begin, Index end) const {
    const Sums &a = sums_[static_cast<std::size_t>(begin)],
               &b = sums_[static_cast<std::size_t>(end)];
    const double first = b.first - a.first;
    return b.second - a.second - first * first / (b.weight - a.weight);
  }

 private:
  struct Sums {
    double weight, first, second;
  };
  std::vector<Sums> sums_{{0, 0, 0}};
};

Index longest_hold(Index rows) {
  return std::clamp(static_cast<Index>(kLongestHold * static_cast<double>(rows)), kShortestHold,
                    kMostHoldRows);
}

struct HeldPiece {
  Index begin, end;  // rows that repeat the one before `begin`
};

// Pieces in which a measurement is constant while its prediction moves, but for noise: those of the
// largest total gain in log-likelihood over a measurement that moves as predicted. The means of the
// pieces do not count, so that a delay or an offset is no hold.
// @param price  of a hold [nat]   @param first  row that is compared
std::vector<HeldPiece> holds_of(const VectorXd& measured, const VectorXd& prediction,
                                const VectorXd& deviation, double price, Index first) {
  const Scatter held{measured, deviation}, moving{measured - prediction, deviation};
  const Index rows = measured.size();
  const Index longest = longest_hold(rows);
  // Best total of the rows before each row, and where its last hold begins.
  VectorXd best = VectorXd::Zero(rows + 1);
  std::vector<Index> begin(static_cast<std::size_t>(rows + 1), -1);
  for (Index end = first + 1; end <= rows; ++end) {
    best[end] = best[end - 1];
    for (Index length = kShortestHold; length <= std::min(longest, end - first - 1); ++length) {
      const Index from = end - length;
      const double scatter = held(from, end);
      if (scatter > kMostScatter * static_cast<double>(length)) continue;
      const double gain = (moving(from, end) - scatter) / 2 - price;
      if (gain <= 0 || best[from] + gain <= best[end]) continue;
      best[end] = best[from] + gain;
      begin[static_cast<std::size_t>(end)] = from;
    }
  }
  std::vector<HeldPiece> holds;
  for (Index end = rows; end > 0;) {
    const Index from = begin[static_cast<std::size_t>(end)];
    if (from >= 0) holds.push_back({from, end});
    end = from >= 0 ? from : end - 1;
  }
  return holds;
}

// A hold that is longer than the longest piece is several pieces, the last one first.
std::vector<HeldPiece> joined(const std::vector<HeldPiece>& pieces) {
  std::vector<HeldPiece> holds;
  for (const HeldPiece& piece : pieces) {
    if (!holds.empty() && holds.back().begin == piece.end)
      holds.back().begin = piece.begin;
    else
      holds.push_back(piece);
  }
  return holds;
}

// Whether the measurement jumps behind holds to where the prediction has gone. That of a signal
// that saturates, sticks or has a plateau goes on from where it is.
bool end_in_jumps(const std::vector<HeldPiece>& holds, const VectorXd& measured,
                  const VectorXd& prediction) {
  double jumped = 0, last = 0, largest = 0;
  for (const auto& [begin, end] : joined(holds)) {
    const VectorXd change = prediction.segment(begin, end - begin).array() - prediction[begin - 1];
    const double gone = change[change.size() - 1];
    const Index behind = std::min(end + kHoldEdge, measured.size()) - 1;
    jumped += gone * (measured[behind] - measured[end - 1]);
    last += gone * gone;
    largest += change.cwiseAbs2().maxCoeff();
  }
  return last > largest / 2 && jumped > last / 2;
}

// The signal without the rows of the holds and their edges, which a filter smears.
VectorXd outside(const std::vector<HeldPiece>& holds, VectorXd signal) {
  for (const auto& [begin, end] : holds) {
    const Index from = std::max<Index>(0, begin - kHoldEdge);
    signal.segment(from, std::min(signal.size(), end + kHoldEdge) - from).setZero();
  }
  return signal;
}

// Energy of the whitened residual in holds, beyond the mean energy of as many rows outside.
double energy_in(const std::vector<HeldPiece>& holds, const VectorXd& residual,
                 const ResidualNoise& noise, Index output) {
  const auto rows = static_cast<double>(residual.size());
  const double rows_outside = outside(holds, VectorXd::Ones(residual.size())).sum();
  if (rows_outside < (1 - kMostHeld) * rows) return 0;
  return noise.whitened(residual, output).squaredNorm() -
         noise.whitened(outside(holds, residual), output).squaredNorm() * rows / rows_outside;
}

}  // namespace

void find_held_samples(const TestedHypothesis& tested, const Folds& folds,
                       std::vector<Description>& found) {
  const Problem& problem = tested.problem();
  double energy = 0;
  for (const auto& share : folds.both.shares) {
    const Drive& drive = problem.drive(share.record);
    const ResidualNoise& noise = problem.noise(share.record);
    const MatrixXd predictions = tested.prediction(share.record);
    const auto rows = static_cast<double>(drive.rows());
    const double lengths = std::min(kLongestHold * rows, static_cast<double>(kMostHoldRows));
    const double price = std::log(rows * lengths);  // of one of all possible holds
    for (Index output = 0; output < drive.measured.cols(); ++output) {
      const VectorXd measured = drive.measured.col(output), prediction = predictions.col(output);
      const auto holds =
          holds_of(measured, prediction, noise.deviation().col(output), price, drive.first_row);
      if (holds.empty() || !end_in_jumps(holds, measured, prediction)) continue;
      VectorXd residual = measured - prediction;
      if (share.weight.size() > 0) residual.array() *= share.weight;
      energy +=
          energy_in(holds, residual, noise, output) - 2 * price * static_cast<double>(holds.size());
    }
  }
  const double part = std::min(1.0, energy / excess_on(tested, folds.both));
  found.push_back({"held samples", part, "", {}, {}, {}, Description::Over::Records});
}

}  // namespace rths::diagnosis
