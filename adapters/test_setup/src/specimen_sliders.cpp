// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/specimen_sliders.hpp>

#include <algorithm>
#include <cmath>

namespace rths::adapters {
namespace {

// The first move: samples are equally spaced on a logarithmic scale.
constexpr double kSpeed = 0.2;      // [m/s]
constexpr double kTimeStep = 2e-5;  // [s]
constexpr double kLongest = 0.15;   // [m]
constexpr double kSpacing = 1.15;   // of samples
constexpr double kFirst = 2e-5;     // [m]
constexpr double kSpringReach = 1;  // of the slider that stands for a spring [m]
constexpr double kFinest = 1e-4, kCoarsest = 0.1, kRatio = 1.09;  // of other reaches [m], [m], [-]
constexpr double kGoodEnough = 5e-3;                              // of the force, RMS [-]
constexpr std::size_t kMostSliders = 7;
constexpr int kSweeps = 300;

struct FirstMove {
  std::vector<double> displacement, force;  // [m], [N]
};

FirstMove first_move_of(const sim::Bearing& bearing) {
  FirstMove move;
  sim::BearingRun run{bearing, kTimeStep};
  double next = kFirst;
  for (double u = kSpeed * kTimeStep; u <= kLongest; u += kSpeed * kTimeStep) {
    const double force = run.advance({u, 0}, {kSpeed, 0}, bearing.axial_load)[0];
    if (u < next) continue;
    move.displacement.push_back(u);
    move.force.push_back(force);
    next = u * kSpacing;
  }
  return move;
}

struct Slider {
  double reach = 0;
  bool is_smooth = false;
  [[nodiscard]] double state_at(double displacement) const {
    const double share = displacement / reach;
    return is_smooth ? std::tanh(share) : std::min(share, 1.0);
  }
};

/// Sliders with their best strengths, which are not negative.
struct Candidate {
  std::vector<Slider> sliders;
  std::vector<double> strengths;
  double error = 0;  ///< RMS over that of the force [-]
};

Candidate fitted(std::vector<Slider> sliders, const FirstMove& move) {
  const std::size_t n = sliders.size(), samples = move.force.size();
  std::vector<std::vector<double>> states(n, std::vector<double>(samples));
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < samples; ++i)
      states[j][i] = sliders[j].state_at(move.displacement[i]);
  const auto product = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < samples; ++i) sum += a[i] * b[i];
    return sum;
  };
  std::vector<std::vector<double>> normal(n, std::vector<double>(n));
  std::vector<double> right(n);
  for (std::size_t j = 0; j < n; ++j) {
    right[j] = product(states[j], move.force);
    for (std::size_t k = 0; k < n; ++k) normal[j][k] = product(states[j], states[k]);
  }
  Candidate found{std::move(sliders), std::vector<double>(n), 0};
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t j = 0; j < n; ++j) {
      double rest = right[j];
      for (std::size_t k = 0; k < n; ++k)
        if (k != j) rest -= normal[j][k] * found.strengths[k];
      found.strengths[j] = std::max(0.0, rest / normal[j][j]);
    }
  double apart = product(move.force, move.force);
  const double all = apart;
  for (std::size_t j = 0; j < n; ++j) {
    apart -= 2 * found.strengths[j] * right[j];
    for (std::size_t k = 0; k < n; ++k)
      apart += found.strengths[j] * normal[j][k] * found.strengths[k];
  }
  found.error = all > 0 ? std::sqrt(std::max(0.0, apart) / all) : 0;
  return found;
}

// The best with one slider more.
Candidate extended(const Candidate& before, const FirstMove& move) {
  Candidate best = before;
  for (double reach = kFinest; reach <= kCoarsest; reach *= kRatio)
    for (const bool is_smooth : {false, true}) {
      auto sliders = before.sliders;
      sliders.push_back({reach, is_smooth});
      Candidate candidate = fitted(std::move(sliders), move);
      if (candidate.error < best.error) best = std::move(candidate);
    }
  return best;
}

}  // namespace

SpecimenSliders sliders_of(const sim::Bearing& bearing) {
  const FirstMove move = first_move_of(bearing);
  Candidate best = fitted({{kSpringReach, false}}, move);
  while (best.error > kGoodEnough && best.sliders.size() < kMostSliders) {
    Candidate more = extended(best, move);
    if (more.sliders.size() == best.sliders.size()) break;
    best = std::move(more);
  }
  std::vector<std::size_t> order(best.sliders.size());
  for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Slider &one = best.sliders[a], &other = best.sliders[b];
    return one.is_smooth != other.is_smooth ? other.is_smooth : one.reach < other.reach;
  });
  SpecimenSliders found;
  for (const std::size_t j : order) {
    const Slider& slider = best.sliders[j];
    if (best.strengths[j] <= 0 && slider.reach != kSpringReach) continue;
    (slider.is_smooth ? found.smooth : found.sharp).push_back(slider.reach);
    found.strengths.push_back(best.strengths[j]);
  }
  return found;
}

}  // namespace rths::adapters
