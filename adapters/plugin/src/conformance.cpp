// SPDX-License-Identifier: Apache-2.0
//
// Three trials: the plugin is loaded and described; it runs, restarts and stops; two of it run in
// turns. The second trial is repeated in another process, whose outputs must be the same.
#include <rths/plugin/conformance.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>
#include <rths/plugin/library.hpp>
#include <rths/plugin/plugin_adapter.hpp>

#include "exports.hpp"
#include "trial.hpp"

namespace rths::plugin {
namespace {

constexpr int kSteps = 400;
constexpr std::uint32_t kMostListed = 10'000;
constexpr std::size_t kBand = 16;            // values around the outputs
constexpr double kBandValue = 6.0221408e23;  // no plugin writes it
constexpr double kAmplitude = 0.01;          // of inputs with a unit
constexpr double kFlagPeriod = 0.04;         // of inputs without a unit: 0 and 1 in turns [s]
constexpr double kRestDeadline = 2;          // after the stop [s]
constexpr const char* kRuleNames[kRules] = {
    "exports",  "abi",        "lifecycle", "signals", "units",     "range",       "nan",  "bounds",
    "deadline", "allocation", "stop",      "restart", "instances", "determinism", "crash"};

bool is_read(const rths_signal& signal) {
  return signal.direction == RTHS_INPUT || signal.direction == RTHS_PARAMETER;
}
bool has_range(const rths_signal& signal) { return signal.lowest != 0 || signal.highest != 0; }

/// Ends a trial whose further rules need what failed.
struct Ended {};

/// A plugin under trial. Its calls are noted, so that a crash can be named.
class Candidate {
 public:
  Candidate(const Library& library, const ConformanceSettings& settings, TrialReport& report)
      : library_{library}, adapter_{library.adapter()}, settings_{settings}, report_{report} {}

  void create() {
    std::array<char, 400> error{};
    call("create");
    self_ = adapter_.create(settings_.config.c_str(), error.data(), error.size() - 1);
    if (self_ != nullptr) return;
    report_.fail(kLifecycle,
                 error[0] != '\0'
                     ? fmt::format("create failed: {}; give it a --config", error.data())
                     : "create returned NULL without a message: write one to `error`");
    throw Ended{};
  }
  void read_signals() {
    std::uint32_t count = 0;
    call("signals");
    const rths_signal* signals = adapter_.signals(self_, &count);
    if (signals == nullptr || count == 0 || count > kMostListed) {
      report_.fail(kSignals, fmt::format("{} signals, expected 1 to {}",
                                         signals == nullptr ? 0 : count, kMostListed));
      throw Ended{};
    }
    signals_.assign(signals, signals + count);
  }
  void activate() {
    std::array<char, 400> error{};
    call("activate");
    const rths_status status = adapter_.activate(self_, error.data(), error.size() - 1);
    if (status != RTHS_OK) {
      report_.fail(kLifecycle, fmt::format("activate returned {}: {}", status,
                                           error[0] != '\0' ? error.data() : "without a message"));
      throw Ended{};
    }
    steps_ = 0;
    outputs_ = std::count_if(signals_.begin(), signals_.end(),
                             [](const auto& signal) { return !is_read(signal); });
    out_.assign(static_cast<std::size_t>(outputs_) + 2 * kBand, kBandValue);
    std::fill_n(out(), outputs_, 0);
  }
  void stop() {
    call("stop");
    if (library_.stop() != nullptr) library_.stop()(self_);
  }
  void deactivate() {
    call("deactivate");
    adapter_.deactivate(self_);
  }
  void destroy() {
    call("destroy");
    adapter_.destroy(self_);
    self_ = nullptr;
  }
  rths_status step();

  [[nodiscard]] const std::vector<rths_signal>& signals() const { return signals_; }
  [[nodiscard]] double* out() { return out_.data() + kBand; }
  [[nodiscard]] std::size_t outputs() const { return static_cast<std::size_t>(outputs_); }
  [[nodiscard]] const std::vector<double>& wall_times() const { return wall_times_; }

 private:
  void call(const std::string& name) {
    std::fill(report_.call.begin(), report_.call.end(), '\0');
    std::copy_n(name.begin(), std::min(name.size(), report_.call.size() - 1), report_.call.begin());
  }
  [[nodiscard]] double input(const rths_signal& signal, std::size_t index, double time) const;
  void check_outputs();
  void check_status(rths_status status);

  const Library& library_;
  const rths_adapter& adapter_;
  const ConformanceSettings& settings_;
  TrialReport& report_;
  void* self_ = nullptr;
  std::vector<rths_signal> signals_;
  std::ptrdiff_t outputs_ = 0;
  std::vector<double> in_, out_, wall_times_;
  int steps_ = 0;
};

// Smooth motions of different frequencies; flags that change; parameters at rest, then at both ends
// of their ranges.
double Candidate::input(const rths_signal& signal, std::size_t index, double time) const {
  if (signal.direction == RTHS_PARAMETER) {
    if (!has_range(signal) || steps_ < kSteps / 2) return signal.initial;
    return steps_ < kSteps * 3 / 4 ? signal.lowest : signal.highest;
  }
  if (std::strcmp(signal.unit, "1") == 0) return std::fmod(time, kFlagPeriod) < kFlagPeriod / 2;
  const double frequency = 1 + 0.37 * static_cast<double>(index % 7);  // [Hz]
  return kAmplitude * std::sin(2 * std::numbers::pi * frequency * time);
}

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void Candidate::check_status(rths_status status) {
  if (status < RTHS_OK || status > RTHS_FAULT) {
    report_.fail(kLifecycle, fmt::format("step {} returned {}, expected 0 to {}", steps_, status,
                                         static_cast<int>(RTHS_FAULT)));
    throw Ended{};
  }
  if (status != RTHS_FAULT) return;
  const char* text = library_.message() != nullptr ? library_.message()(self_) : nullptr;
  report_.fail(kLifecycle,
               fmt::format("step {} returned a fault: {}", steps_,
                           text != nullptr && *text != '\0' ? text : "without a message"));
  throw Ended{};
}

void Candidate::check_outputs() {
  std::size_t index = 0;
  for (const auto& signal : signals_) {
    if (is_read(signal)) continue;
    const double value = out()[index++];
    if (!std::isfinite(value))
      report_.fail(kNan, fmt::format("step {} left {} in '{}': write a number in every step",
                                     steps_, value, signal.name));
    else if (has_range(signal) && (value < signal.lowest || value > signal.highest))
      report_.fail(kRange,
                   fmt::format("step {} wrote {:g} to '{}', stated as {:g} to {:g}: clamp it and "
                               "return RTHS_LIMIT_EXCEEDED, or state the right range",
                               steps_, value, signal.name, signal.lowest, signal.highest));
  }
  for (std::size_t i = 0; i < out_.size(); ++i)
    if ((i < kBand || i >= kBand + outputs()) && out_[i] != kBandValue)
      report_.fail(kBounds, fmt::format("step {} wrote outside its {} outputs", steps_, outputs()));
}

rths_status Candidate::step() {
  const double time = steps_ * settings_.period;
  in_.clear();
  for (std::size_t i = 0; i < signals_.size(); ++i)
    if (is_read(signals_[i])) in_.push_back(input(signals_[i], i, time));
  const auto before = in_;
  call(fmt::format("step {}", steps_));
  const double wall = seconds_of(CLOCK_MONOTONIC), used = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  const long heap = rths_heap_calls != nullptr ? rths_heap_calls() : 0;
  const rths_status status = adapter_.step(self_, time, in_.data(), out());
  const long calls = rths_heap_calls != nullptr ? rths_heap_calls() - heap : 0;
  const double processor = seconds_of(CLOCK_THREAD_CPUTIME_ID) - used;
  wall_times_.push_back(seconds_of(CLOCK_MONOTONIC) - wall);
  if (calls > 0)
    report_.fail(kAllocation, fmt::format("step {} used the heap {} times: allocate in activate",
                                          steps_, calls));
  if (steps_ > 0 && processor > settings_.period)
    report_.fail(kDeadline, fmt::format("step {} took {:.1f} ms, the period is {:.1f} ms", steps_,
                                        1e3 * processor, 1e3 * settings_.period));
  if (std::memcmp(before.data(), in_.data(), in_.size() * sizeof(double)) != 0)
    report_.fail(kBounds, fmt::format("step {} wrote to its inputs: they are const", steps_));
  check_outputs();
  check_status(status);
  ++steps_;
  return status;
}

// FNV-1a.
std::uint64_t extended(std::uint64_t fingerprint, const double* values, std::size_t count) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &values[i], sizeof bits);
    fingerprint = (fingerprint ^ bits) * kPrime;
  }
  return fingerprint;
}

std::uint64_t run(Candidate& candidate) {
  std::uint64_t fingerprint = 0xcbf29ce484222325;
  candidate.activate();
  for (int i = 0; i < kSteps; ++i) {
    const rths_status status = candidate.step();
    fingerprint = extended(fingerprint, candidate.out(), candidate.outputs());
    if (status == RTHS_DONE) break;
  }
  return fingerprint;
}

std::string fault_of_signal(const rths_signal& signal, std::set<std::string>& names) {
  if (signal.name == nullptr || *signal.name == '\0') return "a signal has no name";
  if (signal.unit == nullptr) return fmt::format("'{}' has no unit", signal.name);
  if (signal.direction > RTHS_PARAMETER)
    return fmt::format("'{}' has direction {}, expected 0 to {}", signal.name, signal.direction,
                       static_cast<int>(RTHS_PARAMETER));
  if (!names.insert(fmt::format("{} {}", signal.direction, signal.name)).second)
    return fmt::format("'{}' is listed twice", signal.name);
  return "";
}

std::string fault_of_unit(const rths_signal& signal) {
  try {
    const auto unit = memmap::parse_unit(signal.unit);
    if (unit.si == signal.unit) return "";
    return fmt::format("'{}' is in [{}], expected [{}]: convert in the plugin", signal.name,
                       signal.unit, unit.si);
  } catch (const Error& error) {
    return fmt::format("'{}': {}", signal.name, error.what());
  }
}

std::string fault_of_range(const rths_signal& signal) {
  if (!has_range(signal)) return "";
  if (!(signal.lowest < signal.highest))
    return fmt::format("'{}' has a range from {:g} to {:g}, expected lowest < highest", signal.name,
                       signal.lowest, signal.highest);
  const bool is_inside = signal.initial >= signal.lowest && signal.initial <= signal.highest;
  if (signal.direction != RTHS_PARAMETER || is_inside) return "";
  return fmt::format("'{}' begins with {:g}, outside its range {:g} to {:g}", signal.name,
                     signal.initial, signal.lowest, signal.highest);
}

void describe(Candidate& candidate, TrialReport& report) {
  std::set<std::string> names;
  for (const auto& signal : candidate.signals())
    if (const auto fault = fault_of_signal(signal, names); !fault.empty()) {
      report.fail(kSignals, fault);
      throw Ended{};
    }
  report.pass(kSignals, fmt::format("{} signals", candidate.signals().size()));
  report.pass(kUnits);
  report.pass(kRange);
  for (const auto& signal : candidate.signals()) {
    if (const auto fault = fault_of_unit(signal); !fault.empty()) report.fail(kUnits, fault);
    if (const auto fault = fault_of_range(signal); !fault.empty()) report.fail(kRange, fault);
  }
}

bool is_same(const rths_signal& a, const rths_signal& b) {
  return std::strcmp(a.name, b.name) == 0 && std::strcmp(a.unit, b.unit) == 0 &&
         a.direction == b.direction;
}

void check_times(const std::vector<double>& wall_times, double period, TrialReport& report) {
  auto times = wall_times;
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  if (*middle <= period)
    return report.pass(kDeadline, fmt::format("median step {:.2f} us", 1e6 * *middle));
  report.fail(kDeadline, fmt::format("half of the steps took more than {:.1f} ms, the period is "
                                     "{:.1f} ms: do not wait in a step",
                                     1e3 * *middle, 1e3 * period));
  throw Ended{};
}

void check_rest(const Library& library, Candidate& candidate, double period, TrialReport& report) {
  if (library.stop() == nullptr) return report.pass(kStop, "the host ramps outputs to rest");
  candidate.stop();
  const int longest = static_cast<int>(kRestDeadline / period);
  for (int i = 0; i < longest; ++i)
    if (candidate.step() == RTHS_DONE) return report.pass(kStop, fmt::format("{} steps", i + 1));
  report.fail(kStop,
              fmt::format("did not return RTHS_DONE within {:g} s after stop", kRestDeadline));
}

// Loads, describes, runs, restarts, stops.
void first_trial(const std::filesystem::path& file, const ConformanceSettings& settings,
                 TrialReport& report) {
  const std::string loading = "loading";
  std::copy(loading.begin(), loading.end(), report.call.begin());
  std::optional<Library> library;
  try {
    library.emplace(std::filesystem::absolute(file));
  } catch (const Error& error) {
    return report.fail(kAbi, error.what());
  }
  const auto& adapter = library->adapter();
  report.pass(kAbi, fmt::format("'{}' {}, adapter ABI {}.{}", adapter.name, adapter.version,
                                adapter.abi >> 16, adapter.abi & 0xFFFF));
  try {
    Candidate candidate{*library, settings, report};
    candidate.create();
    candidate.read_signals();
    describe(candidate, report);
    const auto before = candidate.signals();
    report.fingerprint = run(candidate);
    candidate.read_signals();
    const auto& after = candidate.signals();
    if (!std::equal(before.begin(), before.end(), after.begin(), after.end(), is_same)) {
      report.fail(kSignals, "other signals after activate than before: list them in create");
      throw Ended{};
    }
    candidate.deactivate();
    check_times(candidate.wall_times(), settings.period, report);
    if (run(candidate) != report.fingerprint)
      report.fail(kRestart,
                  "other outputs after deactivate and activate: take the initial state "
                  "in activate");
    check_rest(*library, candidate, settings.period, report);
    candidate.deactivate();
    candidate.destroy();
    for (const Rule rule : {kLifecycle, kNan, kBounds, kRestart, kCrash}) report.pass(rule);
    if (rths_heap_calls != nullptr) report.pass(kAllocation);
  } catch (const Ended&) {
  }
}

// Two instances in turns, as two nodes of one process.
void trial_of_instances(const std::filesystem::path& file, const ConformanceSettings& settings,
                        std::uint64_t alone, TrialReport& report) {
  const Library library{std::filesystem::absolute(file)};
  std::array<Candidate, 2> pair{Candidate{library, settings, report},
                                Candidate{library, settings, report}};
  for (auto& candidate : pair) {
    candidate.create();
    candidate.read_signals();
    candidate.activate();
  }
  std::array<std::uint64_t, 2> fingerprints{0xcbf29ce484222325, 0xcbf29ce484222325};
  bool done = false;
  for (int i = 0; i < kSteps && !done; ++i)
    for (std::size_t k = 0; k < pair.size(); ++k) {
      done = pair[k].step() == RTHS_DONE;
      fingerprints[k] = extended(fingerprints[k], pair[k].out(), pair[k].outputs());
    }
  if (fingerprints[0] == alone && fingerprints[1] == alone) return report.pass(kInstances);
  report.fail(kInstances,
              "two adapters of this library influence each other: keep all state in "
              "`self`, none in static variables");
}

void add_exports(const std::filesystem::path& file, TrialReport& report) {
  auto names = exported_symbols(file);
  std::erase(names, "rths_adapter_entry");
  if (names.empty()) return report.pass(kExports);
  const std::size_t count = names.size();
  names.resize(std::min<std::size_t>(count, 3));
  report.fail(kExports, fmt::format("{} symbols besides rths_adapter_entry, such as {}: link with "
                                    "rths_add_adapter, or with a version script",
                                    count, fmt::join(names, ", ")));
}

std::vector<Finding> findings_of(const TrialReport& report) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < kRules; ++i) {
    const auto& rule = report.rules[i];
    using Outcome = Finding::Outcome;
    findings.push_back(
        {kRuleNames[i],
         !rule.tried ? Outcome::NotTried : (rule.failed ? Outcome::Fail : Outcome::Pass),
         rule.text.data()});
  }
  return findings;
}

}  // namespace

std::vector<Finding> check_plugin(const std::filesystem::path& library,
                                  const ConformanceSettings& settings) {
  const auto trial = [&](TrialReport& report) { first_trial(library, settings, report); };
  TrialReport report = run_trial(trial, settings.step_deadline);
  add_exports(library, report);
  if (!report.completed || !report.rules[kCrash].tried) return findings_of(report);
  const auto again = run_trial(trial, settings.step_deadline);
  if (again.fingerprint == report.fingerprint)
    report.pass(kDeterminism);
  else
    report.fail(kDeterminism,
                "the same inputs gave other outputs in another process: use no "
                "clock, address or unseeded random number");
  const auto both = run_trial(
      [&](TrialReport& other) {
        try {
          trial_of_instances(library, settings, report.fingerprint, other);
        } catch (const Ended&) {
        }
      },
      settings.step_deadline);
  // The rules of single instances are judged above.
  if (again.fingerprint == report.fingerprint)
    for (const Rule rule : {kInstances, kCrash})
      if (both.rules[rule].failed) report.fail(rule, both.rules[rule].text.data());
  if (both.rules[kInstances].tried) report.pass(kInstances);
  return findings_of(report);
}

}  // namespace rths::plugin
