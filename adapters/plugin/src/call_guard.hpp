// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <rths/core/clock.hpp>

namespace rths::plugin {

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

}  // namespace rths::plugin
