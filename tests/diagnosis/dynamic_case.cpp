// SPDX-License-Identifier: Apache-2.0
#include "dynamic_case.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

namespace rths::diagnosis::test_support {

std::vector<double> random_signal(unsigned seed, std::size_t samples, double time_step,
                                  double low_Hz, double high_Hz, double rms) {
  std::mt19937_64 random{seed};
  std::uniform_real_distribution<double> uniform;
  constexpr int kSines = 60;
  std::vector<double> signal(samples, 0.0);
  for (int i = 0; i < kSines; ++i) {
    const double frequency = low_Hz + (high_Hz - low_Hz) * uniform(random);
    const double phase = 2 * std::numbers::pi * uniform(random);
    for (std::size_t j = 0; j < samples; ++j)
      signal[j] +=
          rms * std::sqrt(2.0 / kSines) *
          std::sin(2 * std::numbers::pi * frequency * static_cast<double>(j) * time_step + phase);
  }
  // Starts from rest: the amplitude grows over the first tenth.
  const double swell = 0.1 * static_cast<double>(samples);
  for (std::size_t j = 0; j < samples; ++j)
    signal[j] *= std::min(1.0, static_cast<double>(j) / swell);
  return signal;
}

std::vector<double> noise(unsigned seed, std::size_t samples, double deviation) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal{0, deviation};
  std::vector<double> values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

std::vector<Eigen::VectorXd> integrated(
    const std::function<Eigen::VectorXd(double, const Eigen::VectorXd&)>& rate,
    const Eigen::VectorXd& start, std::size_t samples, double time_step,
    const std::function<void(const Eigen::VectorXd&)>& after) {
  constexpr int kSubsteps = 20;
  const double h = time_step / kSubsteps;
  std::vector<Eigen::VectorXd> states{start};
  Eigen::VectorXd x = start;
  for (std::size_t i = 1; i < samples; ++i) {
    for (int substep = 0; substep < kSubsteps; ++substep) {
      const double t =
          (static_cast<double>(i - 1) + static_cast<double>(substep) / kSubsteps) * time_step;
      const Eigen::VectorXd k1 = rate(t, x), k2 = rate(t + h / 2, x + h / 2 * k1),
                            k3 = rate(t + h / 2, x + h / 2 * k2), k4 = rate(t + h, x + h * k3);
      x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      if (after) after(x);
    }
    states.push_back(x);
  }
  return states;
}

std::function<double(double)> interpolated(const std::vector<double>& samples, double time_step) {
  return [&samples, time_step](double t) {
    const double position =
        std::min(std::max(t / time_step, 0.0), static_cast<double>(samples.size() - 1) - 1e-9);
    const auto before = static_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(before);
    return samples[before] * (1 - fraction) + samples[before + 1] * fraction;
  };
}

void CaseFolder::write(const std::string& file, const Columns& columns) const {
  std::string text;
  for (const auto& [name, values] : columns) text += (text.empty() ? "" : ",") + name;
  text += "\n";
  for (std::size_t i = 0; i < columns.begin()->second.size(); ++i) {
    std::string row;
    for (const auto& [name, values] : columns)
      row += fmt::format("{}{:.15g}", row.empty() ? "" : ",", values[i]);
    text += row + "\n";
  }
  static_cast<void>(folder_.write(file, text));
}

Case CaseFolder::load(const std::string& toml) const {
  static_cast<void>(folder_.write("case.toml", toml));
  return load_case(folder_.path());
}

Eigen::MatrixXd prediction(const Relation& relation, const Hypothesis& hypothesis,
                           const Record& record) {
  const auto drive = relation.prepare(record);
  const auto simulator = relation.simulator(hypothesis, *drive);
  Eigen::MatrixXd result;
  std::vector<Eigen::MatrixXd> none;
  if (!simulator->run(hypothesis.values, {}, result, none))
    throw std::runtime_error{"the prediction diverges"};
  return result;
}

double relative_error(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace rths::diagnosis::test_support
