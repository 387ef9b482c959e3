// SPDX-License-Identifier: Apache-2.0
#include "trial.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <memory>
#include <span>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>

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

}  // namespace

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
