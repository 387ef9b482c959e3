// SPDX-License-Identifier: Apache-2.0
#include "run_modes.hpp"

#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include <rths/launch/run.hpp>

namespace rths::launch {

int prefer_realtime(int priority) {
  const sched_param parameters{priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

std::string make_realtime(int priority) {
  std::string missing;
  const auto add = [&](const std::string& privilege, int error) {
    missing += (missing.empty() ? "" : ", ") + privilege + " (" + std::strerror(error) + ")";
  };
  if (const int error = prefer_realtime(priority); error != 0)
    add("no real-time scheduling", error);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) add("memory not locked", errno);
  if (prctl(PR_SET_TIMERSLACK, 1UL) != 0) add("inexact timers", errno);
  return missing;
}

std::string missing_privileges() {
  std::string missing;
  std::thread{[&] { missing = make_realtime(kProbePriority); }}.join();
  return missing;
}

}  // namespace rths::launch
