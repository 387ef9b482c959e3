// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/calibration.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include <Eigen/Core>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/commissioning/recorded.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/fourier.hpp>
#include <rths/maths/robust_covariance.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/recording/recording.hpp>

namespace rths::commissioning {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSegment = 8;         // of the averaged spectra [s]
constexpr double kLeastMotion = 5e-4;  // RMS of the reference [m]
constexpr double kSearch = 0.2;        // largest delay [s]
constexpr double kLeastPower = 1e-6;   // of the strongest frequency: weaker ones are left out
constexpr int kLeastFrequencies = 6;

/// Averaged spectra of all records.
struct Spectra {
  double spacing = 0;  ///< [Hz]
  Eigen::VectorXd power;
  Eigen::VectorXcd cross;
};

Eigen::VectorXcd windowed_spectrum(const std::vector<double>& values, std::size_t begin,
                                   Eigen::Index length) {
  const std::span part{values.data() + begin, static_cast<std::size_t>(length)};
  Eigen::VectorXd windowed = Eigen::Map<const Eigen::VectorXd>{part.data(), length};
  windowed.array() -= maths::mean(part);
  windowed.array() *= maths::hann_window(length, 0).array();
  return maths::half_spectrum(windowed);
}

// The displacement is moved by the delay first, so that both segments hold the same motion; the
// phase of the delay is restored in the response.
Spectra spectra_of(const std::vector<AxisCharacter>& records, double delay) {
  Spectra spectra;
  for (const auto& record : records) {
    const auto length = static_cast<Eigen::Index>(std::llround(kSegment / record.interval));
    if (spectra.power.size() > 0 && spectra.power.size() != length / 2 + 1)
      throw Error{fmt::format("calibration: rows every {} s and every {} s, expected one interval",
                              records.front().interval, record.interval)};
    const auto moved = static_cast<std::size_t>(std::max(0L, std::lround(delay / record.interval)));
    spectra.spacing = 1 / (static_cast<double>(length) * record.interval);
    for (std::size_t begin = 0;
         begin + static_cast<std::size_t>(length) + moved <= record.reference.size();
         begin += static_cast<std::size_t>(length / 4)) {
      const auto input = windowed_spectrum(record.reference, begin, length);
      const auto output = windowed_spectrum(record.displacement, begin + moved, length);
      if (spectra.power.size() == 0) {
        spectra.power = Eigen::VectorXd::Zero(input.size());
        spectra.cross = Eigen::VectorXcd::Zero(input.size());
      }
      spectra.power += input.cwiseAbs2();
      for (Eigen::Index i = 0; i < input.size(); ++i)
        spectra.cross[i] +=
            std::conj(input[i]) * output[i] *
            std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(i) * spectra.spacing *
                                static_cast<double>(moved) * record.interval);
    }
  }
  if (spectra.power.size() == 0) {
    double longest = 0;
    for (const auto& record : records)
      longest = std::max(longest, static_cast<double>(record.reference.size()) * record.interval);
    throw Error{fmt::format("calibration: the longest record has {:.3g} s, expected more than {} s",
                            longest, kSegment)};
  }
  return spectra;
}

/// Rows of the fit: real and imaginary part of each frequency of the band.
struct LeadRows {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd wanted;
};

LeadRows lead_rows(const Spectra& spectra, const CalibrationSettings& settings) {
  std::vector<Eigen::Index> used;
  const auto first = static_cast<Eigen::Index>(std::ceil(settings.from / spectra.spacing));
  const auto last = std::min(spectra.power.size() - 1,
                             static_cast<Eigen::Index>(std::floor(settings.to / spectra.spacing)));
  const double strongest = spectra.power.maxCoeff();
  for (Eigen::Index i = std::max<Eigen::Index>(1, first); i <= last; ++i)
    if (spectra.power[i] > kLeastPower * strongest) used.push_back(i);
  if (used.size() < kLeastFrequencies)
    throw Error{
        fmt::format("calibration: {} frequencies between {} and {} Hz have motion, expected "
                    "at least {}",
                    used.size(), settings.from, settings.to, kLeastFrequencies)};
  const auto count = static_cast<Eigen::Index>(used.size());
  LeadRows rows{Eigen::MatrixXd(2 * count, 3), Eigen::VectorXd::Zero(2 * count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = used[static_cast<std::size_t>(k)];
    const double weight = std::sqrt(spectra.power[i] / strongest);
    const std::complex<double> response = spectra.cross[i] / spectra.power[i];
    const double omega = 2 * std::numbers::pi * static_cast<double>(i) * spectra.spacing;
    const std::complex<double> terms[] = {response, std::complex<double>{0, omega} * response,
                                          -omega * omega * response};
    for (Eigen::Index c = 0; c < 3; ++c) {
      rows.jacobian(2 * k, c) = weight * terms[c].real();
      rows.jacobian(2 * k + 1, c) = weight * terms[c].imag();
    }
    rows.wanted[2 * k] = weight;
  }
  return rows;
}

}  // namespace

AxisCalibration calibrate_axis(const std::vector<AxisCharacter>& records,
                               const CalibrationSettings& settings) {
  if (records.empty()) throw Error{"calibration: no record, expected at least one"};
  AxisCalibration axis;
  for (const auto& record : records) {
    if (!(maths::rms(record.reference) >= kLeastMotion))
      throw Error{fmt::format("calibration: the reference moves less than {} m RMS", kLeastMotion)};
    const auto fit =
        maths::fit_delay(record.reference, record.displacement, record.interval, kSearch);
    if (&record == &records.front() || fit.delay_95 < axis.delay.delay_95) axis.delay = fit;
  }
  const auto rows = lead_rows(spectra_of(records, axis.delay.delay), settings);
  const Eigen::VectorXd size = rows.jacobian.colwise().norm();
  const Eigen::VectorXd lead =
      maths::solve_least_squares(rows.jacobian * size.cwiseInverse().asDiagonal(), rows.wanted)
          .cwiseQuotient(size);
  const Eigen::VectorXd residual = rows.wanted - rows.jacobian * lead;
  // Neighbouring frequencies share the window: four rows are correlated.
  const Eigen::MatrixXd covariance = maths::robust_covariance(rows.jacobian, residual, 4);
  for (Eigen::Index i = 0; i < 3; ++i)
    axis.lead[static_cast<std::size_t>(i)] = {lead[i],
                                              maths::kHalfWidth95 * std::sqrt(covariance(i, i))};
  axis.remaining = residual.norm() / rows.wanted.norm();
  return axis;
}

double Calibration::velocity_gain() const {
  double lag = 0;
  for (const auto& axis : axes) lag += axis.lead[1].value;
  return std::max(0.0, settings.feed_forward_share * lag / static_cast<double>(axes.size()));
}

std::array<double, 3> Calibration::initial() const {
  std::array<double, 3> mean{};
  for (const auto& axis : axes)
    for (std::size_t i = 0; i < 3; ++i)
      mean[i] += axis.lead[i].value / static_cast<double>(axes.size());
  mean[1] -= velocity_gain();
  return mean;
}

Calibration calibrate(const std::vector<std::filesystem::path>& files,
                      const CalibrationSettings& settings) {
  Calibration calibration;
  calibration.files = files;
  calibration.settings = settings;
  for (const std::string& name : names_of(kHorizontal)) {
    std::vector<AxisCharacter> records;
    for (const auto& file : files) {
      const recording::Reader run{file};
      for (const auto& axis : recording::roles_of(run).axes) {
        if (axis.axis != name) continue;
        auto data = recording::of_file(file, [&] {
          return recorded(run, {axis.reference, axis.machine_displacement});
        });
        records.push_back({data.interval, std::move(data.values[0]), std::move(data.values[1])});
      }
    }
    if (records.empty()) continue;
    try {
      calibration.axes.push_back(calibrate_axis(records, settings));
      calibration.axes.back().name = name;
    } catch (const Error& error) {
      throw Error{fmt::format("{}: {}", name, error.what())};
    }
  }
  if (calibration.axes.empty()) throw Error{"the recordings have no axis long or lat"};
  return calibration;
}

std::string text_of(const Calibration& calibration) {
  std::string text;
  for (const auto& axis : calibration.axes)
    text += fmt::format(
        "{}: delay {:.2f} ± {:.2f} ms; lead in {:g}–{:g} Hz, 95 % intervals\n"
        "  a0 {:.4f} ± {:.4f}   a1 {:.2f} ± {:.2f} ms   a2 {:.0f} ± {:.0f} ms²   remaining error "
        "{:.2f} %\n",
        axis.name, 1e3 * axis.delay.delay, 1e3 * axis.delay.delay_95, calibration.settings.from,
        calibration.settings.to, axis.lead[0].value, axis.lead[0].half_width,
        1e3 * axis.lead[1].value, 1e3 * axis.lead[1].half_width, 1e6 * axis.lead[2].value,
        1e6 * axis.lead[2].half_width, 1e2 * axis.remaining);
  const auto initial = calibration.initial();
  text += fmt::format("feed-forward {:.2f} ms, ATS from {:.4f}, {:.2f} ms, {:.0f} ms²\n",
                      1e3 * calibration.velocity_gain(), initial[0], 1e3 * initial[1],
                      1e6 * initial[2]);
  return text;
}

std::string json_of(const Calibration& calibration) {
  const auto initial = calibration.initial();
  Json document{{"band_Hz", {calibration.settings.from, calibration.settings.to}},
                {"velocity_gain_s", calibration.velocity_gain()},
                {"initial", {initial[0], initial[1], initial[2]}},
                {"axes", Json::object()}};
  for (const auto& axis : calibration.axes) {
    Json json{{"delay_s", axis.delay.delay},
              {"delay_95_s", axis.delay.delay_95},
              {"remaining", axis.remaining}};
    for (std::size_t i = 0; i < 3; ++i)
      json[fmt::format("a{}", i)] = {{"value", axis.lead[i].value},
                                     {"half_width_95", axis.lead[i].half_width}};
    document["axes"][axis.name] = json;
  }
  return document.dump(2) + "\n";
}

std::string toml_of(const Calibration& calibration) {
  std::string text =
      "# Compensation of the machine, from characterisation tests:\n#   rths calibrate";
  for (const auto& file : calibration.files) text += " " + file.string();
  text += "\n";
  for (const auto& axis : calibration.axes)
    text += fmt::format("# {}: delay {:.2f} ± {:.2f} ms; lead {:.4f}, {:.2f} ms, {:.0f} ms²\n",
                        axis.name, 1e3 * axis.delay.delay, 1e3 * axis.delay.delay_95,
                        axis.lead[0].value, 1e3 * axis.lead[1].value, 1e6 * axis.lead[2].value);
  const auto initial = calibration.initial();
  text += fmt::format("[ats]\ninitial = [{:.6g}, {:.6g}, {:.6g}]\n", initial[0], initial[1],
                      initial[2]);
  text += fmt::format("[feed_forward]\nvelocity_gain_s = {:.6g}\n", calibration.velocity_gain());
  return text;
}

}  // namespace rths::commissioning
