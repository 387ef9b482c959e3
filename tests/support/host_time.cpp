// SPDX-License-Identifier: Apache-2.0
#include "support/host_time.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

namespace rths::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPeriod = std::chrono::milliseconds{20};
constexpr double kLeastShare = 0.05;  // a test ends some time

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

double processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
  return CPU_COUNT(&allowed);
}

// Processes that run or want to, without this thread: proc(5), loadavg.
double runnable() {
  std::ifstream file{"/proc/loadavg"};
  std::string word;
  for (int i = 0; i < 4; ++i) file >> word;
  const auto slash = word.find('/');
  return slash == std::string::npos ? 0 : std::stod(word.substr(0, slash)) - 1;
}

class Stopwatch {
 public:
  Stopwatch() {
    std::thread{[this] { run(); }}.detach();
  }
  [[nodiscard]] double granted() const { return granted_.load(); }

 private:
  void run() {
    for (auto last = Clock::now();;) {
      std::this_thread::sleep_for(kPeriod);
      const auto now = Clock::now();
      const double elapsed = seconds(now - last);
      const double of_processor = processors() / std::max(1.0, runnable() + 1);
      const double of_wake = seconds(kPeriod) / elapsed;
      const double share = std::min(1.0, of_processor) * std::min(1.0, 1.1 * of_wake);
      granted_.store(granted_.load() + elapsed * std::max(kLeastShare, share));
      last = now;
    }
  }

  std::atomic<double> granted_{0};
};

}  // namespace

double host_time() {
  // Never destroyed: a forked child, which has no such thread, may exit.
  static const auto* const stopwatch = new Stopwatch;
  return stopwatch->granted();
}

}  // namespace rths::test
