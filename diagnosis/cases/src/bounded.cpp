// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/bounded.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/identification/signal.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kModelRate = 500;         // of a composition, at most [Hz]
constexpr double kSamplesOfPeriod = 25;    // of the highest significant frequency
constexpr double kNoEnergy = 1e-3;         // of the energy of a channel
constexpr std::size_t kFewestKept = 1000;  // samples that a record keeps

double counted(const Case& c, const Record& record) {
  const double share = is_composition(c.model.kind) && record.has_time
                           ? std::min(1.0, kModelRate * record.time_step)
                           : 1;
  return share * static_cast<double>(record.samples());
}

double counted(const Case& c) {
  double sum = 0;
  for (const Record* record : moving_records(c)) sum += counted(c, *record);
  return sum;
}

// The frequency below which a channel has nearly all of its energy [Hz].
double highest_frequency(const Eigen::VectorXd& signal, double time_step) {
  constexpr int kWindow = 4096;
  const Eigen::VectorXd centred = signal.array() - signal.mean();
  if (centred.size() < kWindow || !(centred.squaredNorm() > 0)) return 0;
  const Spectrum spectrum = power_spectrum(centred, kWindow, time_step);
  const double total = spectrum.density.sum();
  double above = 0;
  Index i = spectrum.density.size() - 1;
  for (; i > 0 && above + spectrum.density[i] < kNoEnergy * total; --i)
    above += spectrum.density[i];
  return spectrum.frequency[i];
}

// By how much a record may be thinned.
int factor_of(const Record& record) {
  double highest = 1 / (static_cast<double>(record.samples()) * record.time_step);
  for (const auto& channel : record.channels)
    highest = std::max(highest, highest_frequency(values_of(channel), record.time_step));
  return std::max(1, static_cast<int>(1 / (record.time_step * kSamplesOfPeriod * highest)));
}

void thin(Record& record, int factor) {
  constexpr int kOrder = 4;
  constexpr double kBelowNyquist = 0.8;
  const double cutoff = kBelowNyquist * 0.5 / (record.time_step * factor);
  for (auto& channel : record.channels) {
    const Eigen::VectorXd few =
        thinned(low_passed(values_of(channel), kOrder, cutoff, record.time_step), factor);
    channel.values.assign(few.begin(), few.end());
  }
  const auto at = [&](std::size_t sample) { return sample / static_cast<std::size_t>(factor); };
  if (record.quiet) record.quiet = {at(record.quiet->first), at(record.quiet->second)};
  for (auto& [last, next] : record.gaps) {
    last = at(last);
    next = std::min(at(next) + 1, record.samples() - 1);
  }
  record.time_step *= factor;
}

void cut(Record& record, std::size_t samples) {
  for (auto& channel : record.channels) channel.values.resize(samples);
  std::erase_if(record.gaps, [&](const auto& gap) { return gap.second >= samples; });
  if (record.quiet && record.quiet->second > samples) record.quiet.reset();
}

}  // namespace

std::vector<std::string> bound_records(Case& c) {
  std::vector<std::string> lost;
  const double all = counted(c);
  if (all <= kMostSamples) return lost;
  // The noise that a case states is that of the samples as they are.
  const bool may_thin = !is_composition(c.model.kind) && c.noise.empty();
  const int wanted = static_cast<int>(std::ceil(all / kMostSamples));
  for (auto& record : c.records) {
    if (record.use == Use::Reference || !record.has_time || !may_thin) continue;
    const int factor = std::min(wanted, factor_of(record));
    if (factor < 2) continue;
    thin(record, factor);
    lost.push_back(
        fmt::format("{}: thinned to one of {} samples, {:.4g} Hz, behind a low-pass filter, "
                    "to bound the time of the diagnosis.",
                    record.name, factor, 1 / record.time_step));
  }
  const double share = kMostSamples / counted(c);
  if (share >= 1) return lost;
  for (auto& record : c.records) {
    const auto samples = static_cast<std::size_t>(share * static_cast<double>(record.samples()));
    if (record.use == Use::Reference || samples < kFewestKept) continue;
    lost.push_back(
        fmt::format("{}: only the first {} of {} samples are used, to bound the time of the "
                    "diagnosis; select a section with span_s.",
                    record.name, samples, record.samples()));
    cut(record, samples);
  }
  return lost;
}

}  // namespace rths::diagnosis
