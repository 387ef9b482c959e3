// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/loop_stability.hpp>

#include <cmath>
#include <numbers>
#include <utility>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/sim/loop_test.hpp>

namespace rths::commissioning {
namespace {

using Complex = std::complex<double>;

constexpr double kLowest = 0.02, kHighest = 60;  // [Hz] of the model time
constexpr int kFrequencies = 5000;               // 0.16 % apart: modes of 1 % damping are resolved
constexpr double kCoarseDelay = 1e-3;            // of the search of a margin [s]
constexpr double kCoarseGain = 1.1;
constexpr int kBisections = 12;
constexpr Complex kI{0, 1};

// H(iω): x_b of K x + iω C x − ω² M x = L, for the degrees of freedom of one axis.
std::vector<Complex> flexibility_of(const sim::PlantMatrices& plant, int axis,
                                    const std::vector<double>& omega) {
  const Eigen::Index n = plant.dofs() / 2;
  const auto own = Eigen::seqN(Eigen::Index{axis}, n, Eigen::Index{2});
  const Eigen::MatrixXd M = plant.M(own, own), C = plant.C(own, own), K = plant.K(own, own);
  std::vector<Complex> flexibility;
  Eigen::MatrixXd matrix(2 * n, 2 * n);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(2 * n);
  load[0] = plant.bearings;  // the basemat comes first
  for (const double w : omega) {
    const Eigen::MatrixXd real = K - w * w * M, imaginary = w * C;
    matrix << real, -imaginary, imaginary, real;
    const Eigen::VectorXd x = maths::solve_least_squares(matrix, load);
    flexibility.emplace_back(x[0], x[n]);
  }
  return flexibility;
}

std::vector<double> frequencies() {
  std::vector<double> omega;
  for (int i = 0; i < kFrequencies; ++i)
    omega.push_back(2 * std::numbers::pi * kLowest *
                    std::pow(kHighest / kLowest, static_cast<double>(i) / (kFrequencies - 1)));
  return omega;
}

// Smallest value above `low` at which `is_unstable`, between two neighbours of a coarse search.
template <class Unstable>
double bisected(double low, double high, Unstable is_unstable) {
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (is_unstable(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

std::complex<double> transfer_at(const sim::AxisTransfer& machine, std::complex<double> stiffness,
                                 double mass, double omega) {
  const Complex s = kI * omega;
  const double valve = 2 * std::numbers::pi * machine.valve_frequency;
  const Complex spool =
      valve * valve / (s * s + 2 * machine.valve_damping * valve * s + valve * valve);
  const double washout = 2 * std::numbers::pi * machine.pressure_washout;
  const Complex fed_back = machine.pressure_feedback * (washout > 0 ? s / (s + washout) : 1);
  const Complex force = stiffness + mass * s * s;  // of the actuator per displacement
  const Complex stiff = force * (spool * fed_back + machine.leakage + s * machine.compliance);
  return machine.gain * spool * std::exp(-s * machine.transport_delay) /
         (s + machine.gain * spool + stiff);
}

std::complex<double> describing_function(const sim::Bearing& bearing, double amplitude,
                                         double frequency) {
  sim::LoopTest test;
  test.amplitude_long = amplitude;
  test.frequency = frequency;
  test.cycles = 3;
  test.time_step = sim::time_step_of(frequency);
  const auto loop = sim::run_loop_test(bearing, test);
  const auto cycle = static_cast<std::size_t>(std::llround(1 / (frequency * test.time_step)));
  Complex force = 0, motion = 0;
  for (std::size_t i = loop.time.size() - cycle; i < loop.time.size(); ++i) {
    const Complex turn = std::polar(1.0, -2 * std::numbers::pi * frequency * loop.time[i]);
    force += loop.force_long[i] * turn;
    motion += loop.displacement_long[i] * turn;
  }
  return force / motion;
}

HybridLoop::HybridLoop(const sim::PlantMatrices& plant, int axis, const sim::AxisTransfer& machine,
                       double mass, const LinearLead& lead, double extra_delay, double rate)
    : omega_{frequencies()},
      flexibility_{flexibility_of(plant, axis, omega_)},
      machine_{machine},
      mass_{mass},
      extra_delay_{extra_delay},
      rate_{rate},
      lead_{lead} {}

HybridLoop::HybridLoop(std::vector<double> omega, std::vector<std::complex<double>> flexibility,
                       std::vector<std::complex<double>> transfer)
    : omega_{std::move(omega)},
      flexibility_{std::move(flexibility)},
      given_transfer_{std::move(transfer)} {
  if (omega_.size() != flexibility_.size() || omega_.size() != given_transfer_.size())
    throw Error{"hybrid loop: frequencies, flexibility and transfer function differ in length"};
}

std::vector<std::complex<double>> HybridLoop::transfer(std::complex<double> stiffness) const {
  if (!given_transfer_.empty()) return given_transfer_;
  std::vector<Complex> transfer;
  for (const double model_omega : omega_) {
    const double w = model_omega / rate_;
    const Complex s = kI * w;
    const Complex machine =
        std::exp(-s * extra_delay_) * transfer_at(machine_, stiffness, mass_, w);
    Complex command = 0;
    for (std::size_t k = lead_.command.size(); k-- > 0;) command = command * s + lead_.command[k];
    const Complex by_force = (lead_.force[0] + lead_.force[1] * s) * stiffness;
    transfer.push_back(command * machine / (1.0 - by_force * machine));
  }
  return transfer;
}

int HybridLoop::poles_of(std::complex<double> stiffness,
                         const std::vector<std::complex<double>>& transfer, double delay,
                         double gain) const {
  double phase = 0;
  Complex before = 0;
  for (std::size_t i = 0; i < omega_.size(); ++i) {
    const Complex open = stiffness * flexibility_[i];
    const Complex ratio =
        (1.0 + gain * open * transfer[i] * std::polar(1.0, -omega_[i] * delay)) / (1.0 + open);
    if (i > 0) phase += std::arg(ratio / before);
    before = ratio;
  }
  // At both ends the ratio is real and positive; what is left of its phase there is not a turn.
  return static_cast<int>(std::lround(-phase / std::numbers::pi));
}

int HybridLoop::unstable_poles(std::complex<double> stiffness, double delay, double gain) const {
  return poles_of(stiffness, transfer(stiffness), delay, gain);
}

double HybridLoop::delay_margin(std::complex<double> stiffness, double most) const {
  const auto response = transfer(stiffness);
  const auto is_unstable = [&](double delay) {
    return poles_of(stiffness, response, delay, 1) > 0;
  };
  if (is_unstable(0)) return 0;
  for (double delay = kCoarseDelay; delay < most; delay += kCoarseDelay)
    if (is_unstable(delay)) return bisected(delay - kCoarseDelay, delay, is_unstable);
  return most;
}

double HybridLoop::gain_margin(std::complex<double> stiffness, double most) const {
  const auto response = transfer(stiffness);
  const auto is_unstable = [&](double gain) { return poles_of(stiffness, response, 0, gain) > 0; };
  if (is_unstable(1)) return 1;
  for (double gain = kCoarseGain; gain < most; gain *= kCoarseGain)
    if (is_unstable(gain)) return bisected(gain / kCoarseGain, gain, is_unstable);
  return most;
}

}  // namespace rths::commissioning
