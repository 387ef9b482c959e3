// SPDX-License-Identifier: Apache-2.0
#include <rths/plugin/plugin_adapter.hpp>

#include <pthread.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <csetjmp>
#include <csignal>
#include <cstring>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/plugin/library.hpp>

#include "calls.hpp"

namespace rths::plugin {
namespace {

/// How a call into a plugin ended.
enum class CallEnd { Returned, Overdue, Crashed };

/// Calls functions of a plugin. A crash, or a call that does not return in time, ends the call and
/// not the process: a signal handler jumps out of it. The plugin must not be called again then.
///
/// A thread watches the calls, since the caller cannot. Calls are from one thread at a time.
class CallGuard {
 public:
  /// @param longest  of a call   @setup
  explicit CallGuard(Duration longest);
  ~CallGuard();
  CallGuard(const CallGuard&) = delete;
  CallGuard& operator=(const CallGuard&) = delete;

  /// Costs no system call.   @realtime
  template <class Call>
  [[nodiscard]] CallEnd run(Call call) noexcept {
    return run_function([](void* argument) { (*static_cast<Call*>(argument))(); }, &call);
  }
  /// Of the last crash: the signal.
  [[nodiscard]] int signal() const { return signal_; }

 private:
  [[nodiscard]] CallEnd run_function(void (*function)(void*), void* argument) noexcept;
  void watch();

  Duration longest_;
  std::atomic<std::uint64_t> calls_{0};  ///< odd during a call
  std::atomic<pthread_t> caller_;
  int signal_ = 0;
  std::mutex mutex_;
  std::condition_variable end_;
  bool ending_ = false;
  std::thread watcher_;  ///< last, because it uses the members above
};

constexpr int kLooks = 4;  // of the watcher, within the longest call

constexpr int kCrashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

int overdue_signal() { return SIGRTMIN + 7; }

/// The innermost guarded call of this thread.
struct GuardedCall {
  sigjmp_buf back;
  const std::atomic<std::uint64_t>* calls;
};

thread_local GuardedCall* frame = nullptr;

/// The call that is overdue: a signal that arrives after its end does nothing.
std::atomic<const std::atomic<std::uint64_t>*> accused{nullptr};

std::atomic<std::uint64_t> accused_call{0};

struct sigaction earlier[NSIG];

void handle(int number, siginfo_t* info, void* context) noexcept {
  if (number == overdue_signal()) {
    if (frame != nullptr && frame->calls == accused.load() &&
        frame->calls->load() == accused_call.load())
      siglongjmp(frame->back, number);
    return;
  }
  if (frame != nullptr) siglongjmp(frame->back, number);
  const struct sigaction& before = earlier[number];
  if ((before.sa_flags & SA_SIGINFO) != 0) return before.sa_sigaction(number, info, context);
  if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN)
    return before.sa_handler(number);
  std::signal(number, SIG_DFL);  // the access is repeated and ends the process
  if (number == SIGABRT) std::raise(number);
}

// The signal stays unblocked after the jump out of its handler.
void install_handlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    struct sigaction action {};
    action.sa_sigaction = handle;
    action.sa_flags = SA_SIGINFO | SA_NODEFER;
    for (const int number : kCrashes) sigaction(number, &action, &earlier[number]);
    sigaction(overdue_signal(), &action, nullptr);
  });
}

CallGuard::CallGuard(Duration longest) : longest_{longest} {
  install_handlers();
  watcher_ = std::thread{[this] { watch(); }};
}

CallGuard::~CallGuard() {
  {
    const std::lock_guard lock{mutex_};
    ending_ = true;
  }
  end_.notify_one();
  watcher_.join();
}

CallEnd CallGuard::run_function(void (*function)(void*), void* argument) noexcept {
  GuardedCall here;
  here.calls = &calls_;
  caller_.store(pthread_self(), std::memory_order_relaxed);
  const int number = sigsetjmp(here.back, 0);
  if (number == 0) {
    frame = &here;
    calls_.fetch_add(1, std::memory_order_release);
    function(argument);
  }
  frame = nullptr;
  calls_.fetch_add(1, std::memory_order_release);
  signal_ = number;
  if (number == 0) return CallEnd::Returned;
  return number == overdue_signal() ? CallEnd::Overdue : CallEnd::Crashed;
}

// A call is overdue if several looks find the same one.
void CallGuard::watch() {
  std::uint64_t last = 0;
  int looks = 0;
  std::unique_lock lock{mutex_};
  while (!end_.wait_for(lock, longest_ / kLooks, [this] { return ending_; })) {
    const std::uint64_t now = calls_.load(std::memory_order_acquire);
    looks = now == last && now % 2 == 1 ? looks + 1 : 0;
    last = now;
    if (looks < kLooks) continue;
    accused_call.store(now);
    accused.store(&calls_);
    pthread_kill(caller_.load(std::memory_order_relaxed), overdue_signal());
  }
}

using adapters::Direction;
using adapters::Port;
using adapters::StepData;

constexpr Duration kSetupDeadline = std::chrono::seconds{10};
constexpr std::size_t kMargin = 8;   // longwords behind the outputs
constexpr double kRestMargin = 0.5;  // beyond the path to rest [s]

// In the order of rths_status.
constexpr Status kStatuses[] = {Status::Ok, Status::Done, Status::Stale, Status::LimitExceeded,
                                Status::Fault};

/// An output, and what the plugin states about it.
struct Stated {
  std::string name;
  double lowest, highest;
  bool is_ramped;
  bool is_monitor;
};

class PluginAdapter final : public adapters::Adapter {
 public:
  explicit PluginAdapter(const PluginSettings& settings)
      : settings_{settings},
        library_{settings.library, settings.built_in},
        adapter_{library_.adapter()},
        title_{settings.title.empty() ? library_.title() : settings.title} {
    std::array<char, 400> error{};
    set_up("create", [&] {
      self_ = adapter_.create(settings_.config.c_str(), error.data(), error.size() - 1);
    });
    if (self_ == nullptr)
      throw Error{fmt::format("{}: {}", title_,
                              error[0] != '\0' ? error.data() : "create failed without a message")};
    ports_ = read_signals();
    outputs_.assign(stated_.size() + kMargin, 0);
    std::fill(outputs_.end() - kMargin, outputs_.end(), kUntouched);
    held_.resize(stated_.size());
  }

  // A plugin that crashed keeps its memory.
  ~PluginAdapter() override {
    if (self_ == nullptr || is_broken_) return;
    try {
      deactivate();
      set_up("destroy", [&] { adapter_.destroy(self_); });
    } catch (const Error&) {
      return;  // the run is over
    }
  }

  PluginAdapter(const PluginAdapter&) = delete;
  PluginAdapter& operator=(const PluginAdapter&) = delete;

  [[nodiscard]] std::vector<Port> ports() const override { return ports_; }

  void activate() override {
    if (has_failed_) throw Error{title_ + ": failed earlier"};
    std::array<char, 400> error{};
    rths_status status = RTHS_OK;
    set_up("activate", [&] { status = adapter_.activate(self_, error.data(), error.size() - 1); });
    if (status != RTHS_OK)
      throw Error{fmt::format(
          "{}: {}", title_, error[0] != '\0' ? error.data() : "activate failed without a message")};
    is_active_ = true;
    guard_.emplace(from_seconds(settings_.step_deadline));
    stopped_at_ = -1;
    has_stepped_ = is_set_ = false;
    const auto now = read_signals();
    const bool is_same = std::equal(
        now.begin(), now.end(), ports_.begin(), ports_.end(), [](const Port& a, const Port& b) {
          return a.name == b.name && a.direction == b.direction && a.unit == b.unit;
        });
    if (!is_same)
      throw Error{title_ + ": lists other signals after activate, expected the same ones"};
  }

  [[nodiscard]] Status step(StepData& step) noexcept override {
    if (!has_stepped_) {
      std::copy(step.outputs.begin(), step.outputs.end(), outputs_.begin());
      first_step_ = step.time;
    }
    has_stepped_ = true;
    if (step.stopping && stopped_at_ < 0) begin_stop(step);
    const Status status = has_failed_ ? Status::Fault : call_step(step);
    if (status == Status::Fault) {
      step.message = message_.data();
      return status;
    }
    std::transform(outputs_.begin(), outputs_.begin() + static_cast<std::ptrdiff_t>(stated_.size()),
                   step.outputs.begin(), [](double value) { return value + 0.0; });  // no -0 marks
    if (stopped_at_ < 0) return status;
    const Status end = come_to_rest(step, status);
    if (end == Status::Fault) step.message = message_.data();
    return end;
  }

  void deactivate() override {
    if (!is_active_) return;
    is_active_ = false;
    guard_.reset();
    if (is_broken_) return;
    set_up("deactivate", [&] { adapter_.deactivate(self_); });
  }

 private:
  template <class Call>

  // @throws Error if the call does not return
  void set_up(const char* name, Call call) {
    CallGuard guard{kSetupDeadline};
    const CallEnd end = guard.run(call);
    if (end == CallEnd::Returned) return;
    is_broken_ = has_failed_ = true;
    throw Error{end == CallEnd::Overdue
                    ? fmt::format("{}: {} did not return within {:g} s", title_, name,
                                  to_seconds(kSetupDeadline))
                    : fmt::format("{}: {} crashed: {}", title_, name, strsignal(guard.signal()))};
  }

  [[nodiscard]] std::vector<Port> read_signals() {
    const rths_signal* signals = nullptr;
    std::uint32_t count = 0;
    set_up("signals", [&] { signals = adapter_.signals(self_, &count); });
    if (signals == nullptr || count == 0 || count > kMostSignals)
      throw Error{fmt::format("{}: has {} signals, expected 1 to {}", title_,
                              signals == nullptr ? 0 : count, kMostSignals)};
    std::vector<Port> ports;
    stated_.clear();
    for (const rths_signal* signal = signals; signal != signals + count; ++signal) {
      ports.push_back(port_of(*signal));
      const auto& port = ports.back();
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      if (!is_read(*signal))
        stated_.push_back({port.name, port.range ? port.range->first : -kInfinity,
                           port.range ? port.range->second : kInfinity,
                           (signal->flags & RTHS_RAMP) != 0, port.direction == Direction::Monitor});
    }
    return ports;
  }

  [[nodiscard]] Port port_of(const rths_signal& signal) const {
    if (signal.name == nullptr || *signal.name == '\0' || signal.unit == nullptr)
      throw Error{title_ + ": a signal has no name or no unit"};
    if (signal.direction > RTHS_PARAMETER)
      throw Error{fmt::format("{}: '{}' has direction {}, expected 0 to {}", title_, signal.name,
                              signal.direction, static_cast<int>(RTHS_PARAMETER))};
    Port port{signal.name, static_cast<Direction>(signal.direction), signal.unit, signal.initial,
              (signal.flags & RTHS_EVENT) != 0};
    if (has_range(signal)) port.range = {signal.lowest, signal.highest};
    return port;
  }

  // @realtime. Faults are the end of it.
  [[nodiscard]] Status call_step(const StepData& step) noexcept {
    rths_status status = RTHS_FAULT;
    const char* reason = "";
    mark_unset();
    const long before = heap_calls();
    const CallEnd end = guard_->run([&] {
      status = adapter_.step(self_, step.time, step.inputs.data(), outputs_.data());
      if (status == RTHS_FAULT && library_.message() != nullptr) reason = library_.message()(self_);
    });
    is_broken_ = end != CallEnd::Returned;
    if (end == CallEnd::Overdue)
      return fail("its step did not return within {:g} s", settings_.step_deadline);
    if (end == CallEnd::Crashed) return fail("its step crashed: {}", strsignal(guard_->signal()));
    if (status == RTHS_FAULT)
      return fail("{}",
                  reason != nullptr && *reason != '\0' ? reason : "a fault without a message");
    if (status < RTHS_OK || status > RTHS_FAULT)
      return fail("its step returned status {}, expected 0 to {}", status,
                  static_cast<int>(RTHS_FAULT));
    const long after = heap_calls();
    if (after != before && !settings_.may_allocate)
      return fail("its step used the heap {} times, expected none", after - before);
    return accepts_outputs() && has_set_an_output(step.time) ? kStatuses[status] : Status::Fault;
  }

  [[nodiscard]] bool accepts_outputs() noexcept {
    for (std::size_t i = 0; i < stated_.size(); ++i) {
      const auto& stated = stated_[i];
      const double value = outputs_[i];
      if (value >= stated.lowest && value <= stated.highest && std::isfinite(value)) continue;
      if (std::isfinite(value))
        static_cast<void>(fail("its step wrote {:g} to '{}', which it states as {:g} to {:g}",
                               value, stated.name, stated.lowest, stated.highest));
      else
        static_cast<void>(fail("its step wrote {} to '{}', expected a number", value, stated.name));
      return false;
    }
    for (std::size_t i = stated_.size(); i < outputs_.size(); ++i)
      if (outputs_[i] != kUntouched) {
        is_broken_ = true;
        static_cast<void>(fail("its step wrote beyond its {} outputs", stated_.size()));
        return false;
      }
    return true;
  }

  // Until a step sets an output, those that are zero change their sign before each step: a plugin
  // reads zero, and whatever it writes differs from the mark in one of two steps.
  void mark_unset() noexcept {
    if (is_set_) return;
    mark_ = std::signbit(mark_) ? 0.0 : -0.0;
    for (std::size_t i = 0; i < stated_.size(); ++i)
      if (outputs_[i] == 0) outputs_[i] = mark_;
  }

  [[nodiscard]] bool has_set_an_output(double time) noexcept {
    const char* first = nullptr;
    std::size_t count = 0;
    for (std::size_t i = 0; i < stated_.size() && !is_set_; ++i) {
      if (stated_[i].is_monitor) continue;
      const bool is_marked = outputs_[i] == 0 && std::signbit(outputs_[i]) == std::signbit(mark_);
      is_set_ = !is_marked;
      if (first == nullptr) first = stated_[i].name.c_str();
      ++count;
    }
    if (is_set_ || first == nullptr || time - first_step_ < settings_.longest_unset) return true;
    static_cast<void>(fail("its steps set none of its {} outputs, such as '{}', for {:g} s", count,
                           first, settings_.longest_unset));
    return false;
  }

  void begin_stop(const StepData& step) noexcept {
    stopped_at_ = step.time;
    std::copy(step.outputs.begin(), step.outputs.end(), held_.begin());
    if (library_.stop() == nullptr) return;
    if (guard_->run([&] { library_.stop()(self_); }) == CallEnd::Returned) return;
    is_broken_ = true;
    static_cast<void>(fail("stop did not return"));
  }

  // A plugin that comes to rest by itself says when; for others, the outputs that move are ramped.
  [[nodiscard]] Status come_to_rest(StepData& step, Status status) noexcept {
    const double since = step.time - stopped_at_;
    const auto& retreat = settings_.retreat;
    if (library_.stop() == nullptr) {
      for (std::size_t i = 0; i < stated_.size(); ++i)
        if (stated_[i].is_ramped) step.outputs[i] = retreat.fraction(since) * held_[i];
      return retreat.finished(since) ? Status::Done : status;
    }
    const double longest = retreat.hold + retreat.ramp + kRestMargin;
    if (status == Status::Done || since < longest) return status;
    return fail("was not at rest {:g} s after the stop", longest);
  }

  template <class... Values>

  Status fail(fmt::format_string<Values...> text, Values&&... values) noexcept {
    has_failed_ = true;
    const std::size_t room = message_.size() - 1;
    auto end = fmt::format_to_n(message_.data(), room, "{}: ", title_).out;
    const auto left = static_cast<std::size_t>(message_.data() + room - end);
    end = fmt::format_to_n(end, left, text, std::forward<Values>(values)...).out;
    *end = '\0';
    return Status::Fault;
  }

  PluginSettings settings_;
  Library library_;
  const rths_adapter& adapter_;
  std::string title_;
  void* self_ = nullptr;
  bool is_active_ = false, has_stepped_ = false;
  bool is_set_ = false;      ///< a step has set an output
  double mark_ = 0;          ///< zero of either sign, in outputs that no step has set
  double first_step_ = 0;    ///< [s]
  bool has_failed_ = false;  ///< no further step
  bool is_broken_ = false;   ///< no further call
  std::vector<Port> ports_;
  std::vector<Stated> stated_;
  std::vector<double> outputs_;  ///< as the plugin wrote them, and the margin
  std::vector<double> held_;     ///< at the stop
  double stopped_at_ = -1;
  std::array<char, 400> message_{};
  std::optional<CallGuard> guard_;  ///< while active
};

}  // namespace

std::unique_ptr<adapters::Adapter> make_plugin(const PluginSettings& settings) {
  return std::make_unique<PluginAdapter>(settings);
}

}  // namespace rths::plugin
