// SPDX-License-Identifier: Apache-2.0
#include <rths/report/comparison.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/maths/statistics.hpp>

#include "compared_file.hpp"
#include "resemblance.hpp"

namespace rths::report {
namespace {

using Values = std::vector<double>;

// A signal that both have, by its name, or by its role if no names are equal.
struct CommonSignal {
  std::string name, other_name, role;
};

std::vector<CommonSignal> common_signals(const ComparedFile& baseline, const ComparedFile& other) {
  std::vector<CommonSignal> common;
  for (const auto& [name, signal] : baseline.signals)
    if (other.signals.contains(name)) common.push_back({name, name, name});
  if (!common.empty()) return common;
  for (const auto& [role, name] : baseline.roles)
    if (const auto found = other.roles.find(role); found != other.roles.end())
      common.push_back({name, found->second, role});
  return common;
}

// The pairs of names to compare. @throws Error for the first pattern that matches none
std::vector<std::pair<std::string, std::string>> pairs_of(const ComparedFile& baseline,
                                                          const ComparedFile& other,
                                                          const ComparisonSettings& settings) {
  auto pairs = settings.pairs;
  if (!pairs.empty() && settings.patterns.empty()) return pairs;
  const auto common = common_signals(baseline, other);
  const auto is_of = [](const CommonSignal& signal, const std::vector<std::string>& patterns) {
    return matches(signal.name, patterns) || matches(signal.role, patterns);
  };
  std::vector<std::string> names;
  for (const auto& signal : common) names.push_back(signal.name);
  for (const auto& pattern : settings.patterns)
    if (!common.empty() && std::none_of(common.begin(), common.end(), [&](const auto& signal) {
          return is_of(signal, {pattern});
        }))
      throw Error{
          fmt::format("no common signal matches '{}'{}", pattern, did_you_mean(pattern, names))};
  for (const auto& signal : common)
    if (is_of(signal, settings.patterns)) pairs.emplace_back(signal.name, signal.other_name);
  return pairs;
}

const FileSignal& signal_of(const ComparedFile& file, const std::filesystem::path& path,
                            const std::string& name) {
  const auto found = file.signals.find(name);
  if (found != file.signals.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, signal] : file.signals) names.push_back(known);
  throw Error{
      fmt::format("{}: there is no signal '{}'{}", path.string(), name, did_you_mean(name, names))};
}

// Rows in which both values are numbers. @returns the rows in which one alone is
std::size_t keep_numbers(PairedValues& paired) {
  std::size_t kept = 0, unmatched = 0;
  for (std::size_t i = 0; i < paired.time.size(); ++i) {
    const bool is_number = std::isfinite(paired.baseline[i]);
    if (is_number != std::isfinite(paired.other[i])) ++unmatched;
    if (!is_number || !std::isfinite(paired.other[i])) continue;
    paired.time[kept] = paired.time[i];
    paired.baseline[kept] = paired.baseline[i];
    paired.other[kept++] = paired.other[i];
  }
  for (Values* values : {&paired.time, &paired.baseline, &paired.other}) values->resize(kept);
  return unmatched;
}

void measure(const PairedValues& paired, ComparedSignal& signal) {
  signal.samples = paired.time.size();
  Values difference(signal.samples);
  for (std::size_t i = 0; i < difference.size(); ++i)
    difference[i] = paired.other[i] - paired.baseline[i];
  signal.peak = maths::largest_magnitude(paired.baseline);
  signal.other_peak = maths::largest_magnitude(paired.other);
  signal.rms = maths::rms(difference);
  const double size = maths::deviation(paired.baseline);
  signal.relative_rms = signal.rms == 0 ? 0 : size > 0 ? signal.rms / size : INFINITY;
  const auto at = std::max_element(difference.begin(), difference.end(),
                                   [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (at == difference.end()) return;
  signal.largest = std::abs(*at);
  signal.largest_at = paired.time[static_cast<std::size_t>(at - difference.begin())];
}

/// Smallest or largest value in a window that moves on.
template <class Before>
class SlidingExtreme {
 public:
  void add(std::size_t i, double value) {
    while (!waiting_.empty() && !Before{}(waiting_.back().second, value)) waiting_.pop_back();
    waiting_.emplace_back(i, value);
  }
  void drop_before(std::size_t first) {
    while (waiting_.front().first < first) waiting_.pop_front();
  }
  [[nodiscard]] double value() const { return waiting_.front().second; }

 private:
  std::deque<std::pair<std::size_t, double>> waiting_;
};

void judge(const Tolerance& tolerance, const PairedValues& paired, ComparedSignal& signal) {
  SlidingExtreme<std::less<>> least;
  SlidingExtreme<std::greater<>> most;
  const Values& time = paired.time;
  std::size_t first = 0, next = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    for (; next < time.size() && time[next] <= time[i] + tolerance.time; ++next) {
      const double width =
          std::max(tolerance.absolute, tolerance.relative * std::abs(paired.baseline[next]));
      least.add(next, paired.baseline[next] - width);
      most.add(next, paired.baseline[next] + width);
    }
    while (time[first] < time[i] - tolerance.time) ++first;
    least.drop_before(first);
    most.drop_before(first);
    if (paired.other[i] >= least.value() && paired.other[i] <= most.value()) continue;
    if (signal.broken_samples++ == 0) signal.broken_at = time[i];
  }
}

// Files without an experiment have some settings at most, such as the map of a recorded ring.
std::vector<ComparedSetting> differences_of(const ComparedFile& baseline,
                                            const ComparedFile& other) {
  const auto &a = baseline.settings, &b = other.settings;
  const bool are_complete = baseline.has_experiment && other.has_experiment;
  std::set<std::string> keys;
  for (const auto& [key, value] : a) keys.insert(key);
  for (const auto& [key, value] : b) keys.insert(key);
  const auto value_in = [](const auto& settings, const std::string& key) {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string{} : found->second;
  };
  std::vector<ComparedSetting> differences;
  for (const auto& key : keys)
    if (value_in(a, key) != value_in(b, key) &&
        (are_complete || (a.contains(key) && b.contains(key))))
      differences.push_back({key, value_in(a, key), value_in(b, key)});
  return differences;
}

// Signals outside their tolerance, then words of the ring, then monitors; the most different first.
bool is_before(const ComparedSignal& a, const ComparedSignal& b) {
  const auto rank = [](const ComparedSignal& signal) {
    return std::tuple{!signal.broken_at, signal.is_equal, signal.name.starts_with("monitor."),
                      -signal.relative_rms};
  };
  return rank(a) < rank(b);
}

/// Two files on the times of the baseline that both have.
class Comparing {
 public:
  Comparing(const std::filesystem::path& baseline_path, const std::filesystem::path& other_path,
            const ComparisonSettings& settings)
      : settings_{settings},
        baseline_{read_compared(baseline_path)},
        other_{read_compared(other_path)} {
    result_.baseline = baseline_path;
    result_.other = other_path;
    result_.is_judged = settings.tolerance.has_value();
  }

  /// The values of signals of an earlier comparison.
  std::vector<PairedValues> values(const ComparedRuns& comparison,
                                   const std::vector<std::string>& names) && {
    for (double& t : other_.time) t -= comparison.shift;
    set_times();
    std::vector<PairedValues> values;
    for (const auto& signal : comparison.signals)
      if (contains(names, signal.name))
        values.push_back(paired(signal.name, signal.other_name).second);
    return values;
  }

  ComparedRuns run() && {
    const auto pairs = pairs_of(baseline_, other_, settings_);
    if (pairs.empty()) throw_without_pairs();
    if (!settings_.aligned.empty()) align(pairs);
    set_times();
    for (const auto& [name, other_name] : pairs) compare(name, other_name);
    std::stable_sort(result_.signals.begin(), result_.signals.end(), is_before);
    result_.settings = differences_of(baseline_, other_);
    note_others(pairs);
    return std::move(result_);
  }

 private:
  [[noreturn]] void throw_without_pairs() const {
    throw Error{
        fmt::format("{} and {} have no common signal, expected equal names, equal roles, or --pair",
                    result_.baseline.string(), result_.other.string())};
  }

  void set_times() {
    const double from = std::max({settings_.from, baseline_.time.front(), other_.time.front()}),
                 to = std::min({settings_.to, baseline_.time.back(), other_.time.back()});
    const auto first = std::lower_bound(baseline_.time.begin(), baseline_.time.end(), from),
               last = std::upper_bound(first, baseline_.time.end(), to);
    if (last - first < 2)
      throw Error{
          fmt::format("{} from {:g} to {:g} s and {} from {:g} to {:g} s: found no common "
                      "time, expected two samples at least",
                      result_.baseline.string(), baseline_.time.front(), baseline_.time.back(),
                      result_.other.string(), other_.time.front(), other_.time.back())};
    time_ = {first, last};
    result_.from = time_.front();
    result_.to = time_.back();
    result_.baseline_times = {baseline_.time.front(), baseline_.time.back()};
    result_.other_times = {other_.time.front(), other_.time.back()};
    first_row_ = static_cast<std::size_t>(first - baseline_.time.begin());
  }

  /// A signal, and its values in the rows in which both are numbers.
  [[nodiscard]] std::pair<ComparedSignal, PairedValues> paired(
      const std::string& name, const std::string& other_name) const {
    const FileSignal &mine = signal_of(baseline_, result_.baseline, name),
                     &theirs = signal_of(other_, result_.other, other_name);
    if (!mine.unit.empty() && !theirs.unit.empty() && mine.unit != theirs.unit)
      throw Error{fmt::format("'{}' is in {} in {}, but '{}' in {} in {}", name, mine.unit,
                              result_.baseline.string(), other_name, theirs.unit,
                              result_.other.string())};
    ComparedSignal signal;
    signal.name = name;
    signal.other_name = other_name;
    signal.unit = mine.unit.empty() ? theirs.unit : mine.unit;
    const auto begin = mine.values.begin() + static_cast<std::ptrdiff_t>(first_row_);
    PairedValues values{
        time_, {begin, begin + std::ssize(time_)}, interpolated(other_.time, theirs.values, time_)};
    signal.unmatched = keep_numbers(values);
    measure(values, signal);
    return {std::move(signal), std::move(values)};
  }

  void compare(const std::string& name, const std::string& other_name) {
    auto [signal, values] = paired(name, other_name);
    signal.is_equal = signal.unmatched == 0 && values.baseline == values.other;
    if (!signal.is_equal) explain(settings_.search, values, signal);
    if (settings_.tolerance) judge(*settings_.tolerance, values, signal);
    if (settings_.tolerance && signal.unmatched > 0) {
      signal.broken_samples += signal.unmatched;
      if (!signal.broken_at) signal.broken_at = result_.from;
    }
    result_.signals.push_back(std::move(signal));
  }

  // Moves the times of the other so that one of its signals has no delay.
  void align(const std::vector<std::pair<std::string, std::string>>& pairs) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return pair.first == settings_.aligned;
    });
    if (found == pairs.end())
      throw Error{fmt::format("there is no common signal '{}' to align by", settings_.aligned)};
    set_times();
    auto [signal, values] = paired(found->first, found->second);
    explain(settings_.search, values, signal);
    if (!signal.delay)
      throw Error{
          fmt::format("'{}' has no delay to align by: it does not move, or it has no "
                      "relation to the baseline",
                      settings_.aligned)};
    result_.shift = *signal.delay;
    for (double& t : other_.time) t -= result_.shift;
  }

  void note_others(const std::vector<std::pair<std::string, std::string>>& pairs) {
    std::set<std::string> mine, theirs;
    for (const auto& [name, other] : pairs) {
      mine.insert(name);
      theirs.insert(other);
    }
    if (!settings_.patterns.empty() || !settings_.pairs.empty()) return;
    for (const auto& [name, signal] : baseline_.signals)
      if (!mine.contains(name)) result_.only_baseline.push_back(name);
    for (const auto& [name, signal] : other_.signals)
      if (!theirs.contains(name)) result_.only_other.push_back(name);
  }

  const ComparisonSettings& settings_;
  ComparedFile baseline_, other_;
  Values time_;
  std::size_t first_row_ = 0;
  ComparedRuns result_;
};

}  // namespace

std::size_t ComparedRuns::equal() const {
  return static_cast<std::size_t>(std::count_if(
      signals.begin(), signals.end(), [](const auto& signal) { return signal.is_equal; }));
}

std::size_t ComparedRuns::broken() const {
  return static_cast<std::size_t>(
      std::count_if(signals.begin(), signals.end(),
                    [](const auto& signal) { return signal.broken_at.has_value(); }));
}

std::vector<PairedValues> values_of(const ComparedRuns& comparison,
                                    const std::vector<std::string>& names) {
  ComparisonSettings settings;
  settings.from = comparison.from;
  settings.to = comparison.to;
  return Comparing{comparison.baseline, comparison.other, settings}.values(comparison, names);
}

ComparedRuns compare(const std::filesystem::path& baseline, const std::filesystem::path& other,
                     const ComparisonSettings& settings) {
  return Comparing{baseline, other, settings}.run();
}

}  // namespace rths::report
