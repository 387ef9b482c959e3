// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/bands.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>

#include <Eigen/Core>

#include <rths/maths/fourier.hpp>

namespace rths::maths {
namespace {

constexpr double kEdges[] = {0, 1, 3, 6, 11, 25};  // of the bands [Hz]; the last one is open
constexpr double kLeastCommand = 1e-3;  // of its largest magnitude: less is lost in sensor noise
constexpr double kSegment = 4;          // [s]: resolves 0.25 Hz
constexpr std::size_t kLeastSegments = 3;
constexpr int kRefinements = 4;  // of a delay: each is exact if the band is narrow

// Mean square of a signal by frequency; the sum over all frequencies is that of the signal.
class Energy {
 public:
  Energy(const Eigen::VectorXd& values, double interval) {
    // Lengths with large prime factors are slow to transform; zeros change no sum.
    Eigen::Index length = 4;  // the least that Eigen transforms to half a spectrum
    while (length < values.size()) length *= 2;
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(length);
    padded.head(values.size()) = values;
    spacing_ = 1 / (static_cast<double>(length) * interval);
    power_ = half_spectrum(padded).cwiseAbs2() * 2;
    power_[0] /= 2;
    power_[power_.size() - 1] /= 2;
    power_ /= static_cast<double>(length) * static_cast<double>(values.size());
  }
  // RMS of the part in a band.
  [[nodiscard]] double size(double from, double to) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < power_.size(); ++i) {
      const double frequency = static_cast<double>(i) * spacing_;
      if (frequency >= from && frequency < to) sum += power_[i];
    }
    return std::sqrt(sum);
  }

 private:
  double spacing_;
  Eigen::VectorXd power_;
};

// Spectra of command and measurement, averaged over segments.
class AveragedSpectra {
 public:
  AveragedSpectra(const Eigen::VectorXd& command, const Eigen::VectorXd& measured, double interval)
      : interval_{interval} {
    const auto length = static_cast<Eigen::Index>(std::lround(kSegment / interval));
    spacing_ = 1 / (static_cast<double>(length) * interval);
    const Eigen::ArrayXd phase =
        Eigen::ArrayXd::LinSpaced(length, 0, 2 * M_PI * (1 - 1 / static_cast<double>(length)));
    const Eigen::ArrayXd window = (1 - phase.cos()) / 2;
    for (Eigen::Index begin = 0; begin + length <= command.size(); begin += length / 2)
      add(half_spectrum(command.segment(begin, length).array() * window),
          half_spectrum(measured.segment(begin, length).array() * window));
  }
  [[nodiscard]] bool is_averaged() const { return segments_ >= kLeastSegments; }
  // RMS of the command in a band. The window suppresses leakage from other bands.
  [[nodiscard]] double command_rms(double from, double to) const {
    constexpr double kWindowPower = 3.0 / 8;  // mean square of the window
    const double length = 1 / (spacing_ * interval_);
    const double sum = command_(bins(from, to)).sum();
    return std::sqrt(2 * sum / (kWindowPower * length * length * static_cast<double>(segments_)));
  }
  [[nodiscard]] BandTracking::Response response(double from, double to, double near) const;
  [[nodiscard]] Coherence coherence() const;

 private:
  void add(const Eigen::VectorXcd& command, const Eigen::VectorXcd& measured) {
    if (segments_++ == 0) {
      command_ = measured_ = Eigen::VectorXd::Zero(command.size());
      cross_ = Eigen::VectorXcd::Zero(command.size());
    }
    command_ += command.cwiseAbs2();
    measured_ += measured.cwiseAbs2();
    cross_ += command.conjugate().cwiseProduct(measured);
  }
  // Cross-spectrum of a range of frequencies as it would be without a delay of the measurement.
  [[nodiscard]] std::complex<double> without_delay(Eigen::Index first, Eigen::Index last,
                                                   double delay) const {
    std::complex<double> sum = 0;
    for (Eigen::Index i = first; i <= last; ++i)
      sum += cross_[i] * std::polar(1.0, 2 * M_PI * static_cast<double>(i) * spacing_ * delay);
    return sum;
  }

  // Indices of the frequencies of a band without 0.
  [[nodiscard]] Eigen::ArithmeticSequence<Eigen::Index, Eigen::Index> bins(double from,
                                                                           double to) const {
    const auto index = [&](double frequency) {
      return static_cast<Eigen::Index>(std::ceil(frequency / spacing_));
    };
    const Eigen::Index first = std::max<Eigen::Index>(1, index(from));
    return {first, std::min(command_.size(), index(to)) - first};
  }

  std::size_t segments_ = 0;
  double spacing_ = 0, interval_ = 0;
  Eigen::VectorXd command_, measured_;
  Eigen::VectorXcd cross_;
};

BandTracking::Response AveragedSpectra::response(double from, double to, double near) const {
  const auto range = bins(from, to);
  const Eigen::Index first = range.first(), last = first + range.size() - 1;
  const Eigen::VectorXd power = command_(range);
  const Eigen::VectorXd frequency =
      Eigen::VectorXd::LinSpaced(power.size(), static_cast<double>(first),
                                 static_cast<double>(last)) *
      spacing_;
  const double centre = power.dot(frequency) / power.sum();
  double delay = near;
  for (int i = 0; i < kRefinements; ++i)
    delay -= std::arg(without_delay(first, last, delay)) / (2 * M_PI * centre);
  const Eigen::VectorXd coherence =
      cross_(range).cwiseAbs2().cwiseQuotient(power.cwiseProduct(measured_(range)));
  return {without_delay(first, last, delay).real() / power.sum(), delay,
          power.dot(coherence) / power.sum()};
}

Coherence AveragedSpectra::coherence() const {
  Coherence all;
  for (Eigen::Index i = 1; i < command_.size(); ++i) {
    const double power = command_[i] * measured_[i];
    all.frequency.push_back(static_cast<double>(i) * spacing_);
    all.value.push_back(power > 0 ? std::norm(cross_[i]) / power : 0);
  }
  return all;
}

}  // namespace

std::optional<double> Coherence::least(double from, double to) const {
  std::optional<double> least;
  for (std::size_t i = 0; i < frequency.size(); ++i)
    if (frequency[i] >= from && frequency[i] <= to)
      least = std::min(value[i], least.value_or(value[i]));
  return least;
}

Coherence coherence_of(const std::vector<double>& command, const std::vector<double>& measured,
                       double interval) {
  const auto size = static_cast<Eigen::Index>(command.size());
  const AveragedSpectra spectra{Eigen::Map<const Eigen::VectorXd>{command.data(), size},
                                Eigen::Map<const Eigen::VectorXd>{measured.data(), size}, interval};
  return spectra.is_averaged() ? spectra.coherence() : Coherence{};
}

std::vector<BandTracking> track_bands(const std::vector<double>& command,
                                      const std::vector<double>& measured, double interval,
                                      double delay) {
  const auto size = static_cast<Eigen::Index>(command.size());
  const Eigen::Map<const Eigen::VectorXd> x{command.data(), size}, y{measured.data(), size};
  const double largest = x.cwiseAbs().maxCoeff();
  const Energy energy{x, interval}, error{y - x, interval};
  const AveragedSpectra spectra{x, y, interval};
  std::vector<BandTracking> bands;
  const double highest = 0.5 / interval;
  for (std::size_t i = 0; i < std::size(kEdges) && kEdges[i] < highest; ++i) {
    const bool is_last = i + 1 == std::size(kEdges) || kEdges[i + 1] >= highest;
    BandTracking band;
    band.from = kEdges[i];
    band.to = is_last ? highest : kEdges[i + 1];
    const double end = is_last ? 2 * highest : band.to;  // includes the highest frequency
    band.command = (spectra.is_averaged() ? spectra.command_rms(band.from, end)
                                          : energy.size(band.from, end)) /
                   largest;
    band.nrms = error.size(band.from, end) / largest;
    if (band.command >= kLeastCommand && spectra.is_averaged())
      band.response = spectra.response(band.from, end, delay);
    bands.push_back(band);
  }
  return bands;
}

}  // namespace rths::maths
