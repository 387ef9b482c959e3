// SPDX-License-Identifier: Apache-2.0
//
// Locks are counted in a function that replaces that of the C library. System calls are detected
// by Syscall User Dispatch: while the selector byte is set, the kernel raises SIGSYS for each
// system call of this thread. The handler records the first call, clears the byte and repeats it.
#include "realtime_guard.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <ucontext.h>

#include <csignal>

// Of app/src/heap_calls.cpp, which counts the heap calls of each thread.
#ifdef RTHS_SANITIZED
static long rths_heap_calls() { return 0; }
#else
extern "C" long rths_heap_calls();
#endif

namespace rths::test {
namespace {

struct Counters {
  bool watching = false;
  long heap_calls_before = 0;
  long locks = 0;
  long first_system_call = -1;
};
thread_local Counters counters;

#if defined(__x86_64__) && !defined(RTHS_SANITIZED)
constexpr int kSetDispatch = 59;  // PR_SET_SYSCALL_USER_DISPATCH, newer than Debian 12's headers
constexpr unsigned long kDispatchOn = 1;
constexpr unsigned long kDispatchOff = 0;
constexpr char kAllow = 0;
constexpr char kBlock = 1;
constexpr int kSyscallLength = 2;  // bytes of the instruction

thread_local volatile char selector = kAllow;

void note_system_call(int, siginfo_t* info, void* context) {
  selector = kAllow;
  if (counters.first_system_call < 0) counters.first_system_call = info->si_syscall;
  auto* registers = static_cast<ucontext_t*>(context);
  registers->uc_mcontext.gregs[REG_RAX] = info->si_syscall;
  registers->uc_mcontext.gregs[REG_RIP] -= kSyscallLength;
}

bool start_dispatch() {
  struct sigaction action {};
  action.sa_sigaction = note_system_call;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  return prctl(kSetDispatch, kDispatchOn, 0UL, 0UL, &selector) == 0;
}

void stop_dispatch() { prctl(kSetDispatch, kDispatchOff, 0UL, 0UL, 0UL); }
void block_system_calls() { selector = kBlock; }
void allow_system_calls() { selector = kAllow; }
#else
bool start_dispatch() { return false; }
void stop_dispatch() {}
void block_system_calls() {}
void allow_system_calls() {}
#endif

}  // namespace

RealTimeGuard::RealTimeGuard() {
  counters = {};
  counters.heap_calls_before = rths_heap_calls();
  const bool dispatched = start_dispatch();
  counters.watching = true;
  if (dispatched) block_system_calls();
}

RealTimeGuard::~RealTimeGuard() {
  allow_system_calls();
  counters.watching = false;
  stop_dispatch();
}

bool RealTimeGuard::supported() {
#ifdef RTHS_SANITIZED
  return false;
#else
  return true;
#endif
}

bool RealTimeGuard::sees_system_calls() {
  const bool works = start_dispatch();
  stop_dispatch();
  return works;
}

long RealTimeGuard::heap_calls() const { return rths_heap_calls() - counters.heap_calls_before; }
long RealTimeGuard::locks() const { return counters.locks; }
long RealTimeGuard::first_system_call() const { return counters.first_system_call; }

}  // namespace rths::test

#ifndef RTHS_SANITIZED
extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto real =
      reinterpret_cast<int (*)(pthread_mutex_t*)>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  if (rths::test::counters.watching) ++rths::test::counters.locks;
  return real(mutex);
}
#endif
