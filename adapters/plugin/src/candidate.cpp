// SPDX-License-Identifier: Apache-2.0
#include "candidate.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <numbers>
#include <span>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/plugin/plugin_adapter.hpp>

namespace rths::plugin {
namespace {

constexpr auto kTrialLook = std::chrono::milliseconds{2};
constexpr double kIdleFactor = 5;            // of the deadline, for calls that wait
constexpr double kLeastProcessorTime = 0.2;  // [s]: a call that loops has used it

double processor_time_of(pid_t pid) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void set_text(std::span<char> text, const std::string& value) {
  const auto size = std::min(value.size(), text.size() - 1);
  std::memcpy(text.data(), value.data(), size);
  text[size] = '\0';
}

[[noreturn]] void run_child(const std::function<void(TrialReport&)>& trial, TrialReport& report) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(number, SIG_DFL);
  for (const int number : kEndingSignals) std::signal(number, SIG_DFL);
  trial(report);
  report.completed = true;
  if (report.has_failed()) _exit(0);
  set_text(report.call, "exit");
  std::exit(0);  // the destructors of the library run
}

/// A report in memory that a child process shares.
class SharedReport {
 public:
  SharedReport() {
    void* memory = mmap(nullptr, sizeof(TrialReport), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw Error{"no memory for the trial of a plugin"};
    report_ = std::construct_at(static_cast<TrialReport*>(memory));
  }
  ~SharedReport() { munmap(report_, sizeof(TrialReport)); }
  SharedReport(const SharedReport&) = delete;
  SharedReport& operator=(const SharedReport&) = delete;
  [[nodiscard]] TrialReport& operator*() const { return *report_; }
  [[nodiscard]] TrialReport* operator->() const { return report_; }

 private:
  TrialReport* report_;
};

/// The process of a trial and those that the plugin starts: a process group, which ends with this
/// object.
class Child {
 public:
  Child(const std::function<void(TrialReport&)>& trial, TrialReport& report) {
    std::fflush(nullptr);  // what is not written yet would be written twice
    pid_ = fork();
    if (pid_ == 0) run_child(trial, report);
    if (pid_ < 0) throw Error{"no process for the trial of a plugin"};
    setpgid(pid_, pid_);  // here, too: before the first look at it
  }
  ~Child() { static_cast<void>(end()); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }
  /// Until `end`, the process keeps its id, and so does its group.
  [[nodiscard]] bool has_ended() const {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           ended.si_pid == pid_;
  }
  /// Ends what still runs. @returns the status of the trial's process, as from waitpid
  int end() {
    if (is_reaped_) return status_;
    kill(-pid_, SIGKILL);
    waitpid(pid_, &status_, 0);
    is_reaped_ = true;
    return status_;
  }

 private:
  pid_t pid_ = -1;
  int status_ = 0;
  bool is_reaped_ = false;
};

// A busy host delays the child: a call is overdue if it used the processor, or waits far too long.
bool is_overdue(pid_t pid, double waited, double processor_time, double deadline) {
  if (waited > kIdleFactor * deadline) return true;
  return waited > deadline && processor_time_of(pid) - processor_time > kLeastProcessorTime;
}

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

void TrialReport::pass(std::size_t rule, const std::string& text) {
  rules[rule].tried = true;
  if (!rules[rule].failed) set_text(rules[rule].text, text);
}

void TrialReport::fail(std::size_t rule, const std::string& text) {
  rules[rule].tried = true;
  if (!rules[rule].failed) set_text(rules[rule].text, text);
  rules[rule].failed = true;
}

bool TrialReport::has_failed() const {
  return std::any_of(rules.begin(), rules.end(), [](const auto& rule) { return rule.failed; });
}

TrialReport run_trial(const std::function<void(TrialReport&)>& trial, double deadline) {
  const SharedReport shared;
  Child child{trial, *shared};
  const WallClock clock;
  std::array<char, 100> call{};
  TimePoint since = clock.now();
  double processor_time = 0;
  bool overdue = false;
  while (!child.has_ended()) {
    stop_if_interrupted();
    std::this_thread::sleep_for(kTrialLook);
    if (call != shared->call) {
      call = shared->call;
      since = clock.now();
      processor_time = processor_time_of(child.pid());
    }
    overdue = is_overdue(child.pid(), to_seconds(clock.now() - since), processor_time, deadline);
    if (overdue) break;
  }
  const int ending = child.end();
  TrialReport report = *shared;
  if (report.completed && WIFEXITED(ending) && WEXITSTATUS(ending) == 0) return report;
  if (overdue)
    report.fail(kDeadline, fmt::format("{} did not return within {:g} s: bound its loops and waits",
                                       report.call.data(), deadline));
  else if (WIFSIGNALED(ending))
    report.fail(kCrash, fmt::format("{} crashed: {}; run it under a debugger or the address "
                                    "sanitizer",
                                    report.call.data(), strsignal(WTERMSIG(ending))));
  else
    report.fail(kCrash, fmt::format("{} ended the process with exit code {}: return an error",
                                    report.call.data(), WEXITSTATUS(ending)));
  return report;
}

}  // namespace rths::plugin
