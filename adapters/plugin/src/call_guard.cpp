// SPDX-License-Identifier: Apache-2.0
#include "call_guard.hpp"

#include <csetjmp>
#include <csignal>

namespace rths::plugin {
namespace {

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

}  // namespace

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

}  // namespace rths::plugin
