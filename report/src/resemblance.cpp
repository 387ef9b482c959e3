// SPDX-License-Identifier: Apache-2.0
#include "resemblance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include <rths/maths/delay.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/memmap/units.hpp>

namespace rths::report {
namespace {

using Values = std::vector<double>;

constexpr double kLeaves = 0.05;      // of the energy of a difference that is explained
constexpr double kUnrelated = 0.5;    // correlation at the best delay
constexpr double kLarge = 0.5;        // difference beside the baseline, of unrelated signals
constexpr double kSameFactor = 0.01;  // of a factor between units
constexpr double kSteady = 0.01;      // of an interval that counts as constant
constexpr std::size_t kFewest = 50;   // samples of a delay

/// Units of a quantity that laboratories mix up.
struct Mixed {
  const char* si;
  std::array<const char*, 5> units;
};
constexpr Mixed kMixed[] = {{"m", {"m", "mm", "cm", "inch", "ft"}},
                            {"N", {"N", "kN", "MN", "lbf", "kip"}},
                            {"m/s2", {"m/s2", "gravity", "cm/s2", "mm/s2", "inch/s2"}},
                            {"m/s", {"m/s", "mm/s", "cm/s", "inch/s", "ft/s"}},
                            {"s", {"s", "ms", "us", "minute", "hour"}},
                            {"rad", {"rad", "degree", "mrad", "rad", "rad"}},
                            {"Pa", {"Pa", "kPa", "MPa", "psi", "bar"}}};

double energy(const Values& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum;
}

double correlation(const Values& a, const Values& b) {
  const double mean_a = maths::mean(a), mean_b = maths::mean(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

/// A signal and its baseline at equal intervals.
struct Even {
  double interval = 0;
  Values baseline, other;
};

Even evenly(const PairedValues& paired) {
  const Values steps = maths::steps_of(paired.time);
  Even even{maths::quantile(steps, 0.5), paired.baseline, paired.other};
  const auto is_usual = [&](double step) {
    return std::abs(step - even.interval) <= kSteady * even.interval;
  };
  if (std::all_of(steps.begin(), steps.end(), is_usual)) return even;
  Values times;
  for (double t = paired.time.front(); t <= paired.time.back(); t += even.interval)
    times.push_back(t);
  even.baseline = interpolated(paired.time, paired.baseline, times);
  even.other = interpolated(paired.time, paired.other, times);
  return even;
}

// The baseline later by a delay, and the other, where both are known.
std::pair<Values, Values> shifted(const Even& even, double delay) {
  const double steps = delay / even.interval;
  std::pair<Values, Values> both;
  for (std::size_t i = 0; i < even.other.size(); ++i) {
    const double position = static_cast<double>(i) - steps;
    if (position < 0 || position > static_cast<double>(even.baseline.size() - 1)) continue;
    const auto before = std::min(static_cast<std::size_t>(position), even.baseline.size() - 2);
    const double share = position - static_cast<double>(before);
    both.first.push_back((1 - share) * even.baseline[before] + share * even.baseline[before + 1]);
    both.second.push_back(even.other[i]);
  }
  return both;
}

// Least squares of b on a, without a constant.
double gain_of(const Values& a, const Values& b) {
  double aa = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += a[i] * a[i];
    ab += a[i] * b[i];
  }
  return aa > 0 ? ab / aa : 1;
}

double energy_between(const Values& a, double factor, double offset, const Values& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double rest = b[i] - factor * a[i] - offset;
    sum += rest * rest;
  }
  return sum;
}

// "mm had been read as m", if two units of the quantity have this factor; otherwise empty.
std::string units_with(double factor, const std::string& si) {
  for (const auto& quantity : kMixed)
    for (const char* stated : quantity.units)
      for (const char* read : quantity.units) {
        if (si != quantity.si && !si.empty() && si != "1") continue;
        const double ratio = memmap::parse_unit(read).scale / memmap::parse_unit(stated).scale;
        if (std::abs(ratio - 1) > kSameFactor && std::abs(factor / ratio - 1) < kSameFactor)
          return fmt::format("{} had been read as {}", stated, read);
      }
  return "";
}

void set_factor(double factor, ComparedSignal& signal) {
  if (std::abs(factor + 1) < kSameFactor) {
    signal.resemblance = Resemblance::Sign;
    signal.explanation = "has the opposite sign";
  } else if (const auto units = units_with(std::abs(factor), signal.unit); !units.empty()) {
    signal.resemblance = Resemblance::Unit;
    signal.explanation = fmt::format("is {:.4g} times the baseline, as if {}{}", factor, units,
                                     factor < 0 ? " with the opposite sign" : "");
  } else {
    signal.resemblance = Resemblance::Scale;
    signal.explanation = fmt::format("is {:.4g} times the baseline", factor);
  }
}

std::string text_of_delay(double delay) {
  return fmt::format("is {:.2f} ms {} the baseline", 1e3 * std::abs(delay),
                     delay > 0 ? "behind" : "ahead of");
}

// Whether values still move if as many are left out at either end.
bool moves_throughout(const Values& values, std::size_t left_out) {
  const auto moves = [](const auto begin, const auto end) {
    return std::adjacent_find(begin, end, std::not_equal_to<>{}) != end;
  };
  const auto by = static_cast<std::ptrdiff_t>(left_out);
  return moves(values.begin() + by, values.end()) && moves(values.begin(), values.end() - by);
}

// Flags and counters: a delay or a factor of them means nothing.
bool are_whole(const Values& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return value == std::round(value); });
}

void set_delay(double search, ComparedSignal& signal, const Even& even) {
  const double longest = even.interval * static_cast<double>(even.other.size() / 4);
  const double reach = std::min(search, longest);
  if (even.other.size() < kFewest || reach < 2 * even.interval) return;
  Values other = even.other;
  const double sign = correlation(even.baseline, other) < 0 ? -1 : 1;
  for (double& value : other) value *= sign;
  const auto lags = static_cast<std::size_t>(std::lround(reach / even.interval));
  if (!moves_throughout(even.baseline, lags) || !moves_throughout(other, lags)) return;
  const auto found = maths::identify_delay(even.baseline, other, even.interval, reach);
  const auto [earlier, later] = shifted(even, found.cross_correlation);
  signal.gain = gain_of(earlier, later);
  // At the end of the search there is no maximum.
  const bool is_inside = std::abs(found.cross_correlation) < reach - 1.5 * even.interval;
  if (is_inside && std::abs(correlation(earlier, later)) >= kUnrelated)
    signal.delay = found.cross_correlation;
}

}  // namespace

const char* name_of(Resemblance resemblance) {
  constexpr const char* kNames[] = {"none", "unit", "sign", "scale", "offset", "delay", "other"};
  return kNames[static_cast<std::size_t>(resemblance)];
}

Values interpolated(const Values& time, const Values& values, const Values& at) {
  if (time == at) return values;
  Values result;
  result.reserve(at.size());
  std::size_t i = 0;
  for (const double t : at) {
    while (i + 2 < time.size() && time[i + 1] <= t) ++i;
    const double share = (t - time[i]) / (time[i + 1] - time[i]);
    // At a sample exactly, also beside a value that is not a number.
    result.push_back(share == 0   ? values[i]
                     : share == 1 ? values[i + 1]
                                  : (1 - share) * values[i] + share * values[i + 1]);
  }
  return result;
}

void explain(double search, const PairedValues& paired, ComparedSignal& signal) {
  const double size = maths::deviation(paired.baseline), other = maths::deviation(paired.other);
  if (!(size > 0) || !(other > 0) || paired.time.size() < kFewest) return;
  if (are_whole(paired.baseline) && are_whole(paired.other)) return;
  const Even even = evenly(paired);
  set_delay(search, signal, even);
  const Values &a = even.baseline, &b = even.other;
  const double whole = energy_between(a, 1, 0, b);
  if (!(whole > 0)) return;
  const double factor = gain_of(a, b);
  Values difference(a.size());
  std::transform(b.begin(), b.end(), a.begin(), difference.begin(), std::minus{});
  const double offset = maths::mean(difference);
  const double of_factor = energy_between(a, factor, 0, b) / whole,
               of_offset = energy_between(a, 1, offset, b) / whole;
  double of_delay = INFINITY;
  if (signal.delay) {
    const auto [earlier, later] = shifted(even, *signal.delay);
    of_delay = energy_between(earlier, 1, 0, later) / static_cast<double>(earlier.size()) /
               (whole / static_cast<double>(a.size()));
  }
  const double least = std::min({of_factor, of_offset, of_delay});
  if (least <= kLeaves) {
    if (least == of_factor) {
      set_factor(factor, signal);
    } else if (least == of_offset) {
      signal.resemblance = Resemblance::Offset;
      signal.explanation =
          fmt::format("is the baseline {} {:.4g}", offset < 0 ? "−" : "+", std::abs(offset));
    } else {
      signal.resemblance = Resemblance::Delay;
      signal.explanation = text_of_delay(*signal.delay);
    }
  } else if (!signal.delay && whole > kLarge * energy(a)) {
    signal.resemblance = Resemblance::Other;
    signal.explanation = "has no relation to the baseline: another motion, or another quantity";
  }
}

}  // namespace rths::report
