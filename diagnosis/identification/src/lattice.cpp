// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/lattice.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <rths/identification/constants.hpp>

namespace rths::diagnosis {
namespace {

// The step of changes that are whole numbers of about `step`, by least squares.
void fit_step(const std::vector<double>& changes, double step, Lattice& lattice) {
  double squares = 0, product = 0, rest = 0;
  for (const double change : changes) {
    const double count = std::round(change / step);
    squares += count * count;
    product += count * change;
  }
  lattice.step = product / squares;
  for (const double change : changes)
    rest += std::pow(change - std::round(change / step) * lattice.step, 2);
  lattice.deviation = std::sqrt(rest / static_cast<double>(changes.size()) / squares);
}

Lattice lattice_of(const Channel& channel) {
  Lattice lattice{channel.role, channel.unit};
  const auto& x = channel.values;
  double mean = 0, square = 0;
  for (const double value : x) mean += value / static_cast<double>(x.size());
  for (const double value : x) square += (value - mean) * (value - mean);
  const double deviation = std::sqrt(square / static_cast<double>(x.size()));
  std::vector<double> changes;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] != x[i - 1]) changes.push_back(std::abs(x[i] - x[i - 1]));
  if (changes.empty() || !(deviation > 0)) return lattice;
  const double step = *std::min_element(changes.begin(), changes.end());
  const double repeats = 1 - static_cast<double>(changes.size()) / static_cast<double>(x.size());
  if (step < kCoarseStep * deviation || repeats < kRepeats) return lattice;
  std::vector<double> whole;
  std::copy_if(changes.begin(), changes.end(), std::back_inserter(whole), [&](double change) {
    return std::abs(change / step - std::round(change / step)) < kPrintedDigits;
  });
  lattice.on_steps = static_cast<double>(whole.size()) / static_cast<double>(changes.size());
  if (lattice.on_steps >= kOnSteps) fit_step(whole, step, lattice);
  return lattice;
}

}  // namespace

std::vector<Lattice> coarse_lattices(const std::vector<const Record*>& records) {
  std::vector<Lattice> found;
  for (const auto& channel : records[0]->channels) {
    if (!is_measured(channel.role)) continue;
    const Lattice lattice = lattice_of(channel);
    const bool everywhere =
        lattice.step > 0 && std::all_of(records.begin(), records.end(), [&](const Record* record) {
          const Channel* same = record->find(channel.role);
          return same != nullptr && lattice_of(*same).step > 0;
        });
    if (everywhere) found.push_back(lattice);
  }
  return found;
}

std::vector<std::pair<std::string, double>> rounding_of(const std::vector<Lattice>& lattices) {
  std::vector<std::pair<std::string, double>> added;
  for (const auto& lattice : lattices)
    added.emplace_back(lattice.role, lattice.step / std::sqrt(12.0));
  return added;
}

}  // namespace rths::diagnosis
