// SPDX-License-Identifier: Apache-2.0
#include "candidate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <numbers>

#include <fmt/format.h>

#include <rths/plugin/plugin_adapter.hpp>

namespace rths::plugin {
namespace {

constexpr std::size_t kBand = 16;     // values around the outputs
constexpr double kAmplitude = 0.01;   // of inputs with a unit
constexpr double kFlagPeriod = 0.04;  // of inputs without a unit: 0 and 1 in turns [s]

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

double* PluginUnderTest::out() { return out_.data() + kBand; }

void PluginUnderTest::create() {
  std::array<char, 400> error{};
  call("create");
  self_ = adapter_.create(settings_.config.c_str(), error.data(), error.size() - 1);
  if (self_ != nullptr) return;
  report_.fail(kLifecycle, error[0] != '\0'
                               ? fmt::format("create failed: {}; give it a --config", error.data())
                               : "create returned NULL without a message: write one to `error`");
  throw Ended{};
}

void PluginUnderTest::read_signals() {
  std::uint32_t count = 0;
  call("signals");
  const rths_signal* signals = adapter_.signals(self_, &count);
  if (signals == nullptr || count == 0 || count > kMostSignals) {
    report_.fail(kSignals, fmt::format("{} signals, expected 1 to {}",
                                       signals == nullptr ? 0 : count, kMostSignals));
    throw Ended{};
  }
  signals_.assign(signals, signals + count);
}

void PluginUnderTest::activate() {
  std::array<char, 400> error{};
  call("activate");
  const rths_status status = adapter_.activate(self_, error.data(), error.size() - 1);
  if (status != RTHS_OK) {
    report_.fail(kLifecycle, fmt::format("activate returned {}: {}", status,
                                         error[0] != '\0' ? error.data() : "without a message"));
    throw Ended{};
  }
  steps_ = 0;
  times_ = {};
  outputs_ = static_cast<std::size_t>(std::count_if(
      signals_.begin(), signals_.end(), [](const auto& signal) { return !is_read(signal); }));
  out_.assign(outputs_ + 2 * kBand, kUntouched);
  std::fill_n(out(), outputs_, 0);
}

void PluginUnderTest::stop() {
  call("stop");
  if (library_.stop() != nullptr) library_.stop()(self_);
}

void PluginUnderTest::deactivate() {
  call("deactivate");
  adapter_.deactivate(self_);
}

void PluginUnderTest::destroy() {
  call("destroy");
  adapter_.destroy(self_);
  self_ = nullptr;
}

void PluginUnderTest::call(const std::string& name) {
  std::fill(report_.call.begin(), report_.call.end(), '\0');
  std::copy_n(name.begin(), std::min(name.size(), report_.call.size() - 1), report_.call.begin());
}

// Smooth motions of different frequencies; flags that change; parameters at rest, then at both ends
// of their ranges.
double PluginUnderTest::input(const rths_signal& signal, std::size_t index, double time) const {
  if (signal.direction == RTHS_PARAMETER) {
    if (!has_range(signal) || steps_ < kTrialSteps / 2) return signal.initial;
    return steps_ < kTrialSteps * 3 / 4 ? signal.lowest : signal.highest;
  }
  if (std::strcmp(signal.unit, "1") == 0) return std::fmod(time, kFlagPeriod) < kFlagPeriod / 2;
  const double frequency = 1 + 0.37 * static_cast<double>(index % 7);  // [Hz]
  return kAmplitude * std::sin(2 * std::numbers::pi * frequency * time);
}

void PluginUnderTest::check_status(rths_status status) {
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

void PluginUnderTest::check_outputs() {
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
    if ((i < kBand || i >= kBand + outputs()) && out_[i] != kUntouched)
      report_.fail(kBounds, fmt::format("step {} wrote outside its {} outputs", steps_, outputs()));
}

void PluginUnderTest::check_heap(long calls) {
  if (calls > 0 && !settings_.may_allocate)
    report_.fail(kAllocation, fmt::format("step {} used the heap {} times: allocate in activate",
                                          steps_, calls));
}

rths_status PluginUnderTest::step() {
  const double time = steps_ * settings_.period;
  in_.clear();
  for (std::size_t i = 0; i < signals_.size(); ++i)
    if (is_read(signals_[i])) in_.push_back(input(signals_[i], i, time));
  const auto before = in_;
  call(fmt::format("step {}", steps_));
  const double wall = seconds_of(CLOCK_MONOTONIC), used = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  const long heap = heap_calls();
  const rths_status status = adapter_.step(self_, time, in_.data(), out());
  const long calls = heap_calls() - heap;
  times_.processor.push_back(seconds_of(CLOCK_THREAD_CPUTIME_ID) - used);
  times_.wall.push_back(seconds_of(CLOCK_MONOTONIC) - wall);
  check_heap(calls);
  if (std::memcmp(before.data(), in_.data(), in_.size() * sizeof(double)) != 0)
    report_.fail(kBounds, fmt::format("step {} wrote to its inputs: they are const", steps_));
  check_outputs();
  check_status(status);
  ++steps_;
  return status;
}

}  // namespace rths::plugin
