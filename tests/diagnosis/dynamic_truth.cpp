// SPDX-License-Identifier: Apache-2.0
#include "dynamic_truth.hpp"

#include <algorithm>

namespace rths::diagnosis::test_support {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// States: displacements, velocities, memory, input after its lag.
class Chain {
 public:
  Chain(const Truth& truth, std::function<double(double)> input)
      : truth_{truth}, input_{std::move(input)}, n_{truth.masses.size()} {}

  [[nodiscard]] VectorXd rate(double t, const VectorXd& x) const {
    VectorXd rate = VectorXd::Zero(x.size());
    rate.head(n_) = x.segment(n_, n_);
    const double wanted = truth_.input ? truth_.input(input_, t) : input_(t);
    const double push = truth_.input_lag > 0 ? x[2 * n_ + 1] : wanted;
    if (truth_.input_lag > 0) rate[2 * n_ + 1] = (wanted - x[2 * n_ + 1]) / truth_.input_lag;
    VectorXd force = VectorXd::Zero(n_);
    force[truth_.pushed] += push;
    for (Index i = 0; i < n_; ++i) {
      const double d = x[i] - (i > 0 ? x[i - 1] : 0);
      const double v = x[n_ + i] - (i > 0 ? x[n_ + i - 1] : 0);
      const double f = resisting(i, d, v, x, rate);
      force[i] -= f;
      if (i > 0) force[i - 1] += f;
    }
    rate.segment(n_, n_) = force.cwiseQuotient(truth_.masses);
    return rate;
  }

  // The spring's end pushes the joint.
  void slide(const VectorXd& x) {
    const Index i = truth_.hysteretic;
    const double d = x[i] - (i > 0 ? x[i - 1] : 0);
    joint_ = std::clamp(joint_, d - truth_.gap / 2, d + truth_.gap / 2);
  }

 private:
  double resisting(Index i, double d, double v, const VectorXd& x, VectorXd& rate) const {
    double f = truth_.spring ? truth_.spring(i, d, v) : 0;
    if (i == truth_.hysteretic && truth_.memory_rate) {
      rate[2 * n_] = truth_.memory_rate(x[2 * n_], v);
      f += truth_.gain * x[2 * n_] * (truth_.grip ? truth_.grip(d) : 1);
    }
    if (i == truth_.hysteretic && truth_.gap > 0) {
      const double held = std::clamp(joint_, d - truth_.gap / 2, d + truth_.gap / 2);
      const bool moves =
          (held <= d - truth_.gap / 2 && v > 0) || (held >= d + truth_.gap / 2 && v < 0);
      return f + truth_.stiffness[i] * held + (moves ? truth_.damping[i] * v : 0);
    }
    return f + truth_.stiffness[i] * d + truth_.damping[i] * v;
  }

  const Truth& truth_;
  std::function<double(double)> input_;
  Index n_;
  double joint_ = 0;
};

}  // namespace

Eigen::MatrixXd motion_of(const Truth& truth, const std::vector<double>& input, double time_step) {
  Chain chain{truth, interpolated(input, time_step)};
  const Index n = truth.masses.size();
  const auto states = integrated([&](double t, const VectorXd& x) { return chain.rate(t, x); },
                                 VectorXd::Zero(2 * n + 2), input.size(), time_step,
                                 [&](const VectorXd& x) { chain.slide(x); });
  Eigen::MatrixXd motion(states.size(), n);
  for (Index i = 0; i < motion.rows(); ++i)
    motion.row(i) = states[static_cast<std::size_t>(i)].head(n).transpose();
  return motion;
}

}  // namespace rths::diagnosis::test_support
