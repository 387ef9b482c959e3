// SPDX-License-Identifier: Apache-2.0
#include "form_search.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/identification/constants.hpp>
#include <rths/identification/screening.hpp>

namespace rths::diagnosis {
namespace {

// The sudden change of one parameter that explains most of a residual.
struct ParameterChange {
  double explained = 0;  // energy
  double time = 0;       // [s]
};

// The part of a parameter's derivative from row `cut` of each output on.
VectorXd from_row(const MatrixXd& jacobian, Index column, Index cut, const Drive& drive) {
  VectorXd g = jacobian.col(column);
  for (Index output = 0; output < drive.measured.cols(); ++output)
    g.segment(output * drive.rows(), cut).setZero();
  return g;
}

// Tries 40 times of change on one record. Sets `parameter` to the name of the best one's parameter.
ParameterChange best_change(const VectorXd& w, const MatrixXd& J, const Complement& complement,
                            const Drive& drive, const Hypothesis& hypothesis,
                            std::string& parameter) {
  ParameterChange best;
  for (int k = 0; k < 40; ++k) {
    const auto cut = static_cast<Index>((0.12 + 0.0165 * k) * static_cast<double>(drive.rows()));
    for (Index j = 0; j < J.cols(); ++j) {
      VectorXd g = from_row(J, j, cut, drive);
      complement.take_out(g);
      const double square = g.squaredNorm();
      const double explained = square > 0 ? std::pow(g.dot(w), 2) / square : 0;
      if (explained <= best.explained) continue;
      best = {explained, drive.start + static_cast<double>(cut) * drive.time_step};
      parameter = hypothesis.free[static_cast<std::size_t>(j)].name;
    }
  }
  return best;
}

std::string at_time(const std::string& parameter, double time, bool has_time) {
  return has_time ? fmt::format("change of {} at {:.1f} s", parameter, time)
                  : fmt::format("change of {} at row {:.0f}", parameter, time);
}

}  // namespace

void find_change(const TestedHypothesis& tested, const Folds& folds,
                 std::vector<Description>& found) {
  const auto& hypothesis = tested.hypothesis();
  const std::vector<Index> all = all_of(hypothesis);
  double gain = 0, excess = 0;
  std::vector<double> times;
  std::string parameter;
  for (const auto& share : folds.both.shares) {
    const Fold one = compared(tested.problem(), {share.record});
    VectorXd w;
    MatrixXd J;
    if (!tested.evaluate(one, hypothesis.values, all, w, J)) return;
    const Complement complement{J};
    complement.take_out(w);
    const ParameterChange best =
        best_change(w, J, complement, tested.problem().drive(share.record), hypothesis, parameter);
    gain += best.explained;
    excess += w.squaredNorm() - observations(tested.problem(), one);
    times.push_back(best.time);
  }
  if (times.size() < 2) return;
  excess = std::max(excess, kLeastExcess * observations(tested.problem(), folds.both));
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  const double share = gain / excess * (*last - *first < 1.5 ? 1 : 0.5);
  found.push_back({at_time(parameter, times[0], tested.problem().drive(0).has_time),
                   share,
                   "",
                   {},
                   {},
                   {},
                   Description::Over::Records});
}

}  // namespace rths::diagnosis
