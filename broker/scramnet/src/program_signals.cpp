// SPDX-License-Identifier: Apache-2.0
//
// The program's use of signals beside traps. The library's own `sigaction`, `signal` and signal
// masks keep SIGSEGV and SIGTRAP for the traps, and pass everything else to the C library.
#include "program_signals.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>

// The C library's own, which a program cannot replace.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" int __sigaction(int, const struct sigaction*, struct sigaction*) noexcept;

namespace rths::scramnet {
namespace {

constexpr int kThreadCancel = 32, kSetIds = 33;  // of the C library, never blocked
constexpr std::size_t kMaskBytes = 8;            // of the kernel's signal set

/// The program's action for one signal. Two copies, so that a handler never sees half of one.
struct KeptAction {
  std::array<struct sigaction, 2> copies{};
  std::atomic<unsigned> current{0};

  [[nodiscard]] struct sigaction get() const { return copies[current.load() % 2]; }
  void set(const struct sigaction& action) {
    const unsigned next = current.load() + 1;
    copies[next % 2] = action;
    current.store(next);
  }
};

std::atomic<bool> handles{false};
KeptAction of_fault, of_step;

KeptAction* kept(int signal) {
  if (!handles.load()) return nullptr;
  return signal == SIGSEGV ? &of_fault : signal == SIGTRAP ? &of_step : nullptr;
}

void take_over(int signal, SignalHandler handler, KeptAction& before) {
  struct sigaction action {};
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  action.sa_sigaction = handler;
  sigfillset(&action.sa_mask);
  struct sigaction old {};
  __sigaction(signal, &action, &old);
  before.set(old);
}

// The default: ends the process, with a core if one is wanted. A fault happens again when the
// handler returns, a signal that was sent is sent again.
void end_by(int signal, const siginfo_t& info) {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  __sigaction(signal, &action, nullptr);
  if (info.si_code <= 0) raise(signal);
}

int set_mask(int how, const sigset_t* set, sigset_t* old) {
  sigset_t allowed;
  if (set != nullptr) {
    allowed = *set;
    if (how != SIG_UNBLOCK)
      for (const int signal : {SIGSEGV, kThreadCancel, kSetIds}) {
        // The C library's sigdelset refuses its own signals.
        reinterpret_cast<unsigned long*>(&allowed)[0] &= ~(1UL << (signal - 1));
      }
    set = &allowed;
  }
  return static_cast<int>(syscall(SYS_rt_sigprocmask, how, set, old, kMaskBytes));
}

}  // namespace

void handle_faults(SignalHandler on_fault, SignalHandler on_step) noexcept {
  if (handles.exchange(true)) return;
  take_over(SIGTRAP, on_step, of_step);
  take_over(SIGSEGV, on_fault, of_fault);
}

void pass_on(int signal, siginfo_t* info, void* context) noexcept {
  KeptAction& place = signal == SIGSEGV ? of_fault : of_step;
  const struct sigaction action = place.get();
  const bool sent = info->si_code <= 0;
  if (action.sa_handler == SIG_IGN && sent) return;
  if (action.sa_handler == SIG_DFL || action.sa_handler == SIG_IGN) return end_by(signal, *info);
  if ((action.sa_flags & static_cast<int>(SA_RESETHAND)) != 0) {
    struct sigaction default_action {};
    default_action.sa_handler = SIG_DFL;
    place.set(default_action);
  }
  sigset_t mask = static_cast<ucontext_t*>(context)->uc_sigmask;
  sigorset(&mask, &mask, &action.sa_mask);
  set_mask(SIG_SETMASK, &mask, nullptr);
  if ((action.sa_flags & SA_SIGINFO) != 0) return action.sa_sigaction(signal, info, context);
  action.sa_handler(signal);
}

}  // namespace rths::scramnet

using namespace rths::scramnet;

extern "C" {

int sigaction(int signal, const struct sigaction* action, struct sigaction* before) noexcept {
  if (KeptAction* const place = kept(signal)) {
    const struct sigaction old = place->get();
    if (action != nullptr) place->set(*action);
    if (before != nullptr) *before = old;
    return 0;
  }
  if (action == nullptr) return __sigaction(signal, nullptr, before);
  // A handler must be able to store to the card.
  struct sigaction allowed = *action;
  sigdelset(&allowed.sa_mask, SIGSEGV);
  return __sigaction(signal, &allowed, before);
}

__sighandler_t signal(int signal, __sighandler_t handler) noexcept {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  return sigaction(signal, &action, &before) == 0 ? before.sa_handler : SIG_ERR;
}

int pthread_sigmask(int how, const sigset_t* set, sigset_t* old) noexcept {
  return set_mask(how, set, old) == 0 ? 0 : errno;
}

int sigprocmask(int how, const sigset_t* set, sigset_t* old) noexcept {
  return set_mask(how, set, old);
}
}
